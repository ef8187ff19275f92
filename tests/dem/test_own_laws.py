"""What exports say of their time step, and of the laws e(V) that a code has."""

import re
from dataclasses import replace

import pytest

from restitution.dem.codes.lammps import write
from restitution.dem.damping import viscoelastic_damping, viscoelastic_restitution_at
from restitution.dem.export import ADHESIVE, CODES, WHOLE, export
from restitution.dem.pair import contact_time
from restitution.dem.pair_table import pair_table
from tolerance import approx


def viscoelastic_law(law, damping):
    """A law with the e(V) of a viscoelastic Hertz contact."""
    base = law()
    e = viscoelastic_restitution_at(base, damping, base.column("velocity")).tolist()
    points = tuple(
        replace(p, restitution=x, ratio=x**2) for p, x in zip(base.points, e, strict=True)
    )
    return replace(base, points=points)


def test_lammps_has_the_viscoelastic_law_that_it_was_given(law, lammps, texts):
    found = viscoelastic_law(law, 3e9)
    assert viscoelastic_damping(found) == approx(3e9, rel=1e-3)
    files = write(pair_table([found]), 1.0)
    assert "e(V) within" in files["restitution_viscoelastic.lmp"]
    collision = files["collision.in"].replace("restitution.lmp", "restitution_viscoelastic.lmp")
    folder = texts(files | {"collision.in": collision})
    for V in (0.02, 0.3, 5.0):
        assert lammps.pair(folder, 1, 1, V=V) == approx(found.at(V).restitution, rel=2e-3)


def test_the_closest_law_is_named_with_its_misfit(law):
    files = write(pair_table([viscoelastic_law(law, 3e9)]), 1.0)
    for name in ("restitution.lmp", "restitution_lammps.txt"):
        said = " ".join(files[name].replace("#", " ").split())
        file, best = re.search(
            r"From 0.01 to 10 m/s, e of these files \(one e\) is off by up to (\S+)\. Closest of "
            r"the laws of LAMMPS: restitution_viscoelastic.lmp, (\S+)\.",
            said,
        ).groups()
        assert float(file) > 0.05
        assert float(best) < 1e-3


def test_yade_has_the_law_itself_and_one_e_is_off_as_stated(law):
    base = law()
    said = " ".join(export([base], "yade", 1.0)["restitution_yade.txt"].split())
    off = max(abs(base.column("restitution") - base.at(1.0).restitution))
    assert f"is off by up to {off:.2g}. Closest of the laws of YADE: e(V) by 'follow', 0" in said


@pytest.mark.parametrize("code", [code for code in CODES if code not in ("csv", *ADHESIVE)])
def test_every_file_has_a_time_step_in_figures(law, code):
    base = law()
    shortest = contact_time(base) * base.highest**-0.2
    for name, text in export([base], code, None if code in WHOLE else 1.0).items():
        said = " ".join(text.replace("#", " ").replace("//", " ").split())
        assert f"the shortest contact ({shortest:.3g} s, pair 1 1 at 10 m/s" in said, name
        if code != "drake":
            step, parts = re.search(r"Time step: at most (\S+) s, 1/(\d+) of", said).groups()
            assert float(step) == approx(shortest / int(parts), rel=6e-3)
