"""Exports in other units, and of coarse-grained particles."""

import re
from dataclasses import replace

import numpy as np
import pytest

from contacts import sticking_law
from restitution.dem.codes.lammps import write
from restitution.dem.codes.lammps_adhesive import write as write_adhesive
from restitution.dem.export import CODES, WHOLE, export
from restitution.dem.fits import with_fits
from restitution.dem.pair_table import pair_table
from restitution.dem.units import NAMES, coarse_grained, units_of
from restitution.errors import CaseError
from restitution.theory import EEPA, Luding, WaltonBraun
from tolerance import approx


@pytest.fixture(scope="module")
def sticky(law):
    """Spheres of 5 µm that stick below 93 mm/s, by JKR."""
    return sticking_law(law, replace(law().first, radius=5e-6, youngs_modulus=3e9, density=1050.0))


def precise(files):
    """The files, with more digits of e."""
    return files | {"collision.in": files["collision.in"].replace("%.6f", "%.12f")}


@pytest.mark.parametrize("name", NAMES[1:])
@pytest.mark.parametrize("fragment", ["restitution.lmp", "restitution_kokkos.lmp",
                                      "restitution_viscoelastic.lmp"])  # fmt: skip
def test_a_collision_is_the_same_in_all_units(mixed, lammps, texts, name, fragment):
    units, e = units_of(name), []
    for system in (units_of("si"), units):
        files = precise(write(mixed, 0.5, system))
        if fragment == "restitution_kokkos.lmp":
            # Its tangential model is not that of the other file; A = 0 here.
            assert f"units {system.name}" in files["collision.in"]
        files["collision.in"] = files["collision.in"].replace(
            "include restitution.lmp", f"include {fragment}"
        )
        folder = texts(files, f"{system.name}-{fragment}")
        V = system.of(0.7, "m/s")
        e += [[lammps.pair(folder, *pair, V=f"{V:.12g}") for pair in ((1, 2), (1, 3))]]
    assert e[0] == approx(e[1], rel=2e-8)  # numbers in the files have nine digits


@pytest.mark.parametrize("name", NAMES[1:])
def test_an_oblique_or_sticky_collision_is_the_same_in_all_units(sticky, lammps, texts, name):
    said = []
    for system in (units_of("si"), units_of(name)):
        folder = texts(precise(write_adhesive(pair_table([sticky]), 0.3, system)), system.name)
        for V in (0.12, 0.3):
            V = system.of(V, "m/s")
            text = lammps.says(folder, "-var", "V", f"{V:.12g}", "-var", "A", 20)
            found = re.findall(r"^(?:tangential )?restitution = (\S+)", text, re.MULTILINE)
            said.append([float(e) for e in found])
    assert len(said[0]) == 2
    assert said[:2] == [approx(e, rel=1e-6) for e in said[2:]]


def test_the_packing_falls_as_far_in_all_units(mixed, lammps, texts):
    script = ["-in", "packing.in"]
    for name in NAMES:
        units = units_of(name)
        folder = texts(write(mixed, 1.0, units), name)
        text = lammps.says(folder, *script, "-var", "steps", 200)
        energy = [line.split()[2] for line in text.splitlines() if re.match(r"\s+(0|200) ", line)]
        assert len(energy) == 2
        joules = [float(value) / units.of(1.0, "J") for value in energy]
        if name == "si":
            known = joules
        assert joules == approx(known, rel=1e-5)


@pytest.mark.parametrize("size", [0.5, 20.0])
def test_coarse_grains_rebound_as_the_real_ones(mixed, sticky, lammps, texts, size):
    laws = [law for _, _, law in mixed.pairs()]
    folder = texts(write(pair_table(laws, size), 0.5), f"dry-{size}")
    assert lammps.pair(folder, 1, 2) == approx(laws[1].at(0.5).restitution, rel=5e-4)
    e = []
    for factor in (1.0, size):
        place = texts(write_adhesive(pair_table([sticky], factor), 0.3), f"sticky-{factor}-{size}")
        e.append([lammps.pair(place, 1, 1, V=V) for V in (0.08, 0.12, 0.5)])
    assert e[0][0] == 0
    assert e[0] == approx(e[1], rel=5e-3)


def test_forces_grow_with_the_square_and_energies_with_the_cube(sticky):
    grown = coarse_grained(sticky, 10.0)
    for name, power in (("force", 2), ("pull_off_force", 2), ("loading_work", 3),
                        ("indentation", 1), ("velocity", 0), ("restitution", 0)):  # fmt: skip
        assert grown.column(name) == approx(10.0**power * sticky.column(name))
    assert grown.mass == approx(1e3 * sticky.mass)
    assert grown.work_of_adhesion == approx(10 * sticky.work_of_adhesion)


def test_fitted_laws_of_coarse_grains_keep_their_restitution(sticky):
    law = with_fits(sticky)
    grown = coarse_grained(law, 10.0)
    models = {"walton-braun": WaltonBraun, "luding": Luding, "eepa": EEPA}
    V = law.column("velocity")
    for one, fit in zip(law.laws, grown.laws, strict=True):
        if one.name in models:
            make = models[one.name]
            radius = [(law.radius,), (grown.radius,)] if one.name == "luding" else [(), ()]
            known = make(*radius[0], *one.parameters.values()).restitution(V, law.mass)
            e = make(*radius[1], *fit.parameters.values()).restitution(V, grown.mass)
            assert e == approx(np.asarray(known), rel=1e-6)


@pytest.mark.parametrize("code", [code for code in CODES if code != "csv"])
def test_every_file_says_that_its_particles_are_coarse_grained(sticky, law, code):
    laws = [sticky if "adhesive" in code else law()]
    V = None if code in WHOLE else 1.0
    for name, text in export(laws, code, V, size=10.0).items():
        said = " ".join(text.replace("#", " ").replace("//", " ").split())
        assert "particles are 10 times as large" in said, name


def test_bad_values_are_refused(law):
    with pytest.raises(CaseError, match=r"units: the files for yade are in SI units.*--to lammps"):
        export([law()], "yade", 1.0, units="micro")
    with pytest.raises(CaseError, match=r'units="mikro" is not one of si, cgs, micro.*micro'):
        export([law()], "lammps", 1.0, units="mikro")
    for size in (0.0, -1.0, float("inf"), float("nan")):
        with pytest.raises(CaseError, match=r"size: .* is not a positive number, such as 10"):
            export([law()], "lammps", 1.0, size=size)
    with pytest.raises(CaseError, match="size: the table is that of the computed particles"):
        export([law()], "csv", None, size=2.0)
