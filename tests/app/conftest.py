"""One server and one browser for the tests of the page, and what they see on it."""

import shutil
from contextlib import contextmanager

import pytest

from app_process import App

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
SLOW = 120_000  # ms that a busy machine may take

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


@contextmanager
def _served(folder):
    pytest.importorskip("starlette", reason='the extra "app" is not installed')
    pytest.importorskip("uvicorn", reason='the extra "app" is not installed')
    served = App(folder, CASE)
    try:
        yield served
    finally:
        if served.process.poll() is None:
            served.end()


@pytest.fixture(scope="session")
def app(tmp_path_factory):
    """The server of all tests that do not end it."""
    with _served(tmp_path_factory.mktemp("app")) as served:
        yield served


@pytest.fixture
def own_app(tmp_path):
    """A server that one test may end."""
    with _served(tmp_path) as served:
        yield served


@pytest.fixture(scope="session")
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


def _tab(browser, errors, **options):
    """A page in a tab of its own, which adds its errors to `errors`."""
    page = browser.new_context(accept_downloads=True, **options).new_page()
    page.set_default_timeout(SLOW)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
    return page


@pytest.fixture
def open_page(browser):
    """Open an address in a tab of its own; at the end no page has reported an error."""
    pages, errors = [], []

    def opened(address, before=lambda page: None, **options):
        pages.append(_tab(browser, errors, **options))
        before(pages[-1])
        pages[-1].goto(address)
        return pages[-1]

    yield opened
    for page in pages:
        page.context.close()
    assert errors == []


@pytest.fixture
def new_page(app, open_page):
    """The page of the server in a tab of its own, not yet complete."""
    return open_page(app.address)


@pytest.fixture
def page(new_page):
    """The page of the server with the curve of the case."""
    from app_page import computed

    computed(new_page)
    return new_page
