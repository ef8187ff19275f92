"""A real browser without a window: what it makes of a page, and what it complains of."""

import re
import shutil
import subprocess

import pytest

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")


@pytest.fixture
def opened():
    """Open a page: its elements once drawn, as HTML, and the messages of its console."""
    return _opened


def _opened(page, *, width=1000):
    program = next(filter(None, map(shutil.which, PROGRAMS)), None)
    if program is None:
        pytest.skip("no Chromium is installed (Debian: apt install chromium)")
    done = subprocess.run(
        [
            program, "--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr",
            "--virtual-time-budget=20000", f"--window-size={width},900", "--dump-dom",
            f"--user-data-dir={page.parent / 'browser'}", page.as_uri(),
        ],
        capture_output=True, text=True, timeout=180, check=True,
    )  # fmt: skip
    console = re.findall(r"CONSOLE[^\"]*\"(.*)\", source", done.stderr)
    return done.stdout, console
