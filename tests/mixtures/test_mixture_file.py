"""The mixture file: what it takes, and one line for what it refuses."""

import pytest

from restitution.case.case_file import parse_case
from restitution.case.materials import work_of_adhesion
from restitution.errors import CaseError
from restitution.mixtures.family import families
from restitution.mixtures.mixture_file import parse_mixture
from tolerance import approx

RADII = '["50 um", "80 um", "150 um"]'


def test_every_pair_is_there_once(mixture_text):
    found = families(parse_mixture(mixture_text()))
    counts = {family.name: len(family.pairs) for family in found}
    assert counts == {
        "alu+alu": 6,
        "alu+pmma": 3,
        "alu+drum": 3,
        "pmma+pmma": 1,
        "pmma+drum": 1,
    }
    assert all(not family.first.wall for family in found)


@pytest.mark.parametrize(
    ("radius", "radii"),
    [
        ('"70 um"', [70e-6]),
        ('{ edges = ["20 um", "80 um", "180 um"] }', [40e-6, 120e-6]),
        ('{ bins = [["20 um", "80 um"], ["100 um", "400 um"]] }', [40e-6, 200e-6]),
        ('{ median = "100 um", geometric_std = 1.5, count = 1 }', [100e-6]),
        # Quartiles of a normal distribution lie 0.6745 standard deviations from its mean.
        (
            '{ median = "100 um", geometric_std = 1.5, count = 2 }',
            [100e-6 / 1.5**0.6744898, 100e-6 * 1.5**0.6744898],
        ),
    ],
)
def test_sizes(mixture_text, radius, radii):
    mixture = parse_mixture(mixture_text((RADII, radius)))
    assert mixture.components[0].radii == approx(radii, rel=1e-7)


@pytest.mark.parametrize(
    ("sizes", "radii", "fractions"),
    [
        (RADII, (50e-6, 80e-6, 150e-6), (1 / 3, 1 / 3, 1 / 3)),
        (f"{RADII}\nnumber_fractions = [0.5, 0.3, 0.2]", (50e-6, 80e-6, 150e-6), (0.5, 0.3, 0.2)),
        # In the order of the file, whatever the sizes.
        (
            '["80 um", "50 um"]\nnumber_fractions = [0.75, 0.25]',
            (50e-6, 80e-6),
            (0.25, 0.75),
        ),
        # The same mass: eight times as many particles of half the radius.
        ('["50 um", "100 um"]\nmass_fractions = [0.5, 0.5]', (50e-6, 100e-6), (8 / 9, 1 / 9)),
        (
            '{ bins = [["80 um", "320 um"], ["20 um", "80 um"]] }\nmass_fractions = [0.8, 0.2]',
            (40e-6, 160e-6),
            (16 / 17, 1 / 17),
        ),
        # Rounded fractions: the sum is made 1.
        (f"{RADII}\nnumber_fractions = [0.33, 0.33, 0.33]", (50e-6, 80e-6, 150e-6), (1 / 3,) * 3),
    ],
)
def test_fractions_of_the_sizes(mixture_text, sizes, radii, fractions):
    component = parse_mixture(mixture_text((RADII, sizes))).components[0]
    assert component.radii == approx(radii, rel=1e-9)
    assert component.fractions == approx(fractions, rel=1e-9)


def test_a_pair_may_have_an_interface_of_its_own(mixture_text):
    own = '[pairs."drum+alu"]\nwork_of_adhesion = "0.05 J/m^2"\n[grid]'
    mixture = parse_mixture(mixture_text(("[grid]", own)))
    found = {family.name: family.case(family.radii[0]) for family in families(mixture)}
    assert 'work_of_adhesion = "0.05 J/m^2"' in found["alu+drum"]
    assert 'work_of_adhesion = "0 J/m^2"' in found["alu+alu"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[grid]", '[pairs."alu+copper"]\n[grid]', 'pairs."alu+copper": is not a pair of'),
        (RADII, '{ bins = [["20 um", "80 um"], ["70 um", "90 um"]] }', "bins: overlap between"),
        (RADII, '{ edges = ["20 um", "10 um"] }', "edges: must increase"),
        (RADII, '{ median = "20 um" }', "give edges, or bins, or median and geometric_std"),
        (RADII, '["50 um mm"]', "materials.alu.radius"),
        (RADII, '["50 um", "50 um"]', "materials.alu.radius: a radius is given twice"),
        (RADII, '["50"]', "has no unit"),
        (f"radius = {RADII}\n", "", "materials.alu.radius: is missing"),
        (
            'material = "pmma"',
            'youngs_modulus = "3 GPa"\npoissons_ratio = 0.4',
            "materials.pmma.density: is missing",
        ),
        ('material = "pmma"', 'material = "unobtainium"', "materials.pmma"),
        ('material = "steel"', 'material = "steel"\nradius = "1 mm"', "a wall is flat"),
        (RADII, f"{RADII}\nmass_fractions = [0.5, 0.5]", "has 2 values for 3 sizes"),
        (RADII, f"{RADII}\nmass_fractions = [0.5, 0.5, 0.5]", "the sum is 1.5, but should be 1"),
        (
            RADII,
            f"{RADII}\nmass_fractions = [1.0, 0.5, -0.5]",
            "-0.5 should be above 0 and at most 1",
        ),
        (
            RADII,
            f"{RADII}\nmass_fractions = [1.0, nan, 0.5]",
            "nan should be above 0 and at most 1",
        ),
        (
            RADII,
            f"{RADII}\nnumber_fractions = ['20 %', 0.5, 0.3]",
            "materials.alu.number_fractions: '20 %' should be a number without a unit",
        ),
        (RADII, f"{RADII}\nmass_fractions = 1", "should be a list with a fraction for each size"),
        (
            RADII,
            f"{RADII}\nmass_fractions = [1]\nnumber_fractions = [1]",
            "give mass_fractions or number_fractions, not both",
        ),
        (
            RADII,
            '{ median = "100 um", geometric_std = 1.5, count = 2 }\nmass_fractions = [0.5, 0.5]',
            "always hold equal numbers of particles",
        ),
        ('material = "steel"', 'material = "steel"\nmass_fractions = [1]', "a wall has no sizes"),
        ("[walls.drum]", "[walls.alu]", "walls.alu: is also the name of a material"),
        ("[impact]", "[impacts]", "impacts.from: unknown key"),
        ("[impact]", "[imapct]", "imapct: unknown key"),
        ('from = "0.1 m/s"', 'from = "2 m/s"', "`from` must be smaller than `to`"),
        ('rms = "0.05 um"', 'rms = "0.05"', "materials.alu.roughness.rms"),
        ("seed = 1", 'seed = "one"', "materials.alu.roughness.seed"),
        ('radius = "100 um"', 'radius = "100 um"\nroughness = "fine"', "materials.pmma.roughness"),
        (
            'radius = "100 um"',
            'radius = "100 um"\nrelaxation_time = "1 us"',
            "materials.pmma.relaxation_time: is not used in a mixture",
        ),
        (
            'radius = "100 um"',
            'radius = "100 um"\nthickness = "1 mm"',
            "materials.pmma.thickness: belongs to a wall",
        ),
    ],
)
def test_what_is_refused(mixture_text, old, new, words):
    with pytest.raises(CaseError) as refused:
        families(parse_mixture(mixture_text((old, new))))
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_wall_has_a_thickness_and_all_have_internal_friction(mixture_text):
    sheet = ('material = "steel"', 'material = "steel"\nthickness = "1 mm"')
    soft = ('material = "pmma"', 'material = "pmma"\nloss_tangent = 0.05')
    walls = [one for one in families(parse_mixture(mixture_text(sheet, soft))) if one.second.wall]
    losses = {one.first.name: parse_case(one.case(one.radii[0])).losses() for one in walls}
    assert losses["alu"].plate.thickness == losses["pmma"].plate.thickness == 1e-3
    assert losses["alu"].viscosity is None
    assert losses["pmma"].damping(1e-6).time > 0


def test_no_two_surfaces_of_a_pair_have_the_same_seed(mixture_text):
    """Surfaces of one seed have the same phases: their waves would add up."""
    other = 'radius = "100 um"\nroughness = { kind = "gaussian", rms = "0.1 um", '
    other += 'correlation_length = "4 um", seed = 0 }'
    mixture = parse_mixture(mixture_text(('radius = "100 um"', other)))
    for family in families(mixture):
        parts = parse_case(family.case(family.radii[0])).roughness
        assert len({part.seed for part in parts}) == len(parts)
    cases = {family.name: family.case(family.radii[0]) for family in families(mixture)}
    assert len(parse_case(cases["alu+pmma"]).roughness) == 2


def test_each_pair_may_take_its_work_of_adhesion_from_the_library(mixture_text):
    text = mixture_text(
        ('material = "aluminium"', 'material = "glass"'),
        ('material = "pmma"', 'material = "polystyrene"'),
        ('material = "steel"', 'material = "stainless-steel"'),
        ('"0 J/m^2"', '"library"'),
    )
    w = {
        frozenset((case.first.material, case.second.material)): case.interface.work_of_adhesion
        for family in families(parse_mixture(text))
        for case in [parse_case(family.case(100e-6))]
    }
    assert len(w) == 5
    for pair, energy in w.items():
        assert energy == work_of_adhesion(min(pair), max(pair)).value
    unknown = text.replace('"polystyrene"', '"pmma"')
    with pytest.raises(CaseError, match="no surface energy of pmma"):
        [parse_case(family.case(100e-6)) for family in families(parse_mixture(unknown))]


def test_friction_belongs_to_pairs_and_angles_are_refused(mixture_text):
    text = mixture_text()
    assert "[impact]" in text
    for key, value in (("angle", "30 deg"), ("spin", "5 rpm")):
        with pytest.raises(CaseError, match=f"impact.{key}: a mixture has laws of head-on impacts"):
            parse_mixture(text.replace("[impact]", f'[impact]\n{key} = "{value}"'))


def test_impacts_are_those_of_every_pair_and_give_laws_at_their_coverage(mixture_text):
    text = mixture_text().replace("[grid]", "[impacts]\ncoverage = [1, 3]\nplaces = 8\n\n[grid]")
    mixture = parse_mixture(text)
    assert mixture.coverage == 3
    for family in families(mixture):
        case = parse_case(family.case(family.radii[0]))
        assert case.impacts.coverage == [1, 3]
        assert case.grid.refine == 1
    counted = text.replace("coverage = [1, 3]", "count = 100")
    with pytest.raises(CaseError, match=r"impacts\.count: a mixture needs coverage"):
        parse_mixture(counted)


def test_the_roughness_of_a_pair_stays_on_its_bodies(mixture_text):
    text = mixture_text().replace("[grid]", "[impacts]\ncoverage = 1\n\n[grid]")
    owners = {
        family.name: parse_case(family.case(family.radii[0])).impacts.rough
        for family in families(parse_mixture(text))
    }
    assert owners["alu+alu"] == ["first", "second"]
    assert owners["alu+pmma"] == ["first"]  # the plastic yields, and is smooth
    assert owners["pmma+pmma"] is None
    with pytest.raises(CaseError, match=r"impacts\.rough: .* remove this key"):
        parse_mixture(text.replace("coverage = 1", 'coverage = 1\nrough = "both"'))
