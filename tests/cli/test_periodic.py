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
    assert "restitution report" not in said
    assert {path.name for path in out.iterdir()} == {
        "SHA256SUMS",
        "area-pressure.png",
        "periodic.csv",
        "pressure.png",
        "results.nc",
        "summary.json",
    }
    for call in (("report", out), ("fit-law", out, "-o", tmp_path / "law")):
        assert "a periodic contact, which has no restitution" in refused(*call)
    assert "grid.periodic" in refused("compare-theory", case)
    assert "grid.periodic" in refused("converge", case, "-o", tmp_path / "other")
    assert not (tmp_path / "other").exists()


def test_a_periodic_case_with_adhesion(cli, refused, tmp_path):
    case, out = tmp_path / "case.toml", tmp_path / "out"
    text = CASE.replace('"elastic"', '"elastic"\nwork_of_adhesion = "0.05 J/m^2"')
    text = text.replace('"0.1 um"', '"1 nm"').replace('"2 um"', '"0.4 um"').replace("64", "32")
    text = text.replace('"0.25 um"', '"0.08 um"')
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
    case.write_text(text.replace('"0.08 um"', '"0.1 um"'))
    assert "is too coarse for the range of the attraction" in refused("check", case)
    case.write_text(text.replace("work_of", 'adhesion = "jkr"\nwork_of'))
    assert '"jkr" is not defined for a periodic contact' in refused("check", case)
