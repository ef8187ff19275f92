"""The paper's figures: bundled studies, claims that can fail, and the page."""

import re

import numpy as np
import pytest
import xarray as xr

from restitution.reproduce import studies as bundles
from restitution.reproduce.claims import CLAIMS, CaseCurve, critical_indentation, curves
from restitution.reproduce.studies import NAMES, bundled
from tolerance import approx

# Small enough for a test: each figure, but on few nodes and depths.
TINY = {
    "hertz": {"grid.nodes": 64, "indentation.to": "200 nm", "indentation.steps": 2},
    "thornton-ning": {"grid.nodes": 96, "indentation.to": "200 nm", "indentation.steps": 2},
    "jkr": {
        "grid.nodes": 96,
        "grid.spacing": "0.12 um",
        "indentation.from": "20 nm",
        "indentation.to": "30 nm",
        "indentation.steps": 2,
    },
    "smooth-yield": {
        "grid.nodes": 128,
        "indentation.steps": 4,
        "indentation.to": "110 nm",
        "indentation.from": "4 nm",
        "grid.spacing": "0.14 um",
    },
    "smooth-energy": {
        "indentation.steps": 4,
        "indentation.to": "110 nm",
        "indentation.from": "4 nm",
        "sweep.grid.nodes": [128, 128, 128],
        "sweep.grid.spacing": ["0.14 um", "0.14 um", "0.14 um"],
    },
    "roughness": {
        "grid.nodes": 128,
        "indentation.to": "400 nm",
        "indentation.steps": 5,
        "indentation.from": "4 nm",
        "sweep.roughness.rms": ["1 pm", "0.1 um", "0.2 um"],
    },
    "critical": {
        "grid.nodes": 192,
        "indentation.to": "1.2 um",
        "indentation.steps": 6,
        "sweep.roughness.rms": ["1 pm", "0.02 um", "0.04 um", "0.06 um"],
        "sweep.roughness.seed": [1],
    },
    "rough-yield": {"grid.nodes": 128, "indentation.to": "300 nm", "indentation.steps": 4},
    "rough-energy": {
        "grid.nodes": 128,
        "indentation.to": "300 nm",
        "indentation.steps": 4,
        "indentation.from": "4 nm",
    },
}

for name in ("smooth-yield", "smooth-energy", "roughness", "rough-yield", "rough-energy"):
    TINY[name]["unloading.method"] = "energy-estimate"


@pytest.mark.parametrize("size", ["quick", "paper", "refined"])
def test_every_bundled_study_is_a_valid_one(size):
    for name in NAMES:
        study = bundled(name, size)
        assert study.title.startswith("Figure")
        assert study.cases
    assert bundled("roughness", "refined").text.count("refine = 2") == 1


def curve(depth, cor):
    depth, cor = np.asarray(depth), np.asarray(cor)
    return CaseCurve("x", depth, cor, cor, cor, np.ones(cor.size, bool))


def test_the_critical_indentation_is_where_the_last_difference_falls_below_five_percent():
    depth = [1.0, 2.0, 3.0, 4.0, 5.0]
    smooth = curve(depth, [0.9, 0.8, 0.7, 0.6, 0.5])
    found = critical_indentation(curve(depth, [0.5, 0.79, 0.63, 0.6, 0.5]), smooth)
    assert found == approx(3 * (4 / 3) ** 0.5)  # half way from 10 % to none
    assert critical_indentation(smooth, smooth) == 1.0
    assert np.isnan(critical_indentation(curve(depth, [0.9, 0.8, 0.7, 0.6, 0.4]), smooth))


@pytest.fixture(scope="module")
def reproduced(tmp_path_factory):
    """A reproduction of the tiniest size, through the command line."""
    import subprocess
    import sys

    out = tmp_path_factory.mktemp("reproduce") / "out"
    patched = (
        "import sys; from restitution.reproduce import studies\n"
        f"studies._QUICK.clear(); studies._QUICK.update({TINY!r})\n"
        "from restitution.cli import main\n"
        "if __name__ == '__main__':\n"
        f"    sys.argv = ['restitution', 'reproduce', '-o', {str(out)!r}, '--quick']\n"
        "    main()\n"
    )
    script = out.parent / "tiny.py"
    script.write_text(patched)
    done = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, timeout=400, check=False
    )
    assert done.returncode == 0, done.stderr
    return out, done.stdout


@pytest.fixture
def stored(reproduced):
    found = {}
    for name in NAMES:
        with xr.open_dataset(reproduced[0] / name / "study.nc") as study:
            found[name] = study.load()
    return found


def test_every_claim_has_a_verdict_with_its_number(reproduced, stored):
    findings = [claim(stored) for claim in CLAIMS]
    assert {finding.figure for finding in findings} == {str(k) for k in range(5, 15)}
    by_figure = {finding.figure: finding for finding in findings}
    assert by_figure["5"].verdict == "agrees"
    assert by_figure["6"].verdict == "agrees"
    assert by_figure["13"].verdict == "agrees"
    for finding in findings:
        assert re.fullmatch(r"\d+ of \d+", finding.resolved)
        assert np.isfinite(finding.number) or finding.verdict == "not decided"
        assert finding.verdict in reproduced[1]


@pytest.mark.parametrize(
    ("study", "variable", "spoil", "figure"),
    [
        ("hertz", "force", lambda v: 1.1 * v, "5"),
        ("thornton-ning", "force", lambda v: 1.1 * v, "6"),
        ("jkr", "force", lambda v: 1.2 * v, "7"),
        ("smooth-yield", "restitution", lambda v: np.sort(v, axis=-1), "8"),
        ("smooth-energy", "restitution", lambda v: v + np.arange(3)[:, None] / 5, "9"),
        ("rough-yield", "restitution", lambda v: 0 * v + 0.5, "13"),
        ("rough-energy", "restitution", lambda v: v + np.arange(2)[:, None] / 1.5, "14"),
    ],
)
def test_claims_fail_where_the_numbers_do_not_bear_them_out(stored, study, variable, spoil, figure):
    stored[study][variable] = stored[study][variable].copy(
        data=spoil(stored[study][variable].values)
    )
    found = [f for f in (claim(stored) for claim in CLAIMS) if f.figure == figure]
    assert all(finding.verdict == "does not agree" for finding in found)


def test_a_line_is_fitted_from_three_roughnesses_on(stored):
    depth = np.linspace(1e-6, 20e-6, 400)
    study = stored["critical"]
    keys = ["roughness.rms", "roughness.seed"]
    cor = np.full((4, 1, 400), 0.5)
    for k, rms in enumerate((0.1, 0.2, 0.5), 1):
        cor[k, 0, depth < 20e-6 * rms / 1.0] = 0.2
    depths = np.broadcast_to(depth, cor.shape)
    made = xr.Dataset(
        {
            name: ((*keys, "depth"), depths if name == "indentation" else cor)
            for name in study.variables
            if name not in ("status", *keys)
        },
        {keys[0]: ["1 pm", "0.1 um", "0.2 um", "0.5 um"], keys[1]: ["1"]},
    )
    made["status"] = (tuple(keys), np.full((4, 1), "complete"))
    (finding,) = [f for f in (c({**stored, "critical": made}) for c in CLAIMS) if f.figure == "11"]
    assert finding.verdict == "agrees"
    assert finding.number > 0.99
    assert re.match(r"i_cr,max = (10|9\.9) mm", finding.result)
    assert len(curves(made)) == 4


def test_the_page_is_drawn(reproduced, opened):
    drawn, console = opened(reproduced[0] / "report.html")
    assert console == []
    assert 'data-drawn="10"' in drawn
    for k in range(5, 15):
        assert f"Figure {k}" in drawn
    assert "What the paper leaves open" in drawn


def test_sizes_exclude_each_other_and_nothing_is_overwritten(refused, tmp_path):
    out = tmp_path / "out"
    assert "give only one" in refused("reproduce", "-o", out, "--quick", "--refined")
    out.mkdir()
    (out / "thesis.txt").write_text("")
    assert "not empty" in refused("reproduce", "-o", out)
    assert bundles.NAMES == NAMES
