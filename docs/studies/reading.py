"""Draw docstrings, comments, messages and paragraphs at random, to be read by someone else.

    python docs/studies/reading.py [SEED] [--beside FOLDER] [--key FILE]

Prints 60 docstrings, 60 comments and 40 messages of `src` and 40 paragraphs of the documentation.
Each text is printed with its surroundings: the first lines of the file and the definition that a
docstring belongs to, the code around a comment or a message, the headings above a paragraph. A
reader who does not know the code marks the texts that must be read twice.

Readers differ in how much they mark. With `--beside`, texts of the Python files in FOLDER (such as
an installed SciPy) are mixed in at random: 40 docstrings, 40 comments and 20 messages of each
source, without places and without paragraphs. `--key` writes the source and the place of each text
to FILE. The share of marked texts of FOLDER is then the reader's standard of comparison.
"""

from __future__ import annotations

import argparse
import ast
import io
import random
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("**/*.md"))]
NUMBERS = {"docstring": 60, "comment": 60, "message": 40, "paragraph": 40}
MIXED = {"docstring": 40, "comment": 40, "message": 20}  # texts of each source with --beside
FEWEST, MOST = 5, 130  # words of a text with --beside: many docstrings of SciPy are longer
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


def texts(root: Path) -> dict[str, list[Text]]:
    """Docstrings, comments and messages of the Python files below `root`, except tests."""
    found: dict[str, list[Text]] = {kind: [] for kind in MIXED}
    for source in sorted(root.rglob("*.py")):
        if "tests" in source.parts:
            continue
        text, place = source.read_text("utf-8"), source.relative_to(root.parent)
        tree = ast.parse(text)
        found["docstring"] += docstrings(place, text, tree)
        found["message"] += messages(place, text, tree)
        found["comment"] += comments(place, text, tree)
    return found


def show(kind: str, number: int, of: int, place: str, text: Text) -> None:
    """Print one text with its surroundings; `text` is its place, its surroundings and its words."""
    _, around, words = text
    surroundings = f"-- surroundings\n{around}\n" if around else ""
    print(f"== {kind} {number} of {of}{place}\n{surroundings}-- text\n{words}\n")


def sample(rng: random.Random) -> None:
    """Print texts of this project."""
    found = texts(ROOT / "src") | {
        "paragraph": [each for page in PAGES for each in paragraphs(page)]
    }
    for kind, number in NUMBERS.items():
        drawn = rng.sample(found[kind], min(number, len(found[kind])))
        for k, text in enumerate(drawn, 1):
            show(kind, k, number, f", {text[0]}", text)


def mixture(rng: random.Random, beside: Path) -> list[str]:
    """Print texts of this project and of `beside` in random order; return the key."""
    key = []
    sources = {name: texts(root) for name, root in (("ours", ROOT / "src"), ("beside", beside))}
    for kind, number in MIXED.items():
        drawn = []
        for name, found in sources.items():
            usual = [text for text in found[kind] if FEWEST <= len(text[2].split()) <= MOST]
            drawn += [(name, text) for text in rng.sample(usual, number)]
        rng.shuffle(drawn)
        for k, (name, text) in enumerate(drawn, 1):
            show(kind, k, len(drawn), "", text)
            key.append(f"{kind} {k} {name} {text[0]}\n")
    return key


def main() -> None:
    """Print the sample."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("seed", type=int, nargs="?", default=1)
    parser.add_argument("--beside", type=Path, metavar="FOLDER", help="mix in texts of this folder")
    parser.add_argument(
        "--key", type=Path, metavar="FILE", help="file for the sources of the texts"
    )
    options = parser.parse_args()
    rng = random.Random(options.seed)
    if options.beside is None:
        sample(rng)
        return
    key = mixture(rng, options.beside)
    if options.key is not None:
        options.key.write_text("".join(key), "utf-8")


if __name__ == "__main__":
    main()
