"""One server and one browser for the tests of the page, and what they see on it."""

import os
import re
import shutil
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
# The plotting library tries one style of its own, which the page does not allow.
HARMLESS = "Applying inline style violates"
SLOW = 40_000  # ms that a busy machine may take

CASE = """
title = "A small rough contact"
[first]
material = "steel"
radius = "100 um"
[interface]
yield_strength = "300 MPa"
[roughness]
kind = "gaussian"
rms = "20 nm"
correlation_length = "1 um"
seed = 1
[grid]
nodes = 64
spacing = "0.25 um"
[indentation]
from = "20 nm"
to = "200 nm"
steps = 6
[unloading]
curves = 2
steps = 6
"""


@pytest.fixture(scope="session")
def live_case():
    """The text of the case that the page begins with."""
    return CASE


class App:
    """`restitution app` in a process of its own, with its temporary files in `folder`."""

    def __init__(self, folder):
        (folder / "case.toml").write_text(CASE)
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
        found = (_parent_of(each) for each in Path("/proc").iterdir() if each.name.isdigit())
        return [number for number, parent in found if parent == self.process.pid]

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


@contextmanager
def _served(folder):
    pytest.importorskip("starlette", reason='the extra "app" is not installed')
    pytest.importorskip("uvicorn", reason='the extra "app" is not installed')
    served = App(folder)
    try:
        yield served
    finally:
        if served.process.poll() is None:
            served.end()


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    """The server of a module."""
    with _served(tmp_path_factory.mktemp("app")) as served:
        yield served


@pytest.fixture
def own_app(tmp_path):
    """A server that one test may end."""
    with _served(tmp_path) as served:
        yield served


@pytest.fixture(scope="module")
def browser():
    """A browser without a window."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = next(filter(None, map(shutil.which, PROGRAMS)), None)
    if program is None:
        pytest.skip("no Chromium is installed (Debian: apt install chromium)")
    playwright.expect.set_options(timeout=SLOW)
    with playwright.sync_playwright() as started:
        opened = started.chromium.launch(executable_path=program, args=OPTIONS)
        yield opened
        opened.close()


@pytest.fixture
def open_page(browser):
    """Open an address in a tab of its own; at the end no page has reported an error."""
    contexts, errors = [], []

    def opened(address, before=lambda page: None, **options):
        contexts.append(browser.new_context(accept_downloads=True, **options))
        page = contexts[-1].new_page()
        page.set_default_timeout(SLOW)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
        before(page)
        page.goto(address)
        return page

    yield opened
    for context in contexts:
        context.close()
    assert [each for each in errors if HARMLESS not in each] == []


@pytest.fixture
def page(app, open_page):
    """The page of the server of this module, not yet complete."""
    return open_page(app.address)
