"""`restitution app`: a page on this machine that redraws the curves while a slider moves."""

import webbrowser
from pathlib import Path

from restitution.app.session import Session, first_content
from restitution.cli.console import say
from restitution.errors import CaseError

try:
    from restitution.app.serving import serve_page
except ModuleNotFoundError as error:
    raise CaseError(
        f"the page needs {error.name}, which is not installed; in a checkout, run: "
        'pip install ".[app]"'
    ) from None


def app(case: Path | None, port: int, *, browser: bool) -> None:
    session = Session(first_content(case), None if case is None else case.parent)

    def ready(address: str) -> None:
        say(f"The page is at {address}")
        say("Press Ctrl-C to end the program.")
        if browser:
            webbrowser.open(address)

    try:
        serve_page(session, port, ready)
    finally:
        session.close()
