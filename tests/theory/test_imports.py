"""The laws import nothing from the rooms that use them."""

import ast
from pathlib import Path

import pytest

from restitution import theory

MODULES = sorted(Path(theory.__file__).parent.glob("*.py"))


@pytest.mark.parametrize("module", MODULES, ids=lambda path: path.stem)
def test_a_law_imports_nothing_of_ours_but_errors(module):
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            names = [node.module]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 1
            continue
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        for name in names:
            assert not name.startswith("restitution") or name == "restitution.errors"
