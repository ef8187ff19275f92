"""The examples run as they stand, and their contacts are resolved."""

import importlib.util
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from restitution import read_surface
from restitution.case.case_file import read_case
from restitution.results.reader import read_run
from tolerance import approx

EXAMPLES = Path(__file__).parents[2] / "examples"
CASES = sorted(path.name for path in EXAMPLES.glob("*.toml"))
# Step of the stored heights (m).
SCANS = {
    "glass-bead.txt": 0.1e-9,
    "lactose.x3p": 0.2e-9,
    "steel-wall-afm-1.txt": 0.1e-9,
    "steel-wall-afm-2.txt": 0.1e-9,
    "steel-wall-optical.txt": 0.1e-9,
}


@pytest.fixture
def generated(tmp_path):
    """A folder with the scans, generated again."""
    spec = importlib.util.spec_from_file_location("scans", EXAMPLES / "generate_scans.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.main(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", CASES)
def test_every_example_is_valid_and_listed(cli, name):
    status, said, _ = cli("check", EXAMPLES / name)
    assert status == 0
    assert "The case is valid" in said
    assert f"`{name}`" in (EXAMPLES / "README.md").read_text()


def shortened(name, folder):
    """The case `name` with its lowest, a middle and its highest velocity, on two surfaces."""
    for path in EXAMPLES.iterdir():
        if path.is_file():
            shutil.copy(path, folder)
    text = (EXAMPLES / name).read_text()
    V = read_case(EXAMPLES / name)[0].depths()
    asked = ", ".join(f'"{v} m/s"' for v in (V[0], V[len(V) // 2], V[-1]))
    head, _, after = text.partition("[impact]")
    _, _, rest = after.partition("\n[")
    text = f"{head}[impact]\nvelocity = [{asked}]\n" + (f"[{rest}" if rest else "")
    text = re.sub(r"realisations = \d+", "realisations = 2", text)
    (folder / "short.toml").write_text(f"total_error = false\n{text}")
    return folder / "short.toml"


@pytest.mark.parametrize("name", CASES)
def test_every_example_runs_and_resolves_its_contact(cli, tmp_path, name):
    if name == "lactose.toml":
        pytest.importorskip("SurfaceTopography")
    case = shortened(name, tmp_path)
    assert cli("run", case, "-o", tmp_path / "out")[0] == 0
    results = read_run(tmp_path / "out").dataset
    assert results.sizes["indentation_max"] == 3
    assert results["resolved"].values.all()
    cor = results["restitution"].values
    assert (cor > 0.3).all()
    assert (cor[1:] < 0.99).all()
    assert cor[0] <= 1


def test_the_scans_are_those_that_the_script_generates(generated):
    pytest.importorskip("SurfaceTopography")
    for name, step in SCANS.items():
        stored, again = (
            read_surface(folder / name, undefined="interpolate") for folder in (EXAMPLES, generated)
        )
        assert stored.grid == again.grid
        assert np.abs(stored.height - again.height).max() < 1.5 * step


def test_the_dem_example_resolves_every_velocity_from_1_mm_per_s_to_10_m_per_s(cli, tmp_path):
    text = (EXAMPLES / "dem.toml").read_text().replace("curves = 17", "curves = 0")
    (tmp_path / "dem.toml").write_text(f"total_error = false\n{text}")
    assert cli("run", tmp_path / "dem.toml", "-o", tmp_path / "out")[0] == 0
    results = read_run(tmp_path / "out").dataset
    velocities = results["impact_velocity"].values
    assert (velocities[0], velocities[-1]) == approx((1e-3, 10.0), rel=1e-3)
    assert results["resolved"].values.all()


@pytest.mark.parametrize(
    ("name", "scan", "rms"),
    [("glass-bead", "glass-bead.txt", 20e-9), ("lactose", "lactose.x3p", 0.1e-6)],
)
def test_detrending_leaves_the_roughness_that_was_generated(name, scan, rms):
    if scan.endswith(".x3p"):
        pytest.importorskip("SurfaceTopography")
    raw = read_surface(EXAMPLES / scan, undefined="interpolate")
    assert np.std(raw.height) > 1.5 * rms
    case, _ = read_case(EXAMPLES / f"{name}.toml")
    assert np.std(case.realisation(0).surface(EXAMPLES).height) == approx(rms, rel=0.05)
