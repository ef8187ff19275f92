"""The study file: the keys that vary, and the cases that follow."""

import tomllib

import pytest

from restitution.case.case_file import parse_case
from restitution.errors import CaseError
from restitution.sweeps.sweep import parse_study

SWEEP = """
[sweep]
"roughness.rms" = ["0.05 um", "0.1 um", "0.2 um"]
"interface.yield_pressure" = ["150 MPa", "750 MPa"]
"""


def test_a_grid_has_every_combination_the_last_quantity_fastest(case_text):
    study = parse_study(case_text + SWEEP)
    assert study.shape == (3, 2)
    assert [tuple(case.values.values()) for case in study.cases[:3]] == [
        ("0.05 um", "150 MPa"),
        ("0.05 um", "750 MPa"),
        ("0.1 um", "150 MPa"),
    ]
    case = parse_case(study.cases[4].text)
    assert (case.roughness[0].rms, case.interface.yield_pressure) == (0.2e-6, 150e6)
    assert [case.number for case in study.cases] == [1, 2, 3, 4, 5, 6]


def test_paired_lists_go_side_by_side(case_text):
    study = parse_study(
        case_text + '[sweep]\nmode = "paired"\nroughness.rms = ["0.1 um", "0.2 um"]\n'
        "roughness.seed = [3, 4]\n"
    )
    assert study.shape == (2,)
    assert [dict(case.values) for case in study.cases] == [
        {"roughness.rms": "0.1 um", "roughness.seed": 3},
        {"roughness.rms": "0.2 um", "roughness.seed": 4},
    ]


def test_all_else_stays_as_it_is(case_text):
    swept = tomllib.loads(parse_study(case_text + SWEEP).cases[3].text)
    base = tomllib.loads(case_text)
    swept["interface"]["yield_pressure"] = base["interface"]["yield_pressure"]
    swept["roughness"]["rms"] = base["roughness"]["rms"]
    assert swept == base


def test_tables_that_are_not_there_are_made_and_lists_are_values(case_text):
    study = parse_study(
        case_text + '[sweep]\n"second.radius" = ["flat"]\n"grid.nodes" = [[64, 64], 72]\n'
        '"second.youngs_modulus" = ["1 GPa"]\n"second.poissons_ratio" = [0.3]\n'
    )
    first, last = (parse_case(case.text) for case in study.cases)
    assert first.grid.nodes == (64, 64)
    assert last.grid.nodes == (72, 72)
    assert first.second.radius is None


def test_one_of_several_tables_is_named_by_its_number(case_text):
    start = case_text.index("[roughness]")
    table = case_text[start : case_text.index("[grid]")].replace("[roughness]", "[[roughness]]")
    two = case_text[:start] + table * 2 + case_text[case_text.index("[grid]") :]
    study = parse_study(two + '[sweep]\n"roughness.2.seed" = [8]\n')
    assert [part.seed for part in parse_case(study.cases[0].text).roughness] == [1, 8]
    for key, words in (
        ("roughness.seed", "there are 2 tables; select one by its number"),
        ("roughness.3.seed", "is not the number of a table"),
    ):
        with pytest.raises(CaseError, match=words):
            parse_study(two + f'[sweep]\n"{key}" = [8]\n')


@pytest.mark.parametrize(
    ("sweep", "words"),
    [
        ("", r"\[sweep\] is missing"),
        ("[sweep]\n", "sweep: is empty"),
        ("[sweep]\nmode = 'random'\n'roughness.seed' = [1]", 'sweep.mode: "random" should be'),
        ("[sweep]\n'roughness.seed' = 3", "sweep.roughness.seed: 3 should be a list"),
        ("[sweep]\n'roughness.seed' = []", r"sweep.roughness.seed: \[\] should be a list"),
        ("[sweep]\n'roughness.sed' = [1]", "roughness.sed = 1: roughness.sed: unknown key"),
        ("[sweep]\n'roughness.rms' = ['1 kg']", 'with roughness.rms = "1 kg": roughness.rms'),
        ("[sweep]\n'title.x' = [1]", '"title" is a value, not a table'),
        (
            "[sweep]\nmode = 'paired'\n'roughness.seed' = [1, 2]\n'roughness.rms' = ['1 um']",
            "needs lists of equal length; the lengths are roughness.seed 2, roughness.rms 1",
        ),
        ("[sweep", "not valid TOML"),
    ],
)
def test_what_is_wrong_is_said(case_text, sweep, words):
    with pytest.raises(CaseError, match=words):
        parse_study(case_text + sweep)


def test_too_many_cases_are_refused_before_they_are_made(case_text):
    many = list(range(1000))
    with pytest.raises(CaseError, match="gives 1000000 cases"):
        parse_study(case_text + f"[sweep]\n'roughness.seed' = {many}\n'first.density' = {many}\n")
