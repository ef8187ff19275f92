"""A relaxation time from one measured restitution."""

import json

from tolerance import approx

CASE = """
total_error = false
[first]
radius = "46 mm"
youngs_modulus = "1.2 GPa"
poissons_ratio = 0.35
density = "1113 kg/m^3"
relaxation_time = "30 us"
[second]
radius = "flat"
youngs_modulus = "1.2 GPa"
poissons_ratio = 0.35
[interface]
yield_pressure = "elastic"
[grid]
nodes = 32
spacing = "1 mm"
[impact]
velocity = "1 m/s"
"""


def test_one_measured_value_gives_the_relaxation_time(cli, tmp_path):
    """Both bodies share the compliance, so one alone has twice the time of Zener's equation."""
    (tmp_path / "case.toml").write_text(CASE)
    measured = "velocity_m_per_s,restitution,restitution_std\n1,0.8426,0.002\n"
    (tmp_path / "e.csv").write_text(measured)
    status, said, _ = cli(
        "fit", tmp_path / "e.csv", "--case", tmp_path / "case.toml",
        "--free", "relaxation_time", "-o", tmp_path / "fit",
    )  # fmt: skip
    assert status == 0, said
    (parameter,) = json.loads((tmp_path / "fit" / "fit.json").read_text())["parameters"]
    assert parameter["key"] == "first.relaxation_time"
    assert parameter["unit"] == "s"
    assert parameter["value"] == approx(2 * 35.4e-6, rel=0.02)
    assert parameter["low"] < parameter["value"] < parameter["high"]
