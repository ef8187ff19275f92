"""The command line on a periodic case."""

import csv

CASE = """
first = "steel"
[interface]
yield_pressure = "elastic"
[roughness]
kind = "self-affine"
rms = "0.1 um"
hurst = 0.8
shortest = "2 um"
seed = 1
[grid]
nodes = 64
spacing = "0.25 um"
periodic = true
[pressure]
values = ["0.5 GPa", "1 GPa"]
"""
DEPTHS = '[indentation]\nvalues = ["60 nm", "120 nm"]'


def test_check_run_and_what_a_periodic_case_is_not_for(cli, refused, tmp_path):
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(CASE)
    status, said, warned = cli("check", case)
    assert (status, warned) == (0, "")
    assert "mean gap at first touch" in said
    assert "reduced radius" not in said
    status, said, _ = cli("run", case, "-o", out)
    assert status == 0
    assert "mean gap (nm)" in said
    assert "restitution report" in said
    assert {path.name for path in out.iterdir()} == {
        "SHA256SUMS",
        "area-pressure.png",
        "periodic.csv",
        "pressure-distribution.png",
        "pressure.png",
        "results.nc",
        "stiffness-pressure.png",
        "summary.json",
    }
    for call in (
        ("fit-law", out, "-o", tmp_path / "law"),
        ("simulate", out),
        ("compare", out, out),
    ):
        words = refused(*call)
        assert "a periodic contact, which has no restitution" in words
        assert "`restitution report`" in words
    assert "grid.periodic" in refused("converge", case, "-o", tmp_path / "other")
    assert not (tmp_path / "other").exists()


def test_the_area_is_compared_with_persson(cli, refused, tmp_path):
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(CASE)
    status, said, warned = cli("compare-theory", case)
    assert (status, warned) == (0, "")
    assert "Relative contact area of the rough surface; a periodic contact has no COR" in said
    assert "computed (%)" not in said
    theory = [float(line.split()[1]) for line in said.splitlines()[2:4]]
    assert cli("run", case, "-o", out)[0] == 0
    status, said, _ = cli("compare-theory", out, "-o", tmp_path / "theory")
    assert status == 0
    with (tmp_path / "theory" / "theory.csv").open() as file:
        rows = [{key: float(cell) for key, cell in row.items()} for row in csv.DictReader(file)]
    with (out / "periodic.csv").open() as file:
        stored = list(csv.DictReader(file))
    for row, computed, area in zip(rows, stored, theory, strict=True):
        assert row["computed"] == float(computed["corrected_relative_area"])
        assert row["stiffness_Pa_per_m"] == float(computed["stiffness_Pa_per_m"])
        assert abs(100 * row["persson"] / area - 1) < 1e-3
        assert f"{row['computed'] / row['persson']:.3f}" in said
    assert (tmp_path / "theory" / "theory.png").exists()
    assert "has no restitution law" in refused("compare-theory", out, "--law", out)
    case.write_text(CASE.replace('[pressure]\nvalues = ["0.5 GPa", "1 GPa"]', DEPTHS))
    assert "only a run tells the nominal pressures" in refused("compare-theory", case)


def test_a_periodic_case_with_adhesion(cli, refused, tmp_path):
    case, out = tmp_path / "case.toml", tmp_path / "out"
    text = CASE.replace('"elastic"', '"elastic"\nwork_of_adhesion = "0.05 J/m^2"')
    text = text.replace('"0.1 um"', '"1 nm"').replace('"2 um"', '"0.4 um"').replace("64", "32")
    text = text.replace('"0.25 um"', '"0.06 um"')
    case.write_text(text)
    assert "a periodic contact with adhesion needs [indentation]" in refused("check", case)
    text = text.replace(
        '[pressure]\nvalues = ["0.5 GPa", "1 GPa"]', '[indentation]\nvalues = ["0.2 nm", "0.4 nm"]'
    )
    case.write_text(text)
    assert cli("run", case, "-o", out)[0] == 0
    with (out / "periodic.csv").open() as file:
        shallow, deep = (
            {key: float(value) for key, value in row.items() if value not in ("true", "false")}
            for row in csv.DictReader(file)
        )
    assert shallow["nominal_pressure_Pa"] < 0
    assert deep["relative_area"] > shallow["relative_area"] > 0
    for row in (shallow, deep):
        stored = row["loading_work_J"] + row["adhesive_work_J"]
        assert abs(stored - row["stored_energy_J"]) <= 1e-12 * row["stored_energy_J"]
        assert row["adhesive_work_J"] > 0
    case.write_text(text.replace('"0.06 um"', '"0.08 um"'))
    assert "too coarse for the range of the attraction" in refused("check", case)
    case.write_text(text.replace("work_of", 'adhesion = "jkr"\nwork_of'))
    assert '"jkr" is not defined for a periodic contact' in refused("check", case)
