"""`restitution app`: a page on this machine that redraws the curves while a slider moves."""

from pathlib import Path
from typing import Annotated

import typer


def app(
    case: Annotated[
        Path | None,
        typer.Argument(
            metavar="CASE",
            help="Case file (TOML) that the page shows first.",
            show_default="two rough steel spheres",
            readable=False,
        ),
    ] = None,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port of the page; 0 selects a free port.")
    ] = 0,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
) -> None:
    """Open a page that redraws the curves of CASE while you change its values."""
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
    session = Session(first_content(case), None if case is None else case.parent)

    def ready(address: str) -> None:
        say(f"The page is at {address}")
        say("Press Ctrl-C to end the program.")
        if browser:
            import webbrowser

            webbrowser.open(address)

    try:
        serve_page(session, port, ready)
    finally:
        session.close()
