"""`restitution app` as the tests start it, watch it and end it."""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path


class App:
    """`restitution app` in a process of its own, with its temporary files in `folder`."""

    def __init__(self, folder, case):
        (folder / "case.toml").write_text(case)
        command = [sys.executable, "-m", "restitution", "app", "case.toml", "--no-browser"]
        environment = {**os.environ, "TMPDIR": str(folder), "COLUMNS": "200"}
        self.folder = folder
        self.process = subprocess.Popen(
            [*command, "--port", "0"],
            cwd=folder,
            env=environment,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.address = re.search(r"http://\S+", self.process.stdout.readline())[0]

    def children(self):
        """The numbers of the processes that the server has started."""
        parents = (_parent_of(entry) for entry in Path("/proc").iterdir() if entry.name.isdigit())
        return [number for number, parent in parents if parent == self.process.pid]

    def workers(self):
        """Those of them that compute."""
        return [number for number in self.children() if b"spawn_main" in _command_of(number)]

    def end(self):
        """Ctrl-C, and the status after it."""
        self.process.send_signal(signal.SIGINT)
        try:
            return self.process.wait(10)
        finally:
            self.process.kill()
            self.process.stdout.close()


def _parent_of(process):
    """The number of a process and of its parent; the latter is None if the process is gone."""
    try:
        after_name = (process / "stat").read_text().rpartition(")")[2].split()
    except OSError:
        return int(process.name), None
    return int(process.name), None if after_name[0] == "Z" else int(after_name[1])


def _command_of(number):
    try:
        return Path(f"/proc/{number}/cmdline").read_bytes()
    except OSError:
        return b""
