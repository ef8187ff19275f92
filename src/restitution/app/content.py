"""Conversion between a case file and the tables that the page edits."""

from __future__ import annotations

import json
from pathlib import Path, PurePath
from typing import Any

import tomli_w

from restitution.case.case_file import parse_toml, problems_of
from restitution.errors import CaseError

Content = dict[str, Any]


def content_of(text: str) -> Content:
    """Parse the case file `text`. Every body becomes a table, and `roughness` a list of tables."""
    content = parse_toml(text)
    try:
        json.dumps(content, allow_nan=False)
    except (TypeError, ValueError):
        raise CaseError(
            "a value is a date, a time, inf or nan; no key of a case accepts such a value"
        ) from None
    for name in ("first", "second"):
        if isinstance(content.get(name), str):
            content[name] = {"material": content[name], "radius": "flat"}
    if isinstance(content.get("roughness"), dict):
        content["roughness"] = [content["roughness"]]
    for table in _tables(content.get("roughness")):
        if names := table.pop("scans", None):
            table["scan"] = [*({"file": name} for name in _listed(names)), *table.get("scan", ())]
    return content


def text_of(content: Content) -> str:
    """Write the tables `content` as a case file."""
    tables = dict(content)
    parts = tables.get("roughness")
    if parts == []:
        del tables["roughness"]
    elif isinstance(parts, list) and len(parts) == 1:
        tables["roughness"] = parts[0]
    try:
        return tomli_w.dumps(tables)
    except (TypeError, ValueError) as error:
        raise CaseError(
            f"{error}; a case file can contain strings, numbers, lists and tables"
        ) from None


def problems_in(text: str, folder: Path) -> dict[str, str]:
    """An error message for each wrong key of the case file `text`, whose scans are in `folder`."""
    try:
        content = parse_toml(text)
    except CaseError as error:
        return {"": str(error)}
    if problems := problems_of(content):
        return problems
    for name in (table["file"] for table in scans_of(content)):
        # Only scans that the user gave to the page are read.
        if PurePath(name).name != name or not (folder / name).is_file():
            return {
                "roughness.file": f'"{name}" is not a scan of this page; drop the file onto the '
                "page, or start restitution app with the case file that names it"
            }
    return {}


def scans_of(content: Content) -> list[Content]:
    """List the tables of scans in the tables `content`; each has the key `file`.

    Names in `scans` of joined scans become tables.
    """
    tables = [*_tables(content.get("roughness"))]
    tables += [inner for table in tables for inner in _tables(table.get("scan"))]
    listed = [table for table in tables if "file" in table]
    return listed + [{"file": name} for table in tables for name in _listed(table.get("scans"))]


def joins_scans(content: Content) -> bool:
    """Whether `content` has a joined spectrum of scans."""
    return any(table.get("kind") == "joined" for table in _tables(content.get("roughness")))


def _listed(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [] if value is None else [value]


def _tables(value: Any) -> list[Content]:
    return [table for table in _listed(value) if isinstance(table, dict)]
