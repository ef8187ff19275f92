"""Results of older versions: columns that they lack, and what `resolved` meant."""

import math

import numpy as np
import xarray as xr

from restitution.case.case_file import parse_case
from restitution.results.checksums import CHECKSUMS
from restitution.results.reader import LATER, REQUIRED, RunResults, as_now, dataset_as_now
from restitution.results.schema import COLUMNS
from restitution.results.writer import ResultsFolder
from restitution.runs.run import run_case


def test_a_row_gets_empty_columns_and_adhesion_in_resolved():
    for resolved, adhesion, both in ((1.0, 1.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)):
        row = as_now({"resolved": resolved, "adhesion_resolved": adhesion})
        assert row["resolved"] == both
        assert all(math.isnan(row[name]) for name in LATER)
    assert as_now({"resolved": 1.0}) == {"resolved": 1.0}
    assert set(REQUIRED) | LATER == set(COLUMNS)


def test_a_dataset_gets_the_same():
    stored = xr.Dataset(
        {
            "resolved": ("indentation_max", [True, True]),
            "adhesion_resolved": ("indentation_max", [True, False]),
        }
    )
    now = dataset_as_now(stored)
    assert now["resolved"].values.tolist() == [True, False]
    assert np.isnan(now["pull_off_error"].values).all()


def test_a_folder_without_the_later_columns_is_read(case_text, tmp_path):
    out = ResultsFolder(tmp_path / "out")
    run_case(parse_case(case_text), case_text, tmp_path, out)
    lines = [line.split(",") for line in (out.path / "curve.csv").read_text().splitlines()]
    keep = [k for k, name in enumerate(lines[0]) if name not in LATER]
    older = "\n".join(",".join(row[k] for k in keep) for row in lines) + "\n"
    (out.path / "curve.csv").write_text(older)
    (out.path / CHECKSUMS).unlink()
    rows = RunResults(out.path).curve.rows
    assert len(rows) == len(out.rows)
    assert all(math.isnan(row["pull_off_error_N"]) for row in rows)
