"""Compile the loops; without them NumPy computes the same (`restitution --version` shows which)."""

import sys
from pathlib import Path

from pybind11.setup_helpers import ParallelCompile, Pybind11Extension, build_ext
from setuptools import setup

FOLDER = Path("src/restitution/numerics")
# Fuse products and sums with every compiler. Do not set errno; assume that nothing traps.
FLAGS = ["-O3", "-fopenmp-simd", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=fast"]
MSVC_FLAGS = ["/O2", "/utf-8"]

ParallelCompile(default=0).install()  # compile the files in parallel
setup(
    ext_modules=[
        Pybind11Extension(
            "restitution.numerics.loops",
            sorted(str(path) for path in FOLDER.rglob("*.cpp")),
            depends=sorted(str(path) for path in FOLDER.rglob("*.h")),
            include_dirs=[str(FOLDER)],
            cxx_std=17,
            extra_compile_args=MSVC_FLAGS if sys.platform == "win32" else FLAGS,
            optional=True,
        )
    ],
    cmdclass={"build_ext": build_ext},
)
