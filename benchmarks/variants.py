"""The package with a part of its text changed, to see what that part is worth."""

from __future__ import annotations

import inspect
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).parents[1]
LOOPS = Path("restitution", "numerics")
Change = tuple[str, str]  # a text, and what takes its place


def changed(function: Callable, *changes: Change) -> Callable:
    """The function with other text for some of its own; `LookupError` if it has no such text."""
    source = with_changes(inspect.getsource(function), changes, function.__name__)
    names = dict(vars(inspect.getmodule(function)))
    exec(compile(source, function.__name__, "exec"), names)
    return names[function.__name__]


def recompiled(file: str, *changes: Change) -> ModuleType:
    """The compiled `loops` with other text in one file of theirs; raises as `changed`."""
    with tempfile.TemporaryDirectory() as folder:
        copy, built = Path(folder, "copy"), Path(folder, "built")
        copy.mkdir()
        for name in ("pyproject.toml", "setup.py", "README.md", "LICENSE"):
            shutil.copy(ROOT / name, copy)
        unbuilt = shutil.ignore_patterns("*.so", "*.egg-info", "__pycache__")
        shutil.copytree(ROOT / "src", copy / "src", ignore=unbuilt)
        path = copy / "src" / LOOPS / file
        path.write_text(with_changes(path.read_text(), changes, file))
        install = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps",
                   "--disable-pip-version-check", "--target", built, copy]  # fmt: skip
        subprocess.run(install, check=True)
        library = built / LOOPS / f"loops{sysconfig.get_config_var('EXT_SUFFIX')}"
        # Not the name of the original: pybind11 gives out a module that exists of that name.
        spec = spec_from_file_location(f"{copy.parent.name}.loops", library)
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        return module


def with_changes(source: str, changes: tuple[Change, ...], name: str) -> str:
    """The text after all changes."""
    for old, new in changes:
        if old not in source:
            raise LookupError(f"{name} does not hold {old!r} any more")
        source = source.replace(old, new)
    return source
