import csv
import json
import re
import sys
from importlib.metadata import version

import numpy as np
import pytest
import xarray as xr

from restitution.numerics.kernels import instruction_set
from tolerance import approx

COLUMNS = """
max_indentation_m force_N contact_area_m2 stored_energy_J plastic_work_J loading_work_J
unloading_work_J restitution impact_velocity_m_per_s contact_nodes contact_patches
largest_patch_nodes residual convolutions pull_off_force_N pull_off_error_N separation_indentation_m
restitution_error sticks adhesion_resolved adhesive_spacing_m median_patch_nodes resolved
discretisation_error surface_scatter material_error total_error model_error refine
restitution_with_losses plate_factor waves_factor viscosity_factor loss_error
""".split()  # noqa: SIM905


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A folder for the one run of `done`, and what the run said once it is done."""
    return tmp_path_factory.mktemp("done"), []


@pytest.fixture
def done(cli, case_text, kept):
    """The folder of a run and what it said; the tests only read it."""
    folder, said = kept
    if not said:
        (folder / "case.toml").write_text(case_text)
        status, words, _ = cli("run", folder / "case.toml", "-o", folder / "out")
        assert status == 0
        said.append(words)
    return folder / "out", said[0]


def rows_of(path):
    with open(path, newline="") as file:
        reader = csv.DictReader(file)
        return reader.fieldnames, [{k: number(v) for k, v in row.items()} for row in reader]


def number(text):
    if text in ("true", "false"):
        return text == "true"
    return float(text or "nan")


def test_run_writes_every_file(done):
    out, said = done
    names = {path.name for path in out.iterdir()}
    assert names == {
        "results.nc",
        "curve.csv",
        "unloading.csv",
        "summary.json",
        "load-displacement.png",
        "restitution-indentation.png",
        "restitution-velocity.png",
        "pressure.png",
        "SHA256SUMS",
    }
    for name in names:
        assert name in said


@pytest.mark.parametrize(
    ("more", "change", "words"),
    [
        ("", ('"2 um"', '"0.6 um"'), "discretisation_error: `restitution converge` computes COR"),
        ("realisations = 2\n", None, "surface_scatter: a larger number of realisations"),
        ("", ("seed = 1", "seed = 4"), "surface_scatter: `restitution run` with realisations = 8"),
    ],
)
def test_run_names_the_largest_part_of_a_large_error(cli, case_text, tmp_path, more, change, words):
    text = case_text.replace("seed = 1\n", f"seed = 1\n{more}").replace(*change or ("", ""))
    (tmp_path / "case.toml").write_text(text)
    status, said, _ = cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert status == 0
    assert f"The largest part of the total error is {words}" in " ".join(said.split())


def test_run_names_the_library_value_that_matters_most(cli, tmp_path):
    """The spread of lactose makes COR useless: which of its values to measure?"""
    (tmp_path / "case.toml").write_text(
        'first = { material = "lactose", radius = "50 um" }\nsecond = "steel"\n'
        '[grid]\nnodes = 48\nspacing = "0.5 um"\n[impact]\nvelocity = ["3 m/s"]\n'
    )
    status, said, _ = cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert status == 0
    flowing = " ".join(said.split())
    assert "The largest part of the total error is material_error: most of it comes from" in flowing
    assert "Young's modulus of lactose (3.45 GPa to 24.1 GPa): ±0." in flowing
    assert "hardness of lactose (500 MPa to 1.5 GPa): ±0." in flowing
    assert "in [first]." in flowing


def test_run_gives_no_advice_if_the_error_is_small(cli, case_text, tmp_path):
    smooth = case_text[: case_text.index("[roughness]")] + case_text[case_text.index("[grid]") :]
    (tmp_path / "case.toml").write_text(smooth)
    status, said, _ = cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert status == 0
    assert "largest part" not in said


def test_run_writes_the_curve(done):
    names, rows = rows_of(done[0] / "curve.csv")
    assert names == COLUMNS
    depths = [row["max_indentation_m"] for row in rows]
    assert depths == approx(np.geomspace(20e-9, 300e-9, 4), rel=1e-12)
    assert all(0 < row["restitution"] < 1 for row in rows)
    mass = 4 / 3 * np.pi * 500e-6**3 * 7850 / 2
    for row in rows:
        assert 0.5 * mass * row["impact_velocity_m_per_s"] ** 2 == approx(row["loading_work_J"])


def test_run_writes_unloading_curves_down_to_separation(done):
    names, rows = rows_of(done[0] / "unloading.csv")
    assert names == ["max_indentation_m", "indentation_m", "force_N"]
    deepest = sorted({row["max_indentation_m"] for row in rows})
    assert len(deepest) == 2
    assert deepest[-1] == approx(300e-9)
    _, curve = rows_of(done[0] / "curve.csv")
    for depth in deepest:
        force = [row["force_N"] for row in rows if row["max_indentation_m"] == depth]
        loaded = [row["force_N"] for row in curve if row["max_indentation_m"] == depth]
        assert len(force) == 7
        assert force[0] == loaded[0]
        assert force[-1] == 0
        assert all(np.diff(force) < 0)


def test_results_hold_units_case_and_versions(done, case_text):
    with xr.open_dataset(done[0] / "results.nc") as results:
        assert results.attrs["case"] == case_text
        assert results.attrs["versions_restitution"] == version("restitution")
        assert results["force"].attrs["units"] == "N"
        assert results["impact_velocity"].attrs["units"] == "m s-1"
        assert all("units" in results[name].attrs for name in results.variables)
        assert results["pressure"].shape == (72, 64)
        assert float(results["pressure"].max()) <= 750e6
        area = 0.5e-6 * 0.6e-6
        assert float(results["pressure"].sum()) * area == approx(
            float(results["force"][-1]), rel=1e-12
        )
        assert float(results["x"][1] - results["x"][0]) == approx(0.5e-6)


def test_summary_says_what_made_the_numbers_and_how_far_to_trust_them(done):
    summary = json.loads((done[0] / "summary.json").read_text())
    assert summary["status"] == "complete"
    assert summary["depths_computed"] == 4
    assert summary["model"]["plasticity"] == "equilibrium"
    assert summary["diagnostics"]["largest_residual"] <= 1e-8
    assert summary["surface_statistics"]["Sq_m"] == approx(0.05e-6, rel=1e-9)
    assert summary["derived"]["contact_modulus_Pa"] == approx(112e9)
    for check in summary["diagnostics"]["unloading_checks"]:
        assert abs(check["relative_to_stored_energy"]) < 5e-3
    assert "separation" in summary["conventions"]["end_of_contact"]


def test_the_same_case_gives_the_same_numbers(cli, done, tmp_path):
    assert cli("run", done[0].parent / "case.toml", "-o", tmp_path / "again")[0] == 0
    for name in ("curve.csv", "unloading.csv"):
        assert (tmp_path / "again" / name).read_text() == (done[0] / name).read_text()


def test_the_device_is_chosen_and_recorded(cli, case_text, tmp_path, monkeypatch):
    from restitution.numerics.convolution import device

    monkeypatch.setitem(sys.modules, "cupy", None)
    device._gpu.cache_clear()
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(case_text)
    status, _, said = cli("run", case, "-o", out, "--device", "gpu")
    assert status == 1
    assert "device: gpu needs CuPy" in said
    assert "use the device cpu" in said
    assert not out.exists()
    status, _, _ = cli("run", case, "-o", out, "--device", "auto")
    assert status == 0
    assert json.loads((out / "summary.json").read_text())["device"] == "cpu"
    status, _, said = cli("run", case, "-o", tmp_path / "other", "--device", "tpu")
    assert status == 2
    assert '"tpu" is not one of cpu, gpu, auto' in said


def test_run_under_prescribed_load(cli, case_text, tmp_path):
    case = tmp_path / "case.toml"
    span = case_text[case_text.index("[indentation]") : case_text.index("[unloading]")]
    case.write_text(case_text.replace(span, '[load]\nvalues = ["2 mN", "0.03 N", "0.2 N"]\n'))
    assert cli("run", case, "-o", tmp_path / "out")[0] == 0
    _, rows = rows_of(tmp_path / "out" / "curve.csv")
    assert [row["force_N"] for row in rows] == approx([0.002, 0.03, 0.2], rel=1e-8)


def test_a_smooth_elastic_case_without_density(cli, case_text, tmp_path):
    text = re.sub(r"\[roughness\].*?(?=\[grid\])", "", case_text, flags=re.DOTALL)
    text = text.replace('density = "7850 kg/m^3"\n', "").replace('"750 MPa"', '"elastic"')
    (tmp_path / "case.toml").write_text(text)
    status, _, _ = cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert status == 0
    with open(tmp_path / "out" / "curve.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["restitution"] for row in rows] == ["1.0"] * 4
    assert [row["impact_velocity_m_per_s"] for row in rows] == [""] * 4
    assert not (tmp_path / "out" / "restitution-velocity.png").exists()


def test_a_sphere_on_a_wall(cli, case_text, tmp_path):
    wall = '[second]\nradius = "flat"\nyoungs_modulus = "70 GPa"\npoissons_ratio = 0.2\n'
    (tmp_path / "case.toml").write_text(case_text.replace("[interface]", wall + "[interface]"))
    status, said, _ = cli("check", tmp_path / "case.toml")
    assert status == 0
    assert re.search(r"reduced radius R\*\s+500\s+um", said)
    assert re.search(r"reduced mass m\*\s+4.110[23]e-06\s+kg", said)


@pytest.mark.drawn
def test_surface_writes_heights_statistics_and_a_picture(cli, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text)
    assert cli("surface", tmp_path / "case.toml", "-o", tmp_path / "out")[0] == 0
    with xr.open_dataset(tmp_path / "out" / "surface.nc") as stored:
        height = stored["height"].load()
    assert height.dims == ("x", "y")
    assert height.attrs["units"] == "m"
    assert float((height**2).mean()) ** 0.5 == approx(0.05e-6, rel=1e-9)
    statistics = json.loads((tmp_path / "out" / "statistics.json").read_text())
    assert statistics["Sq_m"] == approx(0.05e-6, rel=1e-9)
    assert {"Ssk", "Sku", "Sdq"} <= statistics.keys()
    assert (tmp_path / "out" / "surface.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.drawn
@pytest.mark.parametrize("kind", ["svg", "pdf"])
def test_figures_are_written_in_the_format_asked_for(cli, case_text, tmp_path, kind):
    case = tmp_path / "case.toml"
    case.write_text(case_text)
    read = {"run": case, "surface": case, "compare-theory": case, "fit-law": tmp_path / "run"}
    written = {}
    for verb, what in read.items():
        status, said, _ = cli(verb, what, "-o", tmp_path / verb, "--figures", kind)
        assert status == 0
        written[verb] = sorted(path.name for path in (tmp_path / verb).glob(f"*.{kind}"))
        assert all(name in said for name in written[verb])
        assert not list((tmp_path / verb).glob("*.png"))
    assert written == {
        "run": [
            f"{name}.{kind}"
            for name in (
                "load-displacement",
                "pressure",
                "restitution-indentation",
                "restitution-velocity",
            )
        ],
        "surface": [f"surface.{kind}"],
        "compare-theory": [f"theory.{kind}"],
        "fit-law": [f"law.{kind}"],
    }
    assert cli("run", case, "-o", tmp_path / "other", "--figures", "gif")[0] != 0


def test_version(cli):
    status, said, _ = cli("--version")
    assert status == 0
    assert said.splitlines() == [
        f"restitution {version('restitution')}",
        f"compiled kernels: {instruction_set}",
    ]


def test_unresolved_depths_are_said(cli, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text.replace('"20 nm"', '"1 nm"'))
    status, _, warned = cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert status == 0
    assert "fewer than 20 nodes" in warned
    assert "fewer than 20 nodes" in (tmp_path / "out" / "summary.json").read_text()
    _, rows = rows_of(tmp_path / "out" / "curve.csv")
    assert [row["resolved"] for row in rows] == [row["median_patch_nodes"] >= 20 for row in rows]
    assert not all(row["resolved"] for row in rows)


@pytest.mark.parametrize(
    "roughness",
    [
        'kind = "gaussian"\ncorrelation_length = ["6 um", "2 um"]\nlay = "30 deg"',
        'kind = "self-affine"\nhurst = 0.8\nrolloff = "12 um"\nshortest = "2 um"\nperiodic = false',
    ],
)
def test_skewed_surfaces_with_a_lay_or_a_power_law_run(cli, case_text, tmp_path, roughness):
    text = case_text.replace('kind = "gaussian"', roughness + "\nskewness = -1.2\nkurtosis = 5.5")
    (tmp_path / "case.toml").write_text(text.replace('\ncorrelation_length = "2 um"', ""))
    for verb in ("check", "run", "surface"):
        arguments = [] if verb == "check" else ["-o", tmp_path / verb]
        assert cli(verb, tmp_path / "case.toml", *arguments)[0] == 0
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    asked, found = summary["surface"], summary["surface_statistics"]
    assert (asked["skewness"], asked["kurtosis"]) == (-1.2, 5.5)
    assert (found["Ssk"], found["Sku"]) == approx((-1.2, 5.5), rel=0.05)
    _, rows = rows_of(tmp_path / "run" / "curve.csv")
    assert all(0 < row["restitution"] < 1 for row in rows)


def test_a_refined_grid_resolves_more(cli, case_text, tmp_path):
    found = []
    for refine in (1, 2):
        case, out = tmp_path / f"{refine}.toml", tmp_path / f"{refine}"
        case.write_text(case_text.replace("[indentation]", f"refine = {refine}\n[indentation]"))
        assert cli("run", case, "-o", out)[0] == 0
        summary = json.loads((out / "summary.json").read_text())
        assert summary["model"]["nodes"] == [72 * refine, 64 * refine]
        found.append(rows_of(out / "curve.csv")[1])
    coarse, fine = found
    assert all(
        b["contact_nodes"] > 2 * a["contact_nodes"] for a, b in zip(coarse, fine, strict=True)
    )
    assert fine[-1]["restitution"] == approx(coarse[-1]["restitution"], rel=0.05)


@pytest.mark.parametrize("also", ["", "work_of_adhesion = '0.02 J/m^2'\n"])
def test_velocities_instead_of_depths(cli, case_text, tmp_path, also):
    """Unequal spheres, their velocities from a table, and on two surfaces at once."""
    span = case_text[case_text.index("[indentation]") : case_text.index("[unloading]")]
    text = case_text.replace(span, '[impact]\nvelocity = ["2 mm/s", "1 cm/s"]\n')
    text = text.replace("[interface]\n", f"[interface]\n{also}").replace(
        "seed = 1", "seed = 1\nrealisations = 2"
    )
    text += '[second]\nradius = "200 um"\nyoungs_modulus = "70 GPa"\n'
    text += 'poissons_ratio = 0.3\ndensity = "2500 kg/m^3"\n'
    (tmp_path / "case.toml").write_text(text)
    assert cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")[0] == 0
    for part in ("realisation-1", "realisation-2"):
        _, rows = rows_of(tmp_path / "out" / part / "curve.csv")
        velocities = [row["impact_velocity_m_per_s"] for row in rows]
        assert velocities == approx([0.002, 0.01], rel=1e-4 if also else 1e-6)


@pytest.mark.parametrize("verb", ["check", "surface"])
def test_the_surface_is_made_once(cli, case_text, tmp_path, monkeypatch, verb):
    from restitution.case import generated

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))  # another test may have kept the surface
    made = []
    make = generated.generate_surface
    monkeypatch.setattr(
        generated, "generate_surface", lambda *a, **more: made.append(1) or make(*a, **more)
    )
    (tmp_path / "case.toml").write_text(case_text)
    out = () if verb == "check" else ("-o", tmp_path / "out")
    status, said, _ = cli(verb, tmp_path / "case.toml", *out)
    assert status == 0
    assert made == [1]
    if verb == "check":
        assert "memory of a run, at most" in said
