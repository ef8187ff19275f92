"""The header for MercuryDPM: its text, and its syntax with stand-ins for MercuryDPM."""

import re
import shutil
import subprocess
from dataclasses import replace

import pytest

from restitution.dem.codes.mercurydpm import write
from restitution.dem.fits import with_fits
from restitution.dem.pair_table import pair_table
from restitution.errors import CaseError
from tolerance import approx

# The parts of MercuryDPM that the header uses, as its sources declare them.
DPM_BASE = """
#pragma once
using Mdouble = double;
struct SpeciesHandler {
    template <typename U> U* copyAndAddObject(const U& object) { return new U(object); }
    template <typename U> typename U::MixedSpeciesType* getMixedObject(const U*, const U*)
    { static typename U::MixedSpeciesType mixed; return &mixed; }
};
struct DPMBase { SpeciesHandler speciesHandler; };
"""
SPECIES = """
#pragma once
struct Mixed {
    void setEffectiveElasticModulusAndRestitutionCoefficient(Mdouble E, Mdouble e);
    void setEffectiveShearModulus(Mdouble G);
    void setSlidingFrictionCoefficient(Mdouble mu);
};
struct HertzianViscoelasticMindlinSpecies : Mixed {
    using MixedSpeciesType = Mixed;
    void setDensity(Mdouble rho);
};
"""


def test_types_and_pairs_get_their_moduli_and_restitution(mixed):
    text = write(mixed, 1.0)["restitution_mercury.h"]
    calls = re.findall(r"setRestitution\((.*), (\S+), (\S+), (\S+), (\S+)\);", text)
    by_target = {target.split(".")[-1]: values for target, *values in calls}
    law = mixed.laws[1, 2]
    modulus, shear, e, friction = map(float, by_target["getMixedObject(species[0], species[1])"])
    assert modulus == approx(law.contact_modulus, rel=1e-8)
    assert e == approx(law.at(1.0).restitution, rel=1e-8)
    assert friction == 0.5
    assert shear == approx(1 / (2 * 1.75 * 1.25 / 70e9 + 2 * 1.7 * 1.3 / 200e9))
    assert len(calls) == 3 + 3  # three types, three mixed pairs
    assert text.count("copyAndAddObject(type)") == 3
    assert "was not compiled or run with MercuryDPM" in text


def test_it_is_valid_beside_stand_ins(mixed, hostile, law, texts):
    compiler = shutil.which("g++") or pytest.skip("g++ is not installed")
    bad = law(hostile, hostile, title="*/ x \\", warnings=("??/\nint y; \\",))
    for number, table in enumerate((mixed, pair_table([bad]))):
        main = '#include "restitution_mercury.h"\nvoid f(DPMBase& d) { addRestitutionSpecies(d); }'
        folder = texts({**write(table, 1.0), "DPMBase.h": DPM_BASE, "f.cc": main}, str(number))
        (folder / "Species").mkdir()
        (folder / "Species" / "HertzianViscoelasticMindlinSpecies.h").write_text(SPECIES)
        command = [compiler, "-std=c++17", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I."]
        done = subprocess.run([*command, "f.cc"], cwd=folder, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


PLASTIC_SPECIES = """
#pragma once
struct Plastic {
    void setPlasticParameters(Mdouble k1, Mdouble k2, Mdouble kc, Mdouble phi);
    void setDissipation(Mdouble d);
    void setSlidingStiffness(Mdouble k);
    void setSlidingFrictionCoefficient(Mdouble mu);
};
struct LinearPlasticViscoelasticFrictionSpecies : Plastic {
    using MixedSpeciesType = Plastic;
    void setDensity(Mdouble rho);
};
"""


def test_the_plastic_species_have_the_fitted_law_and_its_misfit(mixed, texts):
    compiler = shutil.which("g++") or pytest.skip("g++ is not installed")
    laws = [with_fits(law) for _, _, law in mixed.pairs()]
    files = write(pair_table(laws), 1.0)
    text = files["restitution_mercury_plastic.h"]
    calls = re.findall(r"setPlastic\((?!S)(.*), (\S+), (\S+), (\S+), (\S+), (\S+), (\S+)\);", text)
    assert len(calls) == 3 + 3  # three types, three mixed pairs
    fit = next(fit for fit in laws[1].laws if fit.name == "luding")
    values = next(values for to, *values in calls if "species[0], species[1]" in to)
    assert [float(value) for value in values[:4]] == approx([*fit.parameters.values()], rel=1e-8)
    said = " ".join(text.replace("//", " ").split())
    assert f"Pair 1 2: e(V) is off by up to {fit.worst:.2g}; it needs" in said
    assert "needs time steps of at most" in said
    notes = " ".join(files["restitution_mercurydpm.txt"].split())
    assert f"of MercuryDPM: restitution_mercury_plastic.h, {fit.worst:.2g}" in notes
    main = '#include "restitution_mercury_plastic.h"\nvoid f(DPMBase& d) { addPlasticSpecies(d); }'
    folder = texts({**files, "DPMBase.h": DPM_BASE, "f.cc": main})
    (folder / "Species").mkdir()
    header = folder / "Species" / "LinearPlasticViscoelasticFrictionSpecies.h"
    header.write_text(PLASTIC_SPECIES)
    command = [compiler, "-std=c++17", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I."]
    done = subprocess.run([*command, "f.cc"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_a_wall_keeps_its_density(law):
    plate = replace(law().first, name="plate", radius=None, density=7850.0)
    for density, written in ((7850.0, "7850"), (None, "1000")):
        wall = replace(plate, density=density)
        text = write(pair_table([law(), law(law().first, wall)]), 1.0)["restitution_mercury.h"]
        assert re.findall(r"setDensity\((\S+)\)", text) == ["2500", written]


def test_warnings_are_carried(law):
    text = write(pair_table([law(warnings=("the grid is coarse",))]), 1.0)["restitution_mercury.h"]
    assert "// WARNING: pair 1 1: the grid is coarse" in text


def test_missing_pairs_are_named(mixed):
    laws = {(i, j): law for i, j, law in mixed.pairs()}
    with pytest.raises(CaseError, match=r"MercuryDPM needs a separate law for every pair"):
        write(pair_table([law for pair, law in laws.items() if pair != (1, 2)]), 1.0)
    with pytest.raises(CaseError, match=r"MercuryDPM needs .* steel .* and plate"):
        write(pair_table([law for pair, law in laws.items() if pair != (2, 3)]), 1.0)


def test_a_wall_alone_is_a_header_that_needs_e_of_the_spheres(on_wall, texts):
    compiler = shutil.which("g++") or pytest.skip("g++ is not installed")
    main = '#include "restitution_mercury.h"\nvoid f(DPMBase& d) { addRestitutionSpecies(d, %s); }'
    for number, (e, status) in enumerate((("0.9", 0), ("", 1))):
        files = write(on_wall, 1.0)
        folder = texts({**files, "DPMBase.h": DPM_BASE, "f.cc": main % e}, str(number))
        (folder / "Species").mkdir()
        (folder / "Species" / "HertzianViscoelasticMindlinSpecies.h").write_text(SPECIES)
        command = [compiler, "-std=c++17", "-Wall", "-Werror", "-fsyntax-only", "-I.", "f.cc"]
        assert subprocess.run(command, cwd=folder, capture_output=True).returncode == status
