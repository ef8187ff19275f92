"""The fitted `mdr` in the export to LAMMPS: offered for a pair, or left out with the reason."""

import re
from dataclasses import replace

import pytest

from restitution import theory
from restitution.dem.codes.lammps import write
from restitution.dem.pair_table import pair_table
from restitution.laws.law import FittedLaw
from tolerance import approx

MDR = FittedLaw(
    name="lammps-mdr",
    source="",
    fitted_to="the coefficient of restitution",
    parameters={"yield_strength_Pa": 3e8, "youngs_modulus_Pa": 7e10, "poissons_ratio": 0.25},
    ends="separation",
    restitution=(),
    rms=0.05,
    worst=0.0987,
)
WEAK = replace(MDR, parameters=MDR.parameters | {"yield_strength_Pa": 2e8})


@pytest.fixture
def plate(law):
    """A wall of the material of the spheres."""
    return replace(law().first, name="plate", radius=None)


def fragment(laws, V=1.0):
    return write(pair_table(laws), V)["restitution.lmp"]


def without_breaks(text):
    return " ".join(text.replace("#", " ").split())


def opened(laws):
    """The files with every mdr line used instead of the line of the default model."""
    files = write(pair_table(laws), 1.0)
    text = files["restitution.lmp"]
    for kind in ("pair_coeff", "variable wall_"):
        if re.search(f"^# {kind}", text, re.MULTILINE):
            text = re.sub(f"^{kind}.*\n", "", text, flags=re.MULTILINE)
            text = text.replace(f"# {kind}", kind)
    files["restitution.lmp"] = text
    files["collision.in"] = files["collision.in"].replace("style sphere", "style sphere 1")
    return files


def test_one_type_is_offered_a_line_with_its_range(law):
    said = fragment([law(laws=(MDR,))])
    assert "# pair_coeff 1 1 mdr 7e+10 0.25 300000000 0.0 0.5 0.0 tangential" in said
    assert (
        "worst difference in e from the computed law is 0.099, from 0.01 to 10 m/s; do not" in said
    )
    assert "No mdr line" not in said


def test_the_line_runs_when_its_comment_is_opened(law, lammps, texts):
    expected = theory.MDR(1e-3, 7e10, 0.25, 3e8).restitution(0.5, 2 * law().mass)
    folder = texts(opened([law(laws=(MDR,))]))
    assert lammps.pair(folder, 1, 1) == approx(expected, abs=0.01)


def test_the_line_of_a_wall_runs_beside_that_of_the_spheres(law, plate, lammps, texts):
    laws = [law(laws=(MDR,)), law(law().first, plate, laws=(WEAK,))]
    said = fragment(laws)
    assert "# variable wall_1_2 string 'granular mdr 7e+10 0.25 200000000" in said
    assert "No mdr line" not in said
    folder = texts(opened(laws))
    expected = theory.MDR(1e-3, 7e10, 0.25, 2e8).restitution(1.0, laws[1].mass)
    assert lammps.pair(folder, 1, 2) == approx(expected, abs=0.01)
    expected = theory.MDR(1e-3, 7e10, 0.25, 3e8).restitution(0.5, laws[1].mass)
    assert lammps.pair(folder, 1, 1) == approx(expected, abs=0.01)


def test_a_wall_alone_is_told_what_its_line_needs(law, plate):
    said = without_breaks(fragment([law(law().first, plate, laws=(MDR,))]))
    assert "variable wall_1_2 string 'granular mdr" in said
    assert "needs atom_style sphere 1, newton off, and mdr in pair_style" in said.lower()


def test_several_types_have_no_line_and_are_told_why(mixed, plate):
    """Every pair without a line has a reason, and LAMMPS rejects the lines that are left out."""
    laws = [replace(found, laws=(MDR,)) for _, _, found in mixed.pairs()]
    said = fragment(laws)
    assert " mdr 7e" not in said
    told = without_breaks(said)
    assert "No mdr line for pairs 1 1, 1 2, 2 2: LAMMPS accepts one mdr model in a" in told
    assert "No mdr line for pairs 1 3, 2 3: LAMMPS accepts mdr at a wall only if" in told
    assert told.count("No mdr line") == 2


def test_lammps_refuses_several_mdr_or_mdr_beside_another_model(mixed, lammps, texts):
    files = write(mixed, 1.0)
    files["collision.in"] = files["collision.in"].replace("style sphere", "style sphere 1")
    line = "mdr 7e10 0.25 3e8 0 0.5 0 tangential linear_history 1e6 1 0.5 damping mdr 1\n"
    text = files["restitution.lmp"]
    for name, pattern, reason in (
        ("one", r"(^pair_coeff 1 1 ).*\n", "Cannot combine MDR normal model with a different"),
        ("all", r"(^pair_coeff . . ).*\n", "Cannot currently define multiple MDR normal models"),
    ):
        files["restitution.lmp"] = re.sub(pattern, rf"\g<1>{line}", text, flags=re.MULTILINE)
        said = lammps.says(texts(files, name), "-var", "I", 1, "-var", "J", 1, status=1)
        assert reason in said


@pytest.mark.parametrize(
    ("fits", "reason"),
    [
        ((), "no law was fitted to it"),
        (
            (replace(MDR, name="constant"),),
            "only to a sphere on a wall and to two equal",
        ),
        ((replace(MDR, worst=0.2),), "is off by up to 0.2 in e"),
    ],
)
def test_a_pair_without_a_good_fit_is_told_so(law, fits, reason):
    said = fragment([law(laws=fits)])
    assert re.search(f"^# No mdr line for pair 1 1: .*{reason}", said, re.MULTILINE)
    assert "# pair_coeff" not in said


def test_no_line_is_offered_beyond_the_velocities_of_its_fit(law):
    coarse = tuple(replace(point, resolved=point.velocity > 0.05) for point in law().points)
    found = law(laws=(MDR,), points=coarse)
    assert "fitted from 0.05623 to 10 m/s, and 0.03 m/s is outside" in fragment([found], 0.03)
    assert "# pair_coeff 1 1 mdr" in fragment([found], 0.1)
