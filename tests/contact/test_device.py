"""Devices: arrays other than NumPy's, tested with a stand-in for a GPU.

Like arrays of CuPy, those of the stand-in follow NumPy's protocols and refuse implicit conversion
to NumPy arrays. Code that converts them implicitly, or passes them to a function that does not
support them, fails here as it would on a GPU.
"""

import math
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import scipy.fft
from numpy.testing import assert_allclose

from contact_keys import contact_of
from restitution import (
    Body,
    Contact,
    Grid,
    Pair,
    generate_surface,
    solve,
    solve_at_pressure,
    unloading_path,
)
from restitution.contact.influence import half_space, inverse_half_space, periodic_half_space
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.plasticity.bound import ConstantBound
from restitution.errors import CaseError
from restitution.numerics.convolution import device as device_module
from restitution.numerics.convolution.device import _LibraryDevice, current, on_device
from tolerance import approx

DEPTH = 40e-9


def _unwrapped(value):
    if isinstance(value, Elsewhere):
        return value.inside
    if isinstance(value, np.ndarray) and value.ndim > 0:
        raise TypeError("a NumPy array beside one from elsewhere")
    if isinstance(value, tuple | list):
        return type(value)(_unwrapped(item) for item in value)
    return value


def _wrapped(value):
    return Elsewhere(value) if isinstance(value, np.ndarray | np.generic) else value


def _call(function, args, options):
    out = options.get("out")
    options = {key: _unwrapped(value) for key, value in options.items()}
    result = function(*(_unwrapped(value) for value in args), **options)
    if out is not None and not isinstance(out, tuple | None):
        return out
    return out[0] if isinstance(out, tuple) and out[0] is not None else _wrapped(result)


class Elsewhere(np.lib.mixins.NDArrayOperatorsMixin):
    """An array that supports NumPy's protocols only."""

    def __init__(self, inside):
        self.inside = np.asarray(inside)

    def __array__(self, *_, **__):
        raise TypeError("implicit conversion to a NumPy array")

    def __array_ufunc__(self, ufunc, method, *args, **options):
        return _call(ufunc, args, options) if method == "__call__" else NotImplemented

    def __array_function__(self, function, types, args, options):
        return _call(function, args, options)

    def __getitem__(self, key):
        return Elsewhere(self.inside[_unwrapped(key)])

    def __setitem__(self, key, value):
        self.inside[_unwrapped(key)] = _unwrapped(value)

    def __bool__(self):
        return bool(self.inside)

    def __float__(self):
        return float(self.inside)

    def __int__(self):
        return int(self.inside)

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        value = getattr(self.inside, name)
        if callable(value):
            return lambda *args, **options: _call(value, args, options)
        return _wrapped(value) if isinstance(value, np.ndarray) else value


class _Arrays:
    """The functions of CuPy that create arrays."""

    @staticmethod
    def asarray(values):
        return Elsewhere(np.array(values))

    @staticmethod
    def asnumpy(values):
        return values.inside.copy()

    @staticmethod
    def arange(n):
        return Elsewhere(np.arange(n))


class _Transforms:
    """A replacement of cupyx.scipy.fft by scipy.fft."""

    def __getattr__(self, name):
        return lambda *args, **options: _call(getattr(scipy.fft, name), args, options)


STAND_IN = _LibraryDevice("elsewhere", _Arrays(), _Transforms())


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (9, 4), (40, 33), (64, 64), (400, 191)])
def test_the_operators_are_those_of_this_machine(shape):
    p = np.random.default_rng(1).normal(size=shape)
    cells = (1e-7, 2e-7)
    for make in (half_space, periodic_half_space, inverse_half_space):
        here = make(shape, cells, 1e11)(p)
        with on_device(STAND_IN):
            there = make(shape, cells, 1e11)(STAND_IN.put(p))
        assert isinstance(there, Elsewhere)
        single = 3e-6 * np.abs(here).max()
        assert_allclose(
            STAND_IN.get(there),
            here,
            atol=1e-13 * np.abs(here).max() if make is not inverse_half_space else single,
        )


@pytest.mark.parametrize("limit", [np.inf, 2e9])
def test_a_solve_is_the_same_on_any_device(rough_contact, limit):
    """The grid is large enough for coarser grids and a window."""
    contact = rough_contact((170, 180), (0.08e-6, 0.08e-6), yield_pressure=limit)
    here = solve(contact, DEPTH, residual=1e-10)
    with on_device(STAND_IN):
        there = solve(contact, DEPTH, residual=1e-10)
    assert there.force == approx(here.force, rel=1e-9)
    assert there.stored_energy == approx(here.stored_energy, rel=1e-9)
    assert there.plastic_volume == approx(here.plastic_volume, rel=1e-7)
    assert_allclose(there.box_pressure, here.box_pressure, atol=1e-7 * here.box_pressure.max())
    assert type(there.box_pressure) is np.ndarray


@pytest.mark.parametrize(
    "yielding",
    [{"yield_pressure": 2e9, "plasticity": "truncated"}, {"yield_strength": 0.8e9}],
    ids=["truncated", "expanding-cavity"],
)
def test_each_model_of_plasticity_is_the_same_on_any_device(rough_contact, yielding):
    plain = rough_contact()
    contact = contact_of(plain.pair, plain.surface, **yielding)
    here = solve(contact, DEPTH)
    with on_device(STAND_IN):
        there = solve(contact, DEPTH)
    assert there.plastic_work > 0
    assert there.force == approx(here.force, rel=1e-6)
    assert there.loading_work == approx(here.loading_work, rel=1e-4)


@pytest.mark.parametrize("limit", [np.inf, 9e9])
def test_a_periodic_contact_is_the_same_on_any_device(limit):
    """The first grid is coarsened; the compiled transforms cannot take the second."""
    wall = Body(math.inf, 210e9, 0.25)
    for nodes in ((96, 88), (26, 33)):
        grid = Grid(nodes, 0.25e-6)
        surface = generate_surface(
            grid, kind="gaussian", rms=50e-9, correlation_length=2e-6, seed=1
        )
        contact = Contact(
            Pair(wall, wall),
            surface,
            plasticity=ConstantBound(limit),
            periodic=True,
        )
        here = solve_at_pressure(contact, 1e9)
        with on_device(STAND_IN):
            there = solve_at_pressure(contact, 1e9)
            deeper = solve(contact, there.indentation)
        assert there.mean_gap == approx(here.mean_gap, rel=1e-6)
        assert deeper.force == approx(here.force)
        assert_allclose(there.box_pressure, here.box_pressure, atol=1e-5 * here.box_pressure.max())


def test_unloading_and_adhesion_run_on_any_device(pair, rough_contact):
    plain = rough_contact(yield_pressure=2e9)
    sticky = Contact(
        plain.pair, plain.surface, plasticity=ConstantBound(2e9), adhesion=JKRLimit(0.05)
    )
    for contact in (plain, sticky):
        here = [(s.indentation, s.force) for s in unloading_path(solve(contact, DEPTH))]
        with on_device(STAND_IN):
            there = [(s.indentation, s.force) for s in unloading_path(solve(contact, DEPTH))]
        assert_allclose(there, here, rtol=1e-4, atol=1e-5 * here[0][1])


def test_a_device_is_current_only_inside():
    assert current().name == "cpu"
    with on_device(STAND_IN), suppress(ZeroDivisionError):
        assert current() is STAND_IN
        with on_device("cpu"):
            1 / 0  # noqa: B018
    assert current().name == "cpu"
    with on_device("cpu") as device:
        assert device is current()


@pytest.fixture
def without_cupy(monkeypatch):
    monkeypatch.setitem(sys.modules, "cupy", None)
    device_module._gpu.cache_clear()
    yield
    device_module._gpu.cache_clear()


@pytest.mark.usefixtures("without_cupy")
def test_a_gpu_without_cupy_is_refused_and_auto_goes_on():
    with (
        pytest.raises(CaseError, match=r"gpu needs CuPy .*pip install \"\.\[gpu\]\""),
        on_device("gpu"),
    ):
        pass
    with on_device("auto") as device:
        assert device.name == "cpu"


def test_a_gpu_that_does_not_answer_is_said_so(monkeypatch):
    class Broken:
        class cuda:  # noqa: N801
            @staticmethod
            def Device():  # noqa: N802
                raise RuntimeError("no CUDA-capable device is detected\nand more")

    monkeypatch.setitem(sys.modules, "cupy", Broken)
    monkeypatch.setitem(sys.modules, "cupyx", Broken)
    monkeypatch.setitem(sys.modules, "cupyx.scipy", Broken)
    monkeypatch.setitem(sys.modules, "cupyx.scipy.fft", Broken)
    device_module._gpu.cache_clear()
    with (
        pytest.raises(CaseError, match=r"no usable GPU \(no CUDA-capable device is detected\)"),
        on_device("gpu"),
    ):
        pass


def test_what_measures_a_gpu_runs():
    """The GPU benchmark runs on the CPU with a small case, so that it does not fail on a GPU."""
    script = Path(__file__).parents[2] / "benchmarks" / "gpu.py"
    options = ["--device", "cpu", "--nodes", "256"]
    found = subprocess.run([sys.executable, script, *options], capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    assert "256 x 256 rough" in found.stdout


def test_cupy_answers_as_this_machine(rough_contact):
    """A GPU gives the numbers of the CPU in double precision."""
    pytest.importorskip("cupy", reason="CuPy is not installed", exc_type=ImportError)
    contact = rough_contact((170, 180), (0.08e-6, 0.08e-6), yield_pressure=2e9)
    here = solve(contact, DEPTH)
    try:
        with on_device("gpu"):
            there = solve(contact, DEPTH)
    except CaseError as refusal:
        pytest.skip(str(refusal))
    assert_allclose(there.box_pressure, here.box_pressure, atol=1e-7 * here.box_pressure.max())
