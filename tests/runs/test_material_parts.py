"""Which library value widens the error of COR most."""

import json

import numpy as np
import pytest

from restitution.case.case_file import parse_case
from restitution.case.materials import material, work_of_adhesion
from restitution.results.writer import ResultsFolder
from restitution.runs.companions import Companions, moved
from restitution.runs.convergence import run_convergence
from restitution.runs.ensemble import run_realisations
from restitution.runs.material_advice import MaterialPart, advice, as_rows, largest_parts
from restitution.runs.material_parts import material_parts
from tolerance import approx

SMOOTH = """
first = {{ material = "{first}", radius = "50 um"{given} }}
second = "{second}"
[interface]
work_of_adhesion = {w}
[grid]
nodes = 64
spacing = "0.25 um"
[impact]
velocity = ["0.5 m/s", "1 m/s"]
[unloading]
method = "{method}"
"""
NEW = (
    "calcite",
    "limestone",
    "talc",
    "titania",
    "starch",
    "hdpe",
    "ldpe",
    "pvc",
    "paracetamol",
    "ibuprofen",
    "mannitol",
)
# What the library lacks for some materials.
GIVEN = {
    "youngs_modulus": '"10 GPa"',
    "poissons_ratio": "0.3",
    "density": '"1300 kg/m^3"',
    "hardness": '"0.4 GPa"',
}


def text(first="lactose", second="steel", given="", w='"0 J/m^2"', method="path"):
    return SMOOTH.format(first=first, second=second, given=given, w=w, method=method)


def run(case_text, folder):
    out = ResultsFolder(folder)
    summary = run_realisations(parse_case(case_text), case_text, folder, out)
    return out.rows, summary


def companions(case_text, folder, depths=(50e-9, 100e-9)):
    return Companions(parse_case(case_text), folder, depths)


def test_one_spread_is_the_whole_material_error(tmp_path):
    """Only Young's modulus of lactose has a spread: the wall does not yield and is given."""
    given = ', poissons_ratio = 0.31, density = "1541 kg/m^3", hardness = "521 MPa"'
    wall = """second = { radius = "flat", youngs_modulus = "200 GPa", poissons_ratio = 0.3, \
hardness = "8 GPa" }"""
    rows, summary = run(text(given=given).replace('second = "steel"', wall), tmp_path / "out")
    (part,) = summary["diagnostics"]["material_errors"]
    E = material("lactose").youngs_modulus
    assert (part["key"], part["material"]) == ("first.youngs_modulus", "lactose")
    assert (part["low"], part["high"]) == (E.low, E.high)
    assert part["error"] == approx(max(row["material_error"] for row in rows), rel=1e-9)
    said = summary["diagnostics"]["material_advice"]
    assert said.startswith("most of it comes from the Young's modulus of lactose (3.45 GPa to ")
    assert said.endswith('measure it and write youngs_modulus = "... GPa" in [first]')


def test_the_contributions_need_no_curve_of_their_own(tmp_path):
    both = companions(text(), tmp_path)
    work = both.own.work[1:-1]
    changes = both.materials(work)
    known = len(both._curves)
    parts = {part.key: part for part in material_parts(both, work)}
    assert len(both._curves) == known
    assert {"first.youngs_modulus", "first.hardness", "first.density"} <= set(parts)
    assert "first.yield_strength" not in parts  # lactose has none
    whole = np.sqrt(sum(change**2 for change in changes)).max()
    assert 0.5 * whole < max(part.error for part in parts.values()) <= whole * (1 + 1e-9)


def test_the_interpolated_change_is_that_of_a_curve(tmp_path):
    both = companions(text(), tmp_path)
    work = both.own.work[1:-1]
    part = next(p for p in material_parts(both, work) if p.key == "first.poissons_ratio")
    exact = [
        np.abs(
            both.curve(both.with_modulus_of(moved(both.case, end, "first", "poissons_ratio"))).at(
                work
            )
            - both.own.at(work)
        )
        for end in ("low", "high")
    ]
    assert part.error == approx(float(np.max(exact)), rel=0.5)


def test_a_strength_that_makes_the_other_body_yield_has_its_own_curve(tmp_path):
    """Limestone is as hard as calcite, but its spread ends where that of calcite goes on."""
    both = companions(text("calcite", "limestone"), tmp_path, (300e-9, 600e-9))
    work = both.own.work[1:-1]
    parts = {part.key: part.error for part in material_parts(both, work)}
    # If calcite alone is harder, limestone still yields; if it alone is softer, calcite yields.
    assert parts["first.hardness"] == approx(parts["second.hardness"], rel=1e-9)
    assert parts["first.hardness"] > 0


def test_a_body_given_once_has_one_key(tmp_path):
    both = companions(text().replace('second = "steel"\n', ""), tmp_path)
    parts = material_parts(both, both.own.work[1:-1])
    assert {part.key.split(".")[0] for part in parts} == {"first"}


OWN = 'youngs_modulus = "20 GPa", poissons_ratio = 0.31, hardness = "5 GPa", density = "1.5 g/cm3"'
STICKY = f"""
first = {{ material = "lactose", radius = "50 um", {OWN} }}
second = {{ material = "glass", radius = "flat", {OWN} }}
interface = {{ work_of_adhesion = "library", adhesion = "jkr" }}
grid = {{ nodes = 24, spacing = "0.25 um" }}
impact = {{ velocity = ["0.05 m/s"] }}
unloading = {{ method = "energy-estimate" }}
"""


def test_the_spread_of_the_work_of_adhesion_enters_the_material_error(tmp_path):
    both = companions(STICKY, tmp_path, (10e-9,))
    assert both.case.has_library_values()
    given = parse_case(STICKY.replace('"library"', '"0.0717 J/m^2"'))
    assert not given.has_library_values()
    work = both.own.work[1:-1]
    (change,) = both.materials(work)
    (part,) = material_parts(both, work)
    w = work_of_adhesion("lactose", "glass")
    assert (part.key, part.low, part.high) == ("interface.work_of_adhesion", w.low, w.high)
    assert part.error == approx(change.max(), rel=1e-12)
    assert part.error > 1e-4
    assert part.name.startswith("work of adhesion of lactose on glass (59.75 mJ/m^2 to ")


def test_the_advice_lists_what_matters_and_what_to_type():
    def part(key, error):
        return MaterialPart(key, "lactose", 1e9, 2e9, error)

    rows = as_rows(
        [
            part("first.hardness", 0.2),
            part("first.youngs_modulus", 0.42),
            part("second.youngs_modulus", 0.01),
            part("first.youngs_modulus", 0.1),
        ]
    )
    assert json.loads(json.dumps(rows)) == rows
    assert [row["error"] for row in rows] == [0.42, 0.2, 0.01]
    said = advice(rows)
    assert "Young's modulus of lactose (1 GPa to 2 GPa): ±0.42, then the hardness" in said
    assert "±0.01" not in said
    assert advice([]) == ""
    assert largest_parts([part("first.density", 0.0)]) == []


@pytest.mark.parametrize("key", NEW)
def test_a_run_with_each_new_material(key, tmp_path):
    known = material(key)
    given = "".join(
        f", {name} = {value}"
        for name, value in GIVEN.items()
        if getattr(known, name) is None
        and not (name == "hardness" and known.yield_strength is not None)
    )
    one = text(key, given=given).replace('["0.5 m/s", "1 m/s"]', '["0.1 m/s"]')
    one = one.replace('"0.25 um"', '"1 um"' if key in ("ldpe", "starch") else '"0.5 um"')
    rows, summary = run(one, tmp_path / "out")
    assert summary["status"] == "complete"
    assert 0 < rows[0]["restitution"] <= 1
    assert rows[0]["total_error"] >= 0
    spreads = {part["key"] for part in summary["diagnostics"].get("material_errors", [])}
    assert all(entry.split(".")[1] not in given for entry in spreads if entry.startswith("first"))


def test_what_the_library_lacks_must_be_given():
    with pytest.raises(ValueError, match="youngs_modulus: is missing, because the library found"):
        parse_case(text("paracetamol"))


ROUGH = """
first = {{ material = "lactose", radius = "50 um" }}
second = "steel"
[roughness]
kind = "gaussian"
rms = "20 nm"
correlation_length = "1 um"
seed = 1
{more}
[grid]
nodes = 32
spacing = "0.25 um"
[indentation]
values = ["60 nm", "90 nm"]
"""


def test_an_ensemble_and_a_convergence_study_name_it(tmp_path):
    several = ROUGH.format(more="realisations = 2")
    rows, summary = run(several, tmp_path / "several")
    assert summary["diagnostics"]["material_errors"]
    alone = ROUGH.format(more="")
    out = ResultsFolder(tmp_path / "grids")
    study = run_convergence(parse_case(alone), alone, tmp_path, out, 2)
    assert "lactose" in study["diagnostics"]["material_advice"]
    assert rows[0]["material_error"] > 0
