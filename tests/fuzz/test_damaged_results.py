"""Damaged results through every verb that reads them: one line at most, and no wrong COR.

The seed of a damage is its number, so that `FUZZ=25 pytest tests/fuzz -k "damage-123"` repeats it.
"""

import csv
import importlib.util
import os
import random
import re
import shutil
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from html.parser import HTMLParser
from pathlib import Path

import pytest

from restitution.case.case_file import parse_case
from restitution.dem.fits import fit_law
from restitution.laws.law_files import write_law
from restitution.results.writer import ResultsFolder
from restitution.runs.convergence import run_convergence
from restitution.runs.ensemble import run_realisations
from restitution.sweeps import executors
from restitution.sweeps.executors import Workers
from restitution.sweeps.scheduler import run_study
from restitution.sweeps.study_folder import StudyFolder
from restitution.sweeps.sweep import parse_study

COUNT = max(1, round(30 * float(os.environ.get("FUZZ", "1")) - 20))
FOLDERS = ("run", "ensemble", "converge", "study", "law")

pytestmark = pytest.mark.filterwarnings("ignore")  # of libraries, on numbers that are damaged

_spec = importlib.util.spec_from_file_location("damage", Path(__file__).with_name("damage.py"))
damage = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(damage)


class _Nowhere:
    def put(self, message):
        pass


@contextmanager
def in_threads(_):
    """Workers in this process: those of processes take seconds to begin."""
    with ThreadPoolExecutor(1) as executor:
        yield Workers(executor, 1, 1, _Nowhere(), list, lambda _: executor)


@pytest.fixture(scope="module")
def whole(tiny_case, tmp_path_factory):
    """One folder of each kind, as it was written."""
    at = tmp_path_factory.mktemp("whole")
    text = tiny_case
    (at / "case.toml").write_text(text)
    run_realisations(parse_case(text), text, at, ResultsFolder(at / "run"))
    several = text.replace("seed = 1", "seed = 1\nrealisations = 2")
    run_realisations(parse_case(several), several, at, ResultsFolder(at / "ensemble"))
    run_convergence(parse_case(text), text, at, ResultsFolder(at / "converge"), 2)
    study = parse_study(f'{text}[sweep]\n"roughness.seed" = [1, 2]\n')
    (at / "study.toml").write_text(study.text)
    with in_threads(None) as there:
        run_study(study, at, StudyFolder(at / "study", study, resume=False), there)
    write_law(fit_law(at / "run"), at / "law")
    return at


def verbs(kind, damaged, whole, out):
    """Command lines that read the folder `damaged` of that kind, writing to `out`."""
    compared = [
        ("compare", damaged, whole / kind, "-o", out / "rows.csv"),
        ("compare", whole / kind, damaged, "-o", out / "rows-2.csv"),
    ]
    if kind == "law":
        velocity = ("--velocity", "0.05 m/s", "-o")
        return [
            ("export", damaged, "--to", "csv", "-o", out / "csv"),
            *(
                ("export", damaged, "--to", code, *velocity, out / code)
                for code in ("lammps", "liggghts", "yade", "mercurydpm", "edem")
            ),
            ("compare-theory", whole / "case.toml", "--law", damaged, "-o", out / "theory"),
        ]
    if kind == "study":
        resume = ("study", whole / "study.toml", "-o", damaged, "--resume")
        return [("report", damaged), *compared, resume]
    law = ("fit-law", damaged, "-o", out / "law")
    return [("report", damaged), *compared, ("simulate", damaged), law]


def spoil(kind, damaged, number):
    """Damage one file of the folder; return whether its checksums were left."""
    pick = random.Random(number)
    files = sorted(path for path in damaged.rglob("*") if path.is_file() and path.suffix != ".png")
    # Most verbs read the files at the top.
    top = [path for path in files if path.parent == damaged or kind == "study"]
    path = pick.choice(top if pick.random() < 0.9 else files)
    pick.choice(damage.kinds(path))(path, pick)
    # Without checksums, content is all that tells. A netCDF file without one may end the library.
    if path.suffix != ".nc" and pick.random() < 0.5:
        for sums in damaged.rglob("SHA256SUMS"):
            if sums.is_file():
                sums.unlink()
        return False
    return path.name != "SHA256SUMS"


@pytest.mark.parametrize("number", range(COUNT), ids=lambda number: f"damage-{number}")
def test_damaged_results(number, whole, tmp_path, cli, monkeypatch):
    monkeypatch.setattr(executors, "local_workers", in_threads)
    kind = FOLDERS[number % len(FOLDERS)]
    damaged = tmp_path / kind
    shutil.copytree(whole / kind, damaged)
    (tmp_path / "out").mkdir()
    checked = spoil(kind, damaged, number)
    for verb in verbs(kind, damaged, whole, tmp_path / "out"):
        status, said, err = cli(*verb)
        words = " ".join(map(str, verb))
        assert status in (0, 1), f"{words}: {err}"
        assert "Traceback" not in said + err, words
        refusals = [line for line in err.splitlines() if line.startswith("Error: ")]
        assert len(refusals) == status, f"{words}: {err}"
        if verb[0] == "simulate":
            assert_collisions(said)
        if verb[0] == "study" and status == 0:
            assert_same(damaged / "table.csv", whole / kind / "table.csv", checked)
    for path in (*damaged.glob("report.html"), *tmp_path.glob("out/**/*.csv")):
        assert_shares(path)
    if checked and (tmp_path / "out" / "law").exists():
        write_law(fit_law(whole / kind), tmp_path / "expected")
        assert_same(tmp_path / "out/law/table.csv", tmp_path / "expected/table.csv", checked)


def assert_same(path, expected, checked):
    """What is written follows from what was computed, and not from the damage."""
    if checked:
        assert path.read_text() == expected.read_text()
    assert_shares(path)


def assert_collisions(said):
    for cor, error in re.findall(r"(\S+) +± (\d\S*)", said):
        assert 0 <= float(cor) <= 1 + float(error) + 1e-9, said


def assert_shares(path):
    """Every COR in a table or page is between 0 and 1."""
    tables = _tables(path) if path.suffix == ".html" else [_rows(path)]
    for columns, rows in tables:
        for at, name in enumerate(columns):
            if name in ("COR", "smallest COR", "largest COR") or re.fullmatch(
                r"restitution(_a|_b|_low|_high)?", name
            ):
                for row in rows:
                    if row[at] not in ("", "–"):
                        assert 0 <= float(row[at]) <= 1, f"{path}: {name}"


def _rows(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return (rows[0], rows[1:]) if rows else ([], [])  # empty: no depth in common


def _tables(path):
    page = _Tables()
    # The drawing library, most of the page, has no tables.
    page.feed(re.sub(r"<script.*?</script>", "", path.read_text(), flags=re.S))
    return [(rows[0], rows[1:]) for rows in page.tables if rows]


class _Tables(HTMLParser):
    def __init__(self):
        super().__init__()
        self.tables, self._cell = [], False

    def handle_starttag(self, tag, _):
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self._cell = True
            self.tables[-1][-1].append("")

    def handle_endtag(self, tag):
        self._cell = self._cell and tag not in ("td", "th")

    def handle_data(self, data):
        if self._cell:
            self.tables[-1][-1][-1] += data
