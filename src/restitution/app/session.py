"""The temporary folder of one page, with its results and scans."""

from __future__ import annotations

import re
import secrets
import shutil
from filecmp import cmp
from pathlib import Path
from tempfile import mkdtemp

from restitution.app.content import Content, content_of, scans_of
from restitution.app.presets import presets
from restitution.case.case_file import read_text
from restitution.errors import CaseError
from restitution.surfaces.joined.read import matching

LARGEST_SCAN = 2**28  # largest size (bytes) of a scan that the user drops on the page
_ODD = re.compile(r"[^\w.()+-]+")  # characters of a file name that are replaced


class Session:
    """The folders, the token and the first case of a page; `close` removes the folders."""

    def __init__(self, content: Content, folder: Path | None = None) -> None:
        """Make the folders, and link the scans of `content` (in `folder`) into `scans`."""
        self.token = secrets.token_urlsafe(24)
        self.room = Path(mkdtemp(prefix="restitution-app-"))
        self.scans = self.room / "scans"
        self.scans.mkdir()
        self.content = content
        if folder is not None:
            _bring_scans(content, folder, self.scans)

    def free_name(self, wanted: str) -> str:
        """Make a file name from `wanted` that is unused in `scans`; replace unusual characters."""
        stem, dot, kind = _plain(wanted).partition(".")
        numbers = ("", *(f"-{k}" for k in range(2, 1000)))
        free = (f"{stem}{k}{dot}{kind}" for k in numbers)
        return next(name for name in free if not (self.scans / name).exists())

    def stored(self, wanted: str, file: Path) -> Path | None:
        """The scan with the plain name of `wanted`, if it has the content of `file`."""
        plain = self.scans / _plain(wanted)
        same = plain != file and plain.is_file() and cmp(plain, file, shallow=False)
        return plain if same else None

    def close(self) -> None:
        """Remove the temporary folder with everything in it."""
        shutil.rmtree(self.room, ignore_errors=True)


def _plain(wanted: str) -> str:
    name = _ODD.sub("_", wanted.replace("\\", "/").rsplit("/", 1)[-1]).lstrip(".")[-80:]
    return name or "scan"


def first_content(case: Path | None) -> Content:
    """Read the tables of the case file `case` or, if `case` is None, of the built-in first case."""
    if case is None:
        first: Content = presets()[0]["content"]
        return first
    text = read_text(case)
    try:
        return content_of(text)
    except CaseError as error:
        raise CaseError(f"{case}: {error}") from None


def _bring_scans(content: Content, folder: Path, scans: Path) -> None:
    for part in content.get("roughness", ()):
        if "scan" in part:
            part["scan"] = [
                {**table, "file": str(path.absolute())}
                for table in part["scan"]
                for path in matching(folder, table["file"])
            ]
    for table in scans_of(content):
        path = folder / table["file"]
        source = path.resolve()
        if not source.is_file():
            raise CaseError(f"roughness.file: {path} is not a file; give the path of a scan")
        link = scans / source.name
        if not link.exists():
            link.symlink_to(source)
        table["file"] = source.name
