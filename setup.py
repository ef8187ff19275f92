"""The part that is compiled. Where that fails NumPy does it; `restitution --version` says which."""

import sys
from pathlib import Path

from pybind11.setup_helpers import ParallelCompile, Pybind11Extension, build_ext
from setuptools import setup

FOLDER = Path("src/restitution/numerics")
# Products and sums are fused, whatever the compiler's habit; no error numbers, no traps.
FLAGS = ["-O3", "-fopenmp-simd", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=fast"]
MSVC_FLAGS = ["/O2", "/utf-8"]

ParallelCompile(default=0).install()  # both files at once
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
