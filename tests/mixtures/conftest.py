from collections.abc import Callable
from pathlib import Path

import pytest

from restitution.mixtures.mixture import open_mixture_folder, run_mixture, write_mixture
from restitution.mixtures.mixture_file import parse_mixture
from restitution.sweeps.executors import chosen_workers

MIXTURE = """
title = "Beads and a wall"
[materials.alu]
material = "aluminium"
radius = ["50 um", "80 um", "150 um"]
roughness = { kind = "gaussian", rms = "0.05 um", correlation_length = "4 um", seed = 1 }
[materials.pmma]
material = "pmma"
radius = "100 um"
[walls.drum]
material = "steel"
[interface]
work_of_adhesion = "0 J/m^2"
[grid]
nodes = 64
spacing = "0.6 um"
refine = 1
[impact]
from = "0.1 m/s"
to = "1 m/s"
steps = 3
"""


@pytest.fixture
def mixture_text():
    """Change the mixture: each change is (old text, new text)."""

    def changed(*changes):
        text = MIXTURE
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        return text

    return changed


@pytest.fixture(scope="session")
def computed_mixture(tmp_path_factory, compute_mixture) -> Path:
    """The folder of the computed mixture; not to be changed."""
    out = tmp_path_factory.mktemp("mixture") / "out"
    return compute_mixture(MIXTURE, out)


@pytest.fixture(scope="session")
def compute_mixture() -> Callable[[str, Path], Path]:
    """Compute a mixture, given as its text, into a folder."""

    def compute(text: str, out: Path) -> Path:
        mixture = parse_mixture(text)
        folder = open_mixture_folder(out, mixture, resume=False)
        with chosen_workers(1, None) as workers:
            pairs = run_mixture(mixture, out, folder, workers, lambda _: None)
        write_mixture(out, mixture, pairs, len(folder.study.cases), 0.0)
        return out

    return compute
