"""Waves below the grid in runs: progress of their patches, and their law in words."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.patch.law import PatchLaw, law_of_patches
from restitution.display import duration, quantity
from restitution.runs.log import Say, ignore

_DRAWN = 400  # points of a drawn law
_LONG = 0.05  # time (s) from which a patch counts as solved now


def solve_patches(contact: Contact, progress: Say = ignore) -> None:
    """Solve the patches of `contact`, and report those that were not known."""
    law = law_of_patches(contact)
    if law is None:
        return
    for number, patch in enumerate(law.patches, 1):
        began = time.perf_counter()
        law.curve(patch)
        if time.perf_counter() - began > _LONG:
            progress(f"patch {number} of {len(law.patches)}")


def told(contact: Contact) -> dict[str, Any]:
    """Entries of `summary.json` about waves below the grid; empty if there are none."""
    law = law_of_patches(contact)
    if law is None:
        return {}
    patch = law.patches[0].grid
    return {
        "split_m": law.wavelength,
        "patches": len(law.patches),
        "patch_nodes": list(patch.nodes),
        "patch_spacing_m": patch.spacing[0],
        "patch_rms_m": float(np.sqrt(np.mean([p.height.var() for p in law.patches]))),
        **law.summary(),
    }


def patch_curve(contact: Contact) -> dict[str, Any]:
    """Make the variables of `results.nc` for the law of patches; empty without patches."""
    law = law_of_patches(contact)
    if law is None:
        return {}
    gap = law.table.drawn(_DRAWN)
    values = {
        "gap": ("m", "distance of the mean planes of the patches before deformation", gap),
        "pressure": ("Pa", "nominal pressure of the patches during loading", law.table.at(gap)),
    }
    return {
        f"patch_{name}": ("patch", of, {"units": unit, "long_name": words})
        for name, (unit, words, of) in values.items()
    }


def cost_in_words(law: PatchLaw) -> str:
    """What is split, and the time that the patches take."""
    nx, ny = law.patches[0].grid.nodes
    seconds = law.seconds_per_node * nx * ny * len(law.patches)
    return (
        f"Waves below {quantity(law.wavelength, 'm')} are computed on {len(law.patches)} periodic "
        f"patches of {nx} x {ny} nodes, in about {duration(seconds)} the first time."
    )
