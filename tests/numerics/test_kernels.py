"""Selection of the compiled kernels, agreement of their results, and failures of their threads."""

import os
import subprocess
import sys

import pytest

from restitution.numerics import kernels
from tolerance import approx

compiled = pytest.mark.skipif(kernels.loops is None, reason="built without a compiler")

SOLVE = """
from restitution import Body, ConstantBound, Contact, Grid, Pair, generate_surface, solve
from restitution.numerics import kernels
grid = Grid((64, 64), (0.25e-6, 0.25e-6))
body = Body(500e-6, 210e9, 0.25)
surface = generate_surface(grid, kind="gaussian", rms=2e-8, correlation_length=1e-6, seed=1)
contact = Contact(Pair(body, body), surface, ConstantBound(4e9))
print(kernels.instruction_set, solve(contact, 60e-9).force)
"""


def python(program, **environment):
    """Run a program in a new process."""
    return subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        timeout=300,
        env=os.environ | environment,
    )


def solved(program=SOLVE, **environment):
    done = python(program, **environment)
    if f"{kernels.VARIABLE}: {environment.get(kernels.VARIABLE)} kernels" in done.stderr:
        pytest.skip(done.stderr.splitlines()[-1])
    assert done.returncode == 0, done.stderr
    name, force = done.stdout.split()
    return name, float(force)


@pytest.fixture(scope="module")
def expected():
    """The force computed by NumPy."""
    name, force = solved(RESTITUTION_KERNELS="numpy")
    assert name == "none"
    return force


@compiled
@pytest.mark.parametrize("chosen", kernels.INSTRUCTION_SETS)
def test_each_instruction_set_gives_the_force_of_numpy(chosen, expected):
    name, force = solved(RESTITUTION_KERNELS=chosen)
    assert name == kernels.INSTRUCTION_SETS[chosen]
    assert force == approx(expected, rel=1e-7)


def test_without_a_compiler_numpy_does_it(expected):
    hidden = "import sys; sys.modules['restitution.numerics.loops'] = None"
    assert solved(hidden + SOLVE, RESTITUTION_KERNELS="") == ("none", expected)


@compiled
def test_the_widest_vectors_are_the_default():
    named = {}
    for chosen in kernels.INSTRUCTION_SETS:
        done = python(SOLVE, RESTITUTION_KERNELS=chosen)
        if done.returncode == 0:
            named[chosen] = done.stdout.split()[0]
    assert solved(RESTITUTION_KERNELS="")[0] == next(iter(named.values()))


def test_unknown_kernels_are_refused():
    done = python(SOLVE, RESTITUTION_KERNELS="sse9")
    assert 'RESTITUTION_KERNELS: "sse9" is not known; unset it, or use avx512' in done.stderr
    assert done.returncode == 1


@compiled
@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize("threads", [1, 2, 7])
def test_memory_that_ends_in_a_thread_is_an_exception(threads):
    """Each part of `prolong` allocates a row, for which the process has no memory left."""
    done = python(f"""
import resource
import numpy as np
from restitution.numerics.kernels import loops
columns = 4 << 20
coarse = np.broadcast_to(np.ones(columns), (16, columns))
one, rows = np.zeros(2 * columns), (32, 2 * columns)
fine = np.lib.stride_tricks.as_strided(one, rows, (0, 8))  # all rows in the same memory
loops.use_threads({threads})
held = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
limits = resource.getrlimit(resource.RLIMIT_AS)
resource.setrlimit(resource.RLIMIT_AS, (held + (24 << 20), limits[1]))
try:
    loops.prolong(coarse, fine)
except MemoryError:
    print("refused")
resource.setrlimit(resource.RLIMIT_AS, limits)
loops.prolong(coarse, fine)  # the failure has no after-effects
print(one.min(), one.max())
""")
    assert (done.returncode, done.stdout) == (0, "refused\n1.0 1.0\n"), done.stderr
