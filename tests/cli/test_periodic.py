"""The command line on a periodic case."""

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
