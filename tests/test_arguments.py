"""Arguments of a wrong type are named, with the right call."""

import inspect
import math
import pickle

import numpy as np
import pytest

import restitution as rs
from restitution.arguments import typed
from restitution.errors import CaseError

GRID = rs.Grid(8, 1e-6)
Z = np.zeros((8, 8))
STEEL = rs.Body(radius=1e-4, youngs_modulus=2e11, poissons_ratio=0.3)
PAIR = rs.Pair(STEEL, STEEL)
SURFACE = rs.Surface(Z, GRID)
CONTACT = rs.Contact(PAIR, SURFACE)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (
            lambda: rs.Surface(GRID, Z),
            "height: a Grid is not an array of numbers; grid: an array of shape (8, 8) of float64 "
            "is not a Grid; call Surface(height, grid), with numpy.array(…) and "
            "Grid(nodes, spacing)",
        ),
        (
            lambda: rs.Surface([[0.0]], GRID),
            "height: a list is not an array of numbers; call Surface(height, grid), with "
            "numpy.array(…)",
        ),
        (lambda: rs.Surface(Z.astype(str), GRID), "height: an array of shape (8, 8) of <U32 is"),
        (lambda: rs.Surface(Z), "Surface(): missing a required argument: 'grid'; call Surface("),
        (
            lambda: rs.Body("1 mm", 2e11, 0.3),
            'radius: "1 mm" is not a number; call Body(radius, youngs_modulus, poissons_ratio)',
        ),
        (
            lambda: rs.Body(1e-4, 2e11, 0.3, "7800"),
            'density: "7800" is not a number or None; call Body(radius, youngs_modulus, '
            "poissons_ratio, density=…)",
        ),
        (lambda: rs.Pair(STEEL, 1e-4), "second: 0.0001 is not a Body; call Pair(first, second)"),
        (
            lambda: rs.Contact(SURFACE, PAIR),
            "pair: a Surface is not a Pair; surface: a Pair is not a Surface; call "
            "Contact(pair, surface), with Pair(first, second) and Surface(height, grid), "
            "generate_surface(grid, …) or read_surface(file)",
        ),
        (
            lambda: rs.Contact(PAIR, SURFACE, periodic="false"),
            'periodic: "false" is not a flag; call Contact(pair, surface, periodic=…)',
        ),
        (
            lambda: rs.generate_surface(Z, kind="gaussian", rms=1e-7, seed=1),
            "grid: an array of shape (8, 8) of float64 is not a Grid; call "
            "generate_surface(grid, kind=…, rms=…, seed=…), with Grid(nodes, spacing)",
        ),
        (
            lambda: rs.generate_surface(GRID, "gaussian", 1e-7, 1),
            "generate_surface(): too many positional arguments; call generate_surface(grid, kind=…",
        ),
        (lambda: rs.solve(SURFACE, 1e-7), "contact: a Surface is not a Contact; call solve("),
        (lambda: rs.solve(1e-7, CONTACT), "is not a number; call solve(contact, indentation)"),
        (lambda: rs.solve(CONTACT, "100 nm"), 'indentation: "100 nm" is not a number'),
        (
            lambda: rs.step(CONTACT, 1e-7),
            "state: a Contact is not a State; call step(state, indentation), with "
            "solve(contact, indentation)",
        ),
        (lambda: rs.collide(CONTACT), "state: a Contact is not a State; call collide(state)"),
        (lambda: rs.unloading_path(CONTACT), "state: a Contact is not a State"),
        (
            lambda: rs.composite(SURFACE),
            "surfaces: a Surface is not a list of Surface; call composite(surfaces), with Surface(",
        ),
        (lambda: rs.composite([Z]), "surfaces: a list is not a list of Surface"),
        (lambda: rs.refine(Z, 2), "surface: an array of shape (8, 8) of float64 is not a Surface"),
        (lambda: rs.run("case.toml", "out"), "run(): too many positional arguments; call run(case"),
        (lambda: rs.material(STEEL), "name: a Body is not a text; call material(name)"),
    ],
)
def test_what_is_wrong_and_the_right_call(call, said):
    with pytest.raises(TypeError) as refused:
        call()
    assert said in str(refused.value)
    assert isinstance(refused.value, CaseError)


def test_numbers_of_any_kind_are_accepted():
    for radius in (1, np.float32(1), np.array(1.0), np.int64(1), math.inf):
        assert rs.Body(radius, 2e11, 0.3).radius == radius
    whole = rs.Surface(np.zeros((8, 8), dtype=int), GRID)
    assert rs.Contact(PAIR, whole, periodic=np.False_).surface is whole
    assert rs.collide(rs.solve(CONTACT, 1e-8), None).restitution == 1


@pytest.mark.parametrize("name", [name for name in rs.__all__ if callable(getattr(rs, name))])
def test_every_public_function_and_class_is_checked(name):
    public = getattr(rs, name)
    made_here = {
        "CohesiveLaw",
        "Plasticity",
        "State",
        "RestitutionError",
        "ObliqueCollision",
        "operator_cache",
    }
    call = public.__init__ if isinstance(public, type) else public
    assert name in made_here or hasattr(call, "__wrapped__")
    assert public.__doc__


def test_a_checked_function_is_itself_elsewhere():
    assert pickle.loads(pickle.dumps(rs.solve)) is rs.solve
    assert "indentation" in inspect.signature(rs.solve).parameters
    assert inspect.signature(rs.Body).parameters["density"].default is None


def test_a_result_is_not_changed():
    @typed
    def double(x: float, *others: float, name: str = "") -> float:
        return 2 * x

    assert double(3, "a", "b", name="c") == 6
    with pytest.raises(TypeError, match="x: None is not a number"):
        double(None)
