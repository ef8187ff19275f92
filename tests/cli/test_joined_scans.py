"""`check`, `surface`, `run` and `report` of a case with several scans of one surface."""

import json

import numpy as np
import pytest

from tolerance import approx
from virtual_instruments import KnownSurface

KNOWN = KnownSurface()
CASE = """
total_error = true
first = { material = "steel", radius = "250 um" }
[interface]
work_of_adhesion = "0 J/m^2"
yield_pressure = "2.8 Y"
[grid]
nodes = 48
spacing = "0.5 um"
[impact]
velocity = ["0.3 m/s"]
[unloading]
curves = 0
[roughness]
kind = "joined"
seed = 1
below_grid = "omit"
[[roughness.scan]]
file = "optical.npy"
size = "100 um"
[[roughness.scan]]
file = "afm.npy"
size = "15 um"
"""


@pytest.fixture
def case(tmp_path):
    for seed, (name, edge) in enumerate({"optical": 100e-6, "afm": 15e-6}.items()):
        np.save(tmp_path / f"{name}.npy", KNOWN.scan(edge, 96, seed).height)
    (tmp_path / "case.toml").write_text(CASE)
    return tmp_path / "case.toml"


def test_check_names_the_next_measurement(cli, case):
    status, said, _ = cli("check", case)
    assert status == 0
    assert "Next measurement: a scan with waves from" in said
    assert "twin of 2 scans" in said
    assert "were not measured and are absent" in said


def test_surface_draws_and_stores_the_joined_spectrum(cli, case, tmp_path):
    out = tmp_path / "out"
    status, said, _ = cli("surface", case, "-o", out)
    assert status == 0
    assert "joined-spectrum.png" in said
    assert "afm.npy" in said
    (told,) = json.loads((out / "statistics.json").read_text())["joined_spectra"]
    q, C = np.array(told["wave_number"]), np.array(told["density"])
    assert 2 * np.pi / q.min() == approx(told["longest_m"], rel=0.2)
    assert np.abs(np.log(C / KNOWN.density(q))[q > 2 * np.pi / 10e-6]).max() < 0.5
    assert set(told["scans"]) == {"optical.npy", "afm.npy"}
    page = (out / "surface.html").read_text()
    assert "Joined power spectrum" in page
    assert "shorter waves end at" in page


def test_a_run_includes_the_uncertainty_of_the_spectrum(cli, case, tmp_path):
    def scatter(name, keys):
        path = case.with_name(f"{name}.toml")
        path.write_text(CASE.replace("seed = 1\n", f"seed = 1\n{keys}"))
        assert cli("run", path, "-o", tmp_path / name)[0] == 0
        summary = json.loads((tmp_path / name / "summary.json").read_text())
        header, row = (tmp_path / name / "curve.csv").read_text().splitlines()
        return summary, dict(zip(header.split(","), row.split(","), strict=True))

    summary, point = scatter("run", "")
    assert "uncertainty of the joined spectrum" in summary["diagnostics"]["total_error_includes"]
    assert summary["surface"]["scan_1_name"] == "optical.npy"
    levels = [scatter(f"at{d}", f"deviations = {d}\n")[1] for d in ("-2.0", "2.0")]
    change = max(abs(float(one["restitution"]) - float(point["restitution"])) for one in levels)
    assert float(point["surface_scatter"]) > 0.5 * change > 0
    assert cli("report", tmp_path / "run")[0] == 0
    assert "Waves that each scan shows" in (tmp_path / "run" / "report.html").read_text()
