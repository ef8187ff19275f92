"""Text of exported files: plain ASCII that no code can misread.

Notes and comments have no quotes, braces or line-continuation characters, so that a name or title
given by the user cannot end a comment.
"""

from __future__ import annotations

import re
import textwrap
import unicodedata
from collections.abc import Iterable

from restitution.errors import one_line
from restitution.laws.particle import Particle

_WIDTH = 98
_SIGNS = str.maketrans({'"': "'", "`": "'", "\\": "/", "&": "+", "{": "(", "}": ")", "$": "%"})
_PLAIN = str.maketrans("–—−‐‑’‘“”·×≈→µ", "-----''''.x~>u") | str.maketrans(
    {"±": "+/-", "≤": "<=", "≥": ">=", "…": "...", "ß": "ss", "⁄": "/"}
)


def identifier(particle: Particle, number: int) -> str:
    """A name of letters, digits and `_`, ending in `number`, that every DEM code accepts."""
    word = (
        re.sub(r"[^A-Za-z0-9]+", "_", comment_text(particle.name))
        .strip("_")[:24]
        .rstrip("_")
        .lower()
        or "type"
    )
    return f"{word if word[0].isalpha() else f'p_{word}'}_{number}"


def commented(lines: Iterable[str], sign: str) -> str:
    """`lines` as comments that begin with `sign`."""
    return "\n".join(f"{sign} {line}".rstrip() for line in lines)


def xml_safe(text: str) -> str:
    return re.sub("-(?=-)", "- ", text)


def comment_text(text: str) -> str:
    """`text` as one line of ASCII that cannot end a comment; Greek letters become their names."""
    text = unicodedata.normalize("NFKD", one_line(text).translate(_PLAIN)).translate(_PLAIN)
    text = "".join(map(_ascii, text)).translate(_SIGNS)
    return text.replace("*/", "* /").replace("/*", "/ *").replace("??/", "?? /")


def number(value: float) -> str:
    """Format `value` in a notation that every code reads."""
    return f"{value:.9g}"


def real(value: float) -> str:
    """A number that readers of JSON cannot take for an integer."""
    text = number(value)
    return text if any(sign in text for sign in ".e") else f"{text}.0"


def numbers(values: Iterable[float]) -> str:
    return textwrap.fill(
        ", ".join(map(number, values)), _WIDTH, initial_indent="    ", subsequent_indent="    "
    )


def wrapped(lines: Iterable[str]) -> list[str]:
    """Lines of ASCII of at most `_WIDTH` characters, for comments."""
    folded = []
    for line in map(comment_text, lines):
        indent = " " * (len(line) - len(line.lstrip()) + 4)
        folded += textwrap.wrap(line, _WIDTH, subsequent_indent=indent) or [""]
    return folded


def _ascii(c: str) -> str:
    if c.isascii():
        return c
    if unicodedata.combining(c):
        return ""
    name = unicodedata.name(c, "")
    if name.startswith("GREEK"):
        word = name.split(" WITH ")[0].rsplit(" ", 1)[-1]
        return word.lower() if "SMALL" in name else word.capitalize()
    return "?"
