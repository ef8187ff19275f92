"""Cases that the page offers to begin with."""

from __future__ import annotations

from importlib.resources import files
from typing import Any

from restitution.app.content import content_of

Preset = dict[str, Any]  # with the keys `title` and `content`
_NAMES = "steel-bead", "glass-bead", "alumina-on-glass", "lactose-powder", "polymer-granule"


def presets() -> list[Preset]:
    """The cases that the page offers to begin with: their titles and tables."""
    folder = files(__name__)
    contents = [content_of((folder / f"{name}.toml").read_text("utf-8")) for name in _NAMES]
    return [{"title": content["title"], "content": content} for content in contents]
