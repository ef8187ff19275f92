"""The bundled studies in three sizes: as in the paper, reduced, and on finer grids."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any, Literal

import tomli_w

from restitution.sweeps.sweep import Study, parse_study

Size = Literal["quick", "paper", "refined"]

NAMES = (
    "hertz",
    "thornton-ning",
    "jkr",
    "smooth-yield",
    "smooth-energy",
    "roughness",
    "critical",
    "rough-yield",
    "rough-energy",
)

# For each study, the values that `--quick` uses instead of those in the study file.
_QUICK: dict[str, dict[str, Any]] = {
    "hertz": {"grid.nodes": 256, "indentation.to": "1 um", "indentation.steps": 6},
    "thornton-ning": {"grid.nodes": 256, "indentation.to": "1 um", "indentation.steps": 6},
    "jkr": {"indentation.steps": 3, "indentation.to": "20 nm", "grid.nodes": 160},
    "smooth-yield": {"indentation.steps": 6, "indentation.to": "120 nm", "grid.nodes": 200},
    "smooth-energy": {
        "indentation.steps": 6,
        "indentation.to": "120 nm",
        "sweep.grid.nodes": [400, 280, 200],
    },
    "roughness": {"grid.nodes": 256, "indentation.to": "1 um", "indentation.steps": 10},
    "critical": {
        "grid.nodes": 512,
        "indentation.to": "5 um",
        "indentation.steps": 12,
        "sweep.roughness.rms": ["1 pm", "0.1 um", "0.2 um"],
        "sweep.roughness.seed": [1, 2],
    },
    "rough-yield": {"grid.nodes": 256, "indentation.to": "1 um", "indentation.steps": 8},
    "rough-energy": {"grid.nodes": 256, "indentation.to": "1 um", "indentation.steps": 8},
}
# Changes of the study files for the size "refined". Without these changes, the grids do not resolve
# rough contacts at indentations smaller than some tens of nanometres.
_REFINED: dict[str, dict[str, Any]] = {
    name: {"grid.refine": 2} for name in ("roughness", "rough-yield", "rough-energy")
}


def bundled(name: str, size: Size) -> Study:
    text = (files("restitution.reproduce") / "studies" / f"{name}.toml").read_text("utf-8")
    changes = {"quick": _QUICK, "refined": _REFINED, "paper": {}}[size].get(name, {})
    if changes:
        content = tomllib.loads(text)
        for path, value in changes.items():
            table, key = path.split(".", 1)
            content[table][key] = value
        text = tomli_w.dumps(content)
    return parse_study(text)
