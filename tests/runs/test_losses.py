"""The columns of losses in a run, a law, a mixture and a fit."""

import gzip
import math
import re
from base64 import b64decode

import pytest

from restitution.case.case_file import parse_case
from restitution.curve.curve import loses
from restitution.laws.from_results import bare_law
from restitution.pages.run import write_run_page
from restitution.results.writer import ResultsFolder
from restitution.runs.losses import loss_information, loss_warnings
from restitution.runs.run import run_case
from tolerance import approx

CASE = """
total_error = false
first = { material = "steel", radius = "3 mm" }
second = { material = "steel", radius = "flat", thickness = "3 mm", loss_tangent = 0.02 }
[grid]
nodes = 64
spacing = "9 um"
[impact]
velocity = ["0.3 m/s", "1 m/s"]
[unloading]
curves = 2
"""


def run(text, folder):
    out = ResultsFolder(folder)
    run_case(parse_case(text), text, folder.parent, out)
    return out


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    return run(CASE, tmp_path_factory.mktemp("plate") / "out")


def test_the_product_stands_beside_the_quasi_static_restitution(results):
    for point in results.curve.points:
        product = point.plate_factor * point.waves_factor * point.viscosity_factor
        assert point.restitution_with_losses == approx(point.restitution * product)
        assert point.final == point.restitution_with_losses
        assert point.final_ratio == approx(point.final**2)
        assert point.loss_error < 5e-3
        assert point.waves_factor == approx(0.997, abs=1.5e-3)
        assert point.viscosity_factor == approx(1 - 1.41 * 0.01, abs=1.5e-3)
    deep = results.curve.points[-1]
    assert deep.restitution == approx(0.9997, abs=1e-3)
    assert deep.plate_factor == approx(0.768, abs=2e-3)
    assert loses(results.curve.points)


def test_the_law_returns_the_product(results):
    law = bare_law(results.path)
    for point, impact in zip(law.points, results.curve.points, strict=True):
        assert point.restitution == impact.restitution_with_losses
        assert point.quasi_static == impact.restitution
        assert point.factors["plate"] == impact.plate_factor
        assert point.error >= impact.loss_error
    assert law.losses == ("plate", "waves", "viscosity")
    assert law.conventions.restitution.endswith("times the factors of plate, waves, viscosity")
    assert law.at(1.0).restitution == approx(results.curve.points[-1].final, abs=1e-6)
    between = float(results.curve.with_losses_at(0.6))
    assert law.points[1].restitution < between < law.points[0].restitution


def test_two_spheres_keep_their_numbers(tmp_path):
    alone = CASE.replace(', thickness = "3 mm", loss_tangent = 0.02', "").replace(
        'radius = "flat"', 'radius = "3 mm"'
    )
    for point in run(alone, tmp_path / "out").curve.points:
        assert point.restitution_with_losses == point.restitution
        assert point.plate_factor == point.waves_factor == point.viscosity_factor == 1.0
        assert point.loss_error == 0.0


@pytest.mark.parametrize(
    "keys", ["", ', thickness = "1 km"', ", loss_tangent = 1e-14", ', relaxation_time = "1e-15 s"']
)
def test_a_loss_that_vanishes_leaves_the_restitution(tmp_path, keys):
    text = CASE.replace(', thickness = "3 mm", loss_tangent = 0.02', keys)
    for point in run(text, tmp_path / "out").curve.points:
        without_waves = point.restitution_with_losses / point.waves_factor
        assert without_waves == approx(point.restitution, abs=1e-9 if keys else 1e-12)


def test_without_densities_nothing_is_known(tmp_path):
    text = CASE.replace(
        'first = { material = "steel", radius = "3 mm" }',
        'first = { radius = "3 mm", youngs_modulus = "200 GPa", poissons_ratio = 0.3, '
        'yield_strength = "2 GPa" }',
    )
    impact = '[impact]\nvelocity = ["0.3 m/s", "1 m/s"]'
    text = text.replace(impact, '[indentation]\nvalues = ["2 um"]')
    (point,) = run(text, tmp_path / "out").curve.points
    assert math.isnan(point.restitution_with_losses)
    assert point.final == point.restitution


def test_a_rough_contact_has_a_longer_pulse_and_smaller_losses(tmp_path):
    rough = CASE.replace("[grid]", '[roughness]\nkind = "gaussian"\nrms = "1 um"\n'
        'correlation_length = "60 um"\nseed = 1\n[grid]')  # fmt: skip
    smooth = run(CASE, tmp_path / "smooth").curve.points[0]
    point = run(rough, tmp_path / "rough").curve.points[0]
    assert smooth.plate_factor < point.plate_factor < 1


def test_adhesion_and_losses_together(tmp_path):
    """Each unloading curve is used; the bodies stick at the lower velocity."""
    text = """
total_error = false
first.radius = "20 um"
first.youngs_modulus = "5 GPa"
first.poissons_ratio = 0.3
first.density = "1200 kg/m^3"
second.radius = "flat"
second.youngs_modulus = "5 GPa"
second.poissons_ratio = 0.3
second.density = "1200 kg/m^3"
[interface]
yield_pressure = "elastic"
work_of_adhesion = "0.1 J/m^2"
adhesion = "jkr"
[grid]
nodes = 48
spacing = "0.1 um"
[impact]
velocity = ["5 mm/s", "0.5 m/s"]
[unloading]
curves = 1
"""
    slow, fast = run(text, tmp_path / "out").curve.points
    assert slow.restitution_with_losses == slow.restitution == 0.0
    assert math.isnan(slow.waves_factor)
    assert slow.final_ratio < 0
    assert 0.9 < fast.waves_factor < 1
    assert fast.final < fast.restitution


def test_the_range_of_a_plate_is_checked():
    thin, thick = parse_case(CASE), parse_case(CASE.replace('"3 mm", loss', '"40 mm", loss'))
    assert loss_warnings(thin) == []
    (warning,) = loss_warnings(thick)
    assert "thickness: at the highest velocity" in warning
    assert "free of edges and supports within" in loss_information(thin)
    assert "internal friction" in loss_information(thin)


def test_the_report_has_the_factors(results):
    page = write_run_page(results.path).read_text()
    assert all(f"factor of {name}" in page for name in ("plate", "waves", "viscosity"))
    packed = re.search(r'const FIGURES = "([^"]+)"', page)[1]
    assert "with plate, waves and viscosity" in gzip.decompress(b64decode(packed)).decode()
