"""A size effect in every kind of run: without length as none, and only ratios of lengths count."""

from pathlib import Path

import numpy as np
import pytest
import tomli_w

from restitution import export, run
from restitution.case.case_file import parse_case
from restitution.laws.from_results import bare_law
from restitution.results.writer import ResultsFolder
from restitution.runs.convergence import run_convergence
from tolerance import approx

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")  # of these coarse grids
STRENGTHS = ({"yield_pressure": "0.83 GPa"}, {"yield_strength": "0.3 GPa"})


def tables(size_um, *, scale=1.0, w=0.0, rms_nm=10.0, interface=STRENGTHS[0], **more):
    def length(value, unit):
        return f"{value * scale!r} {unit}"

    def of(key):
        return more.pop(key, {})

    case = {
        "total_error": False,
        "first": {
            "youngs_modulus": "115 GPa",
            "poissons_ratio": 0.33,
            "density": "8900 kg/m^3",
            "radius": length(0.5, "mm"),
        },
        "second": {
            "youngs_modulus": "203 GPa",
            "poissons_ratio": 0.3,
            "density": "7800 kg/m^3",
            "radius": "flat",
        },
        "interface": {
            **interface,
            "size_effect": length(size_um, "um"),
            "work_of_adhesion": f"{w * scale!r} J/m^2",
            **of("interface_keys"),
        },
        "roughness": {
            "kind": "gaussian",
            "rms": length(rms_nm, "nm"),
            "correlation_length": length(2.0, "um"),
            "seed": 1,
            **of("roughness"),
        },
        "grid": {"nodes": 48, "spacing": length(0.4, "um"), **of("grid")},
        "impact": {"velocity": ["5 mm/s", "10 mm/s"]},
        "unloading": {"curves": 0},
    }
    return case | more


KINDS = {
    "one surface": {},
    "ensemble": {"roughness": {"realisations": 2}},
    "refined": {"grid": {"nodes": 32, "spacing": "0.6 um", "refine": "auto"}},
    "impacts": {"impacts": {"coverage": 0.3, "places": 2}},
    "jkr": {
        "w": 0.05,
        "impact": {"velocity": "5 mm/s"},
        "unloading": {"curves": 0, "method": "energy-estimate"},
    },
    "errors": {"total_error": True, "grid": {"nodes": 32}, "impact": {"velocity": "5 mm/s"}},
}


def cor(case):
    results = run(case)
    worn = [point.restitution for point in results.run_in] if "impacts" in case else []
    return np.array([*results.curve.restitution, *worn])


@pytest.mark.parametrize(
    ("kind", "interface"),
    [
        *((kind, STRENGTHS[0]) for kind in KINDS),
        ("one surface", STRENGTHS[1]),
        ("impacts", STRENGTHS[1]),
    ],
)
def test_a_vanishing_length_is_none(kind, interface):
    none, tiny, large = (
        cor(tables(size, interface=interface, **KINDS[kind])) for size in (0, 1e-6, 3)
    )
    assert tiny == approx(none, rel=1e-3 if kind in ("impacts", "jkr") else 2e-5)
    assert large.mean() > none.mean() + 1e-3


@pytest.mark.parametrize("kind", ["one surface", "impacts", "jkr"])
def test_only_ratios_of_lengths_count(kind):
    one, ten = (cor(tables(0.4, scale=scale, **KINDS[kind])) for scale in (1.0, 10.0))
    assert ten == approx(one, rel=2e-4)


COHESIVE = {
    "w": 2.0,
    "interface_keys": {"adhesion": "cohesive", "equilibrium_separation": "20 nm"},
    "impact": {"velocity": "10 mm/s"},
}


def test_attracting_bodies_yield_with_a_size_effect():
    none, tiny, large = (cor(tables(size, **COHESIVE)) for size in (0, 1e-6, 3))
    assert tiny == approx(none, rel=1e-3)
    assert large > none + 1e-3


def test_grids_of_a_convergence_study_have_one_size_effect(tmp_path):
    e = []
    for size in (0, 1e-6, 3):
        text = tomli_w.dumps(tables(size, impact={"velocity": "10 mm/s"}))
        out = tmp_path / f"{size}"
        run_convergence(parse_case(text), text, Path(), ResultsFolder(out))
        e.append(bare_law(out).column("restitution"))
    assert e[1] == approx(e[0], rel=2e-5)
    assert e[2] > e[0] + 1e-3


def test_exported_files_state_the_size_effect(tmp_path):
    for size, said in (("0.4 um", ["size effect h* = 4e-07 m"]), ("0 um", [])):
        case = tables(0)
        case["interface"]["size_effect"] = size
        out = tmp_path / size
        (notes,) = [
            path.read_text()
            for path in export(run(case, out=out).folder, to="yade", out=out / "x", velocity=0.01)
            if path.suffix == ".txt"
        ]
        assert [line for line in said if line not in notes] == []
        assert ("size effect" in notes) == bool(said)
