"""Several tabs of `restitution app`, and the loss of its processes."""

import os
import re
import signal
import time
from contextlib import contextmanager
from pathlib import Path

from app_page import RMS, change, computed, expect, rest, shown


def test_two_tabs_compute_at_the_same_time(app, open_page):
    first, second = (open_page(app.address) for _ in range(2))
    first.locator(RMS).fill("24 nm")
    second.locator(RMS).fill("25 nm")
    for page in (first, second):
        rest(page)
    assert shown(first)["restitution"] != shown(second)["restitution"]


def start_a_heavy_solve(page):
    """Return while the live curve of the last of three changes is computed.

    Its number of depths distinguishes its status from that of an earlier change, which would not
    do: the page replaces a solve that was lost if another change is waiting. The depths are so many
    that the status is seen before the curve is complete and its errors are computed.
    """
    computed(page)
    page.locator("#field-grid-spacing").fill("20 nm")
    page.locator("#field-grid-nodes").fill("1536")
    page.locator("#field-indentation-steps").fill("60")
    expect(page.locator("#status")).to_have_text(
        re.compile(r"^\d+ of 60 depths(; the rest is a preview: .*)?$")
    )


def test_a_lost_process_is_told_and_started_anew(app, page):
    start_a_heavy_solve(page)
    for number in app.workers():
        os.kill(number, signal.SIGKILL)
    expect(page.locator("#general")).to_contain_text("has ended unexpectedly")
    expect(page.locator("#status")).to_have_text("stopped")
    page.locator("#field-grid-nodes").fill("64")
    change(page, "#field-grid-spacing", "250 nm")


@contextmanager
def held(app):
    """Workers that do not answer for so long that the server ends one with an unwanted solve."""
    workers = app.workers()
    for number in workers:
        os.kill(number, signal.SIGSTOP)
    yield
    time.sleep(2.5)  # more than the patience of app/process.py
    for number in workers:
        os.kill(number, signal.SIGCONT)


def test_a_change_during_a_long_solve_gives_the_curve_of_the_new_values(app, page):
    """A solve that nobody wants is ended; what came after it is computed nevertheless."""
    start_a_heavy_solve(page)
    with held(app):
        page.locator("#field-grid-nodes").fill("64")
        page.locator("#field-grid-spacing").fill("250 nm")
    computed(page)
    expect(page.locator("#general")).to_be_hidden()


def test_a_tab_that_is_closed_leaves_the_solve_of_another_alone(app, open_page):
    first, second = (open_page(app.address) for _ in range(2))
    computed(second)
    start_a_heavy_solve(first)
    with held(app):
        second.locator(RMS).fill("26 nm")
        expect(second.locator("#status")).to_have_text("computing…")
        second.close()
    computed(first)
    expect(first.locator("#general")).to_be_hidden()


def expect_gone(number):
    """Wait until the system has removed a process, which comes after its parent's end."""
    until = time.monotonic() + 5
    while Path(f"/proc/{number}").exists():
        assert time.monotonic() < until, number
        time.sleep(0.05)


def test_ctrl_c_ends_everything(own_app, open_page):
    page = open_page(own_app.address)
    start_a_heavy_solve(page)
    children = own_app.children()
    assert children
    assert list(own_app.folder.glob("restitution-app-*"))
    own_app.end()
    expect(page.locator("#general")).to_have_text(re.compile("^the program has ended"))
    for child in children:
        expect_gone(child)
    assert list(own_app.folder.glob("restitution-app-*")) == []
