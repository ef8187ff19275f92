"""The library that draws figures on pages: a part of plotly.js (`plotly/bundle.mjs`)."""

from __future__ import annotations

import gzip
from functools import cache
from importlib.resources import files


@cache
def compressed() -> bytes:
    """The minified script, compressed by gzip."""
    return files("restitution.plots").joinpath("plotly", "plotly.min.js.gz").read_bytes()


@cache
def script() -> str:
    return gzip.decompress(compressed()).decode()
