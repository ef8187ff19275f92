"""LAMMPS: `jkr` or `dmt` with the computed pull-off force, and damping fitted to e.

In LAMMPS 22Jul2025 a `jkr` contact ends at its largest tension, F = -F_c with F_c = 3 pi gamma R*,
not at the smaller indentation at which the spheres snap off. Without damping it therefore sticks
below 0.703 times the velocity of JKR and Thornton & Ning. `dmt` loses no energy by itself; it is
better for small or rough spheres, which `jkr` makes stick too much. `damping velocity` is a
constant coefficient, `viscoelastic` one times contact radius and mass. The export takes the model
and the damping that are closest to the law. e of bodies that yield falls with the velocity, which
none can follow: the files state how far e is off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

from restitution.dem.codes.lammps import COLLISION, TANGENTIAL, packing, tangential
from restitution.dem.damped_adhesion import (
    AdhesiveFit,
    dmt_model,
    fit_damping,
    jkr_model,
    known_pull_off,
    misfit,
    require_adhesion,
)
from restitution.dem.export_common import Export
from restitution.dem.pair import ExportedPair
from restitution.dem.pair_table import PairTable
from restitution.dem.text import commented, wrapped
from restitution.dem.units import SI, Units

CODE = "LAMMPS"
FRAGMENT = "restitution_adhesive.lmp"
_STEPS = 2000  # number of time steps in the elastic contact time of the test collision
# Measured with lactose of 2 um from 1.2 times its sticking velocity on.
_ACCURACY = "Then e is within 0.01 of that with smaller steps; with 1/50, within 0.04."
_TURNS = 40  # elastic contact times after which bodies that have not parted stick
_ENDS = "the tension reaches the pull-off force; without adhesion, the overlap is back to zero."


@dataclass(frozen=True)
class DampedModel:
    """The model `name` ("jkr" or "dmt") of an adhesive `pair`, and the kind of its damping."""

    pair: ExportedPair
    name: str
    kind: str
    fit: AdhesiveFit

    @property
    def cohesion(self) -> float:
        """LAMMPS' gamma (J/m²): the pull-off force is 3πγR* in jkr and 4πγR* in dmt."""
        share = {"jkr": 3, "dmt": 4}[self.name]
        return self.fit.pull_off_force / (share * math.pi * self.pair.law.radius)

    @property
    def said(self) -> str:
        """How far this model is from the law."""
        return f"Pair {self.pair.i} {self.pair.j}: {misfit(self.fit, self.pair.law)}."


def write(table: PairTable, velocity: float, units: Units = SI) -> dict[str, str]:
    """The input files; names and texts. Raises `CaseError` and `DomainError`."""
    table.require_spheres(CODE)
    require_adhesion(table.laws.values(), "lammps")
    export = Export(
        table,
        velocity,
        CODE,
        0.0,
        _ENDS,
        constant=False,
        adhesive=True,
        units=units,
        steps=200,
        accuracy=_ACCURACY,
    )
    models = {(p.i, p.j): _model(p) for p in export.pairs if p.law.work_of_adhesion > 0}
    size = table.largest_radius
    far = max(3 * (m.fit.pull_off_force / m.pair.law.contact_modulus) ** (2 / 3)
              / m.pair.law.radius ** (1 / 3) for m in models.values())  # fmt: skip
    return {
        FRAGMENT: export.render(
            FRAGMENT,
            models=models,
            tangential=partial(tangential, units=units),
            misfits=commented(wrapped([m.said for m in models.values()]), "#"),
            friction_note=export.friction_note("#", TANGENTIAL),
        ),
        COLLISION: export.render(
            COLLISION, size=size, steps=_STEPS, fragment=FRAGMENT, far=far, turns=_TURNS
        ),
    } | packing(export, FRAGMENT) | export.notes()  # fmt: skip


def _model(pair: ExportedPair) -> DampedModel:
    law = pair.law
    force = known_pull_off(law, pair.velocity)
    models = {
        (name, kind): make(law, force, viscoelastic=kind == "viscoelastic")
        for name, make in (("jkr", jkr_model), ("dmt", dmt_model))
        for kind in ("velocity", "viscoelastic")
    }
    fits = {key: fit_damping(model, law, force) for key, model in models.items()}
    name, kind = min(fits, key=lambda key: fits[key].miss)
    return DampedModel(pair, name, kind, fits[name, kind])
