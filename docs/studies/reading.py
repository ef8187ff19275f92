"""Draw docstrings, comments, messages and paragraphs at random, to be read by someone else.

    python docs/studies/reading.py [SEED]

Prints 60 docstrings, 60 comments and 40 messages of `src` and 40 paragraphs of the documentation,
each with its place. A reader who does not know the code marks what must be read twice.
"""

from __future__ import annotations

import ast
import io
import random
import re
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
SOURCES = sorted((ROOT / "src").rglob("*.py"))
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("**/*.md"))]
NUMBERS = {"docstring": 60, "comment": 60, "message": 40, "paragraph": 40}
ERRORS = re.compile(r"Error$|^warn$|^refused?$|^say$")


def docstrings(file: Path, tree: ast.Module) -> Iterator[tuple[str, str]]:
    """Docstrings of modules, classes and functions."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            text = ast.get_docstring(node)
            if text:
                yield f"{file}:{getattr(node, 'lineno', 1)}", text


def messages(file: Path, tree: ast.Module) -> Iterator[tuple[str, str]]:
    """Texts of errors and warnings, with `{…}` in place of values."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or not node.args:
            continue
        name = getattr(node.func, "id", getattr(node.func, "attr", ""))
        text = _text(node.args[0])
        if ERRORS.search(name) and len(text.split()) > 3:
            yield f"{file}:{node.lineno}", text


def _text(node: ast.expr) -> str:
    """The text of a string, with `{…}` in place of each value."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    if isinstance(node, ast.JoinedStr):
        return "".join(_text(part) or "{…}" for part in node.values)
    if isinstance(node, ast.BinOp):
        return _text(node.left) + _text(node.right)
    return ""


def comments(file: Path, text: str) -> Iterator[tuple[str, str]]:
    """Comments; lines that follow each other are one."""
    block: list[str] = []
    first, last = 0, -1
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type != tokenize.COMMENT or "noqa" in token.string or "type:" in token.string:
            continue
        line = token.start[0]
        if line != last + 1 and block:
            yield f"{file}:{first}", " ".join(block)
            block = []
        if not block:
            first = line
        block.append(token.string.lstrip("# "))
        last = line
    if block:
        yield f"{file}:{first}", " ".join(block)


def paragraphs(file: Path) -> Iterator[tuple[str, str]]:
    """Paragraphs and list items of a page, without code, tables and headings."""
    text = re.sub(r"^(```|~~~).*?^\1", "", file.read_text("utf-8"), flags=re.DOTALL | re.MULTILINE)
    for part in re.split(r"\n\s*\n|\n(?=[*-] )", text):
        if len(part.split()) > 8 and not part.lstrip().startswith(("|", "#", "![", ":", "{")):
            yield str(file.relative_to(ROOT)), part.strip()


def main() -> None:
    """Print the sample."""
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    found: dict[str, list[tuple[str, str]]] = {kind: [] for kind in NUMBERS}
    for source in SOURCES:
        text, place = source.read_text("utf-8"), source.relative_to(ROOT)
        tree = ast.parse(text)
        found["docstring"] += docstrings(place, tree)
        found["message"] += messages(place, tree)
        found["comment"] += comments(place, text)
    for page in PAGES:
        found["paragraph"] += paragraphs(page)
    rng = random.Random(seed)
    for kind, number in NUMBERS.items():
        drawn = rng.sample(found[kind], min(number, len(found[kind])))
        for k, (place, text) in enumerate(drawn, 1):
            print(f"== {kind} {k} of {number}, {place}\n{text}\n")


if __name__ == "__main__":
    main()
