"""`restitution` without its start: forked from a process that has imported it.

A small run takes less time than the imports of the program, and the pages run many commands.
"""

import atexit
import importlib
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import traceback
from functools import cache
from pathlib import Path

IMPORTED = (
    "restitution.cli.run",
    "restitution.runs.ensemble",
    "restitution.runs.convergence",
    "restitution.plots.static",
    "restitution.plots.run",
    "restitution.pages.run",
    "restitution.dem.fits",
    "restitution.dem.export",
    "netCDF4",
    "distributed",  # xarray imports it to write a file
)
# It starts in a hundredth of the time, because it imports no site packages.
CLIENT = """#!{python} -SE
import json, os, socket, sys

with socket.socket(socket.AF_UNIX) as server:
    server.connect({address!r})
    request = [sys.argv[1:], os.getcwd(), dict(os.environ)]
    socket.send_fds(server, [json.dumps(request).encode()], [0, 1, 2])
    sys.exit(server.recv(1)[0])
"""


def write_program(path, environment):
    """Write the program to `path`; the process behind it starts once, with this environment."""
    if not hasattr(os, "fork"):
        path.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m restitution "$@"\n')
    else:
        address = _address_of_server(json.dumps(environment, sort_keys=True))
        path.write_text(CLIENT.format(python=sys.executable, address=address))
    path.chmod(0o755)


@cache
def _address_of_server(environment):
    folder = tempfile.TemporaryDirectory(prefix="warm-")
    address = str(Path(folder.name) / "socket")
    server = subprocess.Popen(
        [sys.executable, __file__, address],
        env=json.loads(environment),
        stdout=subprocess.PIPE,
        text=True,
    )
    atexit.register(folder.cleanup)
    atexit.register(server.kill)
    assert server.stdout.readline() == "ready\n"
    return address


def _serve(address):
    for name in IMPORTED:
        importlib.import_module(name)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # the system buries the children
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(address)
        listening.listen()
        print("ready", flush=True)
        while True:
            connection, _ = listening.accept()
            if os.fork() == 0:
                listening.close()
                signal.signal(signal.SIGCHLD, signal.SIG_DFL)
                _answer(connection)
            connection.close()


def _answer(connection):
    """Be the program that was asked for, and end."""
    from restitution.cli import main

    text, streams, _, _ = socket.recv_fds(connection, 2**20, 3)
    arguments, folder, environment = json.loads(text)
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
    sys.stdin = open(0, closefd=False)  # noqa: SIM115
    sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", 1, errors="backslashreplace", closefd=False)  # noqa: SIM115
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = ["restitution", *arguments]
    status = 1
    try:
        main()
        status = 0
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(bool(end.code))
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        connection.send(bytes([status]))
        os._exit(0)


if __name__ == "__main__":
    _serve(sys.argv[1])
