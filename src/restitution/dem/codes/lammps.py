"""LAMMPS: `pair_style granular` with `hertz/material` and `damping coeff_restitution`.

LAMMPS uses the E and ν of a pair_coeff for both bodies, also at walls:

    E* = E/(2(1 − ν²)),   G* = E/(4(2 − ν)(1 + ν)).

So each pair gets values of E and ν that lead to its E* and G*. LAMMPS' mixing of two materials
applies the factor ½ twice, so the export does not use the mixing. Force and damping (Antypov &
Elliott, EPL 94 (2011) 50004) act until the overlap is zero, with tension at the end.
`limit_damping` would cut off the tension and increase the coefficient of restitution. In released
versions, `damping tsuji` is wrong by a factor of √2.

LAMMPS 22Jul2025 has no KOKKOS variant of pair_style granular. Pull request 5187 adds a variant with
hooke and hertz normal forces, velocity-based damping, and linear and Mindlin tangential forces.
This variant needs the setting `newton off`. The older gran/hooke/history/kk has only one set of
values for all pairs of types.

Each pair gets a Hertz force with a constant damping coefficient (`damping velocity` in LAMMPS).
The function `hertz_damping` of the module `damping` computes the coefficient. In this model, the
coefficient of restitution e increases with the velocity V. The reason is that the dimensionless
damping g (defined in `damping`) is proportional to V^{−⅕}.

If there is a single type of particle, the fragment also offers a linear spring, whose e is
constant. A contact with this spring lasts as long as a Hertz contact. LAMMPS applies the damping
force until the overlap is zero, even if the total force is then tensile. Under this condition, the
damping ratio ζ gives e = exp(−πζ/(1 − ζ²)^½) (Schäfer, Dippel, Wolf, J. Phys. I France 6 (1996) 5).
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import partial

from restitution.dem.codes.lammps_mdr import mdr_offers
from restitution.dem.damping import hertz_damping, hertz_restitution_at
from restitution.dem.export_common import SCRIPT, STEPS, Export
from restitution.dem.own_laws import OwnLaw, constant, fitted, viscoelastic
from restitution.dem.pair import STIFFNESS_SHARE, ExportedPair
from restitution.dem.pair_table import PairTable
from restitution.dem.text import number
from restitution.dem.units import SI, Units

CODE = "LAMMPS"
LOWEST = 0.001  # smallest e that is reproduced within 0.5 %, with `STEPS` time steps in a contact
FRAGMENT, COLLISION, PACKING = "restitution.lmp", "collision.in", "packing.in"
_PACKING_STEPS = 50  # number of time steps in the shortest contact of the packing
_GRAINS = 500  # number of spheres of the packing
# The packing runs for this fraction of the time in which the highest sphere would reach the wall at
# its initial velocity. The lowest quarter of the spheres has then reached the wall.
_FALLS = 0.25
_FILLED = 0.12  # fraction of the initial volume that the spheres fill
KOKKOS, VISCOELASTIC = "restitution_kokkos.lmp", "restitution_viscoelastic.lmp"
_ENDS = (
    "the overlap is back to zero. The force is tensile shortly before, due to damping; do not add "
    "limit_damping, which cuts off the tension and raises e (from 0.8 to 0.808)."
)
TANGENTIAL = (
    f"These pairs have {STIFFNESS_SHARE} times the tangential stiffness of a contact that sticks, "
    "because the edge of a contact slides first. With this factor, the tangential restitution of "
    "elastic spheres is within 0.03 of the theory (docs/oblique.md). For the full stiffness, "
    "replace the number after mindlin_rescale/force by NULL."
)
_KOKKOS_ENDS = (
    "the overlap is back to zero. The force is tensile shortly before, due to damping; do not add "
    "limit_damping."
)


def write(table: PairTable, velocity: float, units: Units = SI) -> dict[str, str]:
    """The input files for LAMMPS; names and texts. Raises `CaseError`, `DomainError`.

    There is no packing if `table` has no law between spheres, or if no wall has laws with all
    types.
    """
    table.require_spheres(CODE)
    export = Export(table, velocity, CODE, LOWEST, _ENDS, units=units, own=own_laws)
    pairs = export.pairs
    spheres = [pair for pair in pairs if not pair.wall]
    kokkos = replace(export, ends=_KOKKOS_ENDS, constant=False)
    files = {
        FRAGMENT: export.render(
            FRAGMENT,
            friction_note=export.friction_note("#", TANGENTIAL),
            tangential=partial(tangential, units=units),
            spheres=spheres,
            walls=[pair for pair in pairs if pair.wall],
            mdr=mdr_offers(pairs),
            closest=export.closest_note("#"),
        ),
        KOKKOS: kokkos.render(
            KOKKOS,
            friction_note=export.friction_note("#"),
            spheres=spheres,
            damping=[_velocity_damping(pair) for pair in pairs],
            spring=_linear_spring(spheres[0]) if len(spheres) == 1 else None,
        ),
        VISCOELASTIC: replace(export, ends=_KOKKOS_ENDS).render(
            VISCOELASTIC,
            friction_note=export.friction_note("#"),
            spheres=spheres,
            fits=[(pair, viscoelastic(pair)) for pair in pairs],
        ),
        SCRIPT: export.matching_script("lmp -in my.in", FRAGMENT, "matched.lmp"),
        COLLISION: export.render(
            COLLISION, size=table.largest_radius, steps=STEPS, fragment=FRAGMENT, far=0, turns=1000
        ),
    }
    return files | packing(export, FRAGMENT) | export.notes()


def own_laws(pair: ExportedPair) -> list[OwnLaw]:
    """The laws e(V) that LAMMPS has for `pair`."""
    return [
        *constant(pair),
        viscoelastic(pair).law,
        *fitted(pair, "lammps-mdr", "mdr"),
    ]


def packing(export: Export, fragment: str) -> dict[str, str]:
    """The packing with the pairs of the file `fragment`, if there is one; its name and text."""
    table, pairs, velocity = export.table, export.pairs, export.velocity
    floor = _floor(table)
    if floor is None or table.walls_only:
        return {}
    size = table.largest_radius
    edge = 24 * size
    height = _GRAINS * 4.2 * size**3 / (_FILLED * edge**2)
    step = min(pair.contact_time for pair in pairs) / _PACKING_STEPS
    text = export.render(
        PACKING,
        fragment=fragment,
        counts=_counts(table),
        floor=floor,
        size=size,
        edge=edge,
        height=height,
        step=step,
        count=1000 * math.ceil(_FALLS * height / (velocity * step) / 1000),
    )
    return {PACKING: text}


def tangential(pair: ExportedPair, units: Units) -> str:
    """LAMMPS' tangential model of `pair` with its parameters, in `units`."""
    if pair.law.friction is None:
        return f"mindlin NULL 1.0 {pair.friction}"
    stiffness = STIFFNESS_SHARE * pair.mindlin_stiffness
    return f"mindlin_rescale/force {number(units.of(stiffness, 'Pa'))} 1.0 {number(pair.friction)}"


def _counts(table: PairTable) -> list[int]:
    """Number of spheres of each type, at least one; the sum is `_GRAINS`.

    The fractions of all sizes of a material add up to 1, so all materials of a mixture have the
    same number of spheres.
    """
    weights = [body.number_fraction or 1.0 for body in table.spheres]
    ends = [round(_GRAINS * part / sum(weights)) for part in itertools.accumulate(weights)]
    counts = [max(1, end - start) for start, end in itertools.pairwise([0, *ends])]
    counts[counts.index(max(counts))] += _GRAINS - sum(counts)
    return counts


def _floor(table: PairTable) -> int | None:
    count = len(table.spheres)
    walls = range(count + 1, len(table.particles) + 1)
    with_all = (w for w in walls if all((k, w) in table.laws for k in range(1, count + 1)))
    return next(with_all, None)


@dataclass(frozen=True)
class VelocityDamping:
    """Hertz force with a constant `damping` coefficient (kg/s) that gives the e of `pair`."""

    pair: ExportedPair
    damping: float

    @property
    def normal_stiffness(self) -> float:
        """The coefficient Kn (Pa) of LAMMPS' normal model `hertz`."""
        return 4 / 3 * self.pair.law.contact_modulus

    def restitution(self, share: float) -> float:
        """COR at `share` times the velocity of the export."""
        return hertz_restitution_at(self.pair.law, self.damping, share * self.pair.velocity)


def _velocity_damping(pair: ExportedPair) -> VelocityDamping:
    return VelocityDamping(pair, hertz_damping(pair.law, pair.velocity, pair.restitution))


def _linear_spring(pair: ExportedPair) -> tuple[float, float]:
    """Kn (N/m) and gamma_n (1/s) of `gran/hooke/history` that give the e of `pair`."""
    frequency = math.pi / pair.contact_time
    loss = -math.log(pair.restitution)
    ratio = loss / math.hypot(math.pi, loss)
    return pair.law.mass * frequency**2, 2 * ratio * frequency
