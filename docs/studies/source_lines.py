"""Count the lines of code of the source, without blank lines, comments and docstrings.

Statements of Python are counted, too. Their number does not depend on the formatter.

    python docs/studies/source_lines.py

prints the numbers for each folder of the package.
"""

import ast
import io
import re
import tokenize
from collections import Counter
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "src" / "restitution"
NOT_CODE = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}
COMMENT = {
    "//": r"/\*.*?\*/|//[^\n]*",  # C++ and JavaScript
    "/*": r"/\*.*?\*/",
    "{#": r"\{#.*?#\}|<!--.*?-->",
    "#": r"(?m)^\s*#[^\n]*",
}
KINDS = {
    ".cpp": "//",
    ".h": "//",
    ".js": "//",
    ".css": "/*",
    ".html": "{#",
    ".j2": "{#",
    ".toml": "#",
}


def python_lines(text):
    """How many lines of Python have code on them."""
    docstrings = {
        line
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        for line in range(node.lineno, node.end_lineno + 1)
    }
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return len(
        {
            line
            for token in tokens
            if token.type not in NOT_CODE
            for line in range(token.start[0], token.end[0] + 1)
        }
        - docstrings
    )


def statements(text):
    """How many statements Python code has, without docstrings."""
    return sum(
        isinstance(node, ast.stmt)
        and not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant))
        for node in ast.walk(ast.parse(text))
    )


def lines_of(path):
    """How many lines of code a file has; 0 if it is not source code."""
    if path.suffix == ".py":
        return python_lines(path.read_text(encoding="utf-8"))
    if path.suffix not in KINDS:
        return 0
    comment = re.compile(COMMENT[KINDS[path.suffix]], re.DOTALL)
    text = comment.sub("", path.read_text(encoding="utf-8"))
    return sum(bool(line.strip()) for line in text.splitlines())


def main():
    """Print lines and statements of Python, and lines in other languages, for each folder."""
    python, count, other = Counter(), Counter(), Counter()
    for path in filter(Path.is_file, sorted(PACKAGE.rglob("*"))):
        room = path.relative_to(PACKAGE).parts[0]
        (python if path.suffix == ".py" else other)[room] += lines_of(path)
        if path.suffix == ".py":
            count[room] += statements(path.read_text(encoding="utf-8"))
    print(f"{'room':20}{'Python':>8}{'statements':>12}{'other':>8}")
    for room in sorted(python | other):
        print(f"{room:20}{python[room]:8}{count[room]:12}{other[room]:8}")
    print(f"{'all':20}{python.total():8}{count.total():12}{other.total():8}")


if __name__ == "__main__":
    main()
