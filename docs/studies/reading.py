"""Draw docstrings, comments, messages and paragraphs at random, to be read by someone else.

    python docs/studies/reading.py [SEED]

Prints 60 docstrings, 60 comments and 40 messages of `src` and 40 paragraphs of the documentation.
Each text is printed with its surroundings: the first lines of the file and the definition that a
docstring belongs to, the code around a comment or a message, the headings above a paragraph. A
reader who does not know the code marks the texts that must be read twice.
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
CODE_BEFORE, CODE_AFTER = 8, 8  # lines of code around a comment or a message
Text = tuple[str, str, str]  # place, surroundings, text


def docstrings(file: Path, text: str, tree: ast.Module) -> Iterator[Text]:
    """Docstrings of modules, classes and functions."""
    about = _about(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            docstring = ast.get_docstring(node)
            if docstring and isinstance(node, ast.Module):
                yield f"{file}:1", "", docstring
            elif docstring:
                definition = "\n".join(text.splitlines()[node.lineno - 1 : node.body[0].lineno - 1])
                yield f"{file}:{node.lineno}", f"{about}\n…\n{definition}", docstring


def messages(file: Path, text: str, tree: ast.Module) -> Iterator[Text]:
    """Texts of errors and warnings, with `{…}` in place of values."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or not node.args:
            continue
        name = getattr(node.func, "id", getattr(node.func, "attr", ""))
        message = _text(node.args[0])
        if ERRORS.search(name) and len(message.split()) > 3:
            yield f"{file}:{node.lineno}", _code(text, node.lineno, node.lineno), message


def _text(node: ast.expr) -> str:
    """The text of a string, with `{…}` in place of each value."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    if isinstance(node, ast.JoinedStr):
        return "".join(_text(part) or "{…}" for part in node.values)
    if isinstance(node, ast.BinOp):
        return _text(node.left) + _text(node.right)
    return ""


def comments(file: Path, text: str, tree: ast.Module) -> Iterator[Text]:
    """Comments; consecutive lines without code are one comment."""
    blocks: list[list[tokenize.TokenInfo]] = []
    alone = False  # whether the last comment has a line of its own
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type != tokenize.COMMENT or "noqa" in token.string or "type:" in token.string:
            continue
        continued = alone and token.start[0] == blocks[-1][-1].start[0] + 1
        alone = token.line.lstrip().startswith("#")
        if not (continued and alone):
            blocks.append([])
        blocks[-1].append(token)
    for block in blocks:
        first, last = block[0].start[0], block[-1].start[0]
        words = " ".join(token.string.lstrip("# ") for token in block)
        yield f"{file}:{first}", f"{_about(tree)}\n…\n{_code(text, first, last)}", words


def _about(tree: ast.Module) -> str:
    """The first paragraph of the docstring of a module."""
    return (ast.get_docstring(tree) or "").partition("\n\n")[0]


def _code(text: str, first: int, last: int) -> str:
    """Lines `first` to `last` of a file and the lines around them."""
    return "\n".join(text.splitlines()[max(first - 1 - CODE_BEFORE, 0) : last + CODE_AFTER])


def paragraphs(file: Path) -> Iterator[Text]:
    """Paragraphs and list items of a page, without code, tables and headings."""
    text = re.sub(r"^(```|~~~).*?^\1", "", file.read_text("utf-8"), flags=re.DOTALL | re.MULTILINE)
    headings: dict[int, str] = {}
    for part in re.split(r"\n\s*\n|\n(?=[*-] )", text):
        if heading := re.match(r"(#+) (.*)", part.lstrip()):
            level = len(heading[1])
            headings = {n: words for n, words in headings.items() if n < level} | {
                level: heading[2]
            }
        elif len(part.split()) > 8 and not part.lstrip().startswith(("|", "![", ":", "{")):
            yield str(file.relative_to(ROOT)), " > ".join(headings.values()), part.strip()


def main() -> None:
    """Print the sample."""
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    found: dict[str, list[Text]] = {kind: [] for kind in NUMBERS}
    for source in SOURCES:
        text, place = source.read_text("utf-8"), source.relative_to(ROOT)
        tree = ast.parse(text)
        found["docstring"] += docstrings(place, text, tree)
        found["message"] += messages(place, text, tree)
        found["comment"] += comments(place, text, tree)
    for page in PAGES:
        found["paragraph"] += paragraphs(page)
    rng = random.Random(seed)
    for kind, number in NUMBERS.items():
        drawn = rng.sample(found[kind], min(number, len(found[kind])))
        for k, (place, around, words) in enumerate(drawn, 1):
            surroundings = f"-- surroundings\n{around}\n" if around else ""
            print(f"== {kind} {k} of {number}, {place}\n{surroundings}-- text\n{words}\n")


if __name__ == "__main__":
    main()
