"""The one place where keys of the table `[interface]` become the models of a `Contact`."""

from __future__ import annotations

import math
from typing import Literal

from restitution.contact.cohesive.law import Cohesive
from restitution.contact.jkr.approach import AdhesiveApproach, HertzianApproach, PullIncrements
from restitution.contact.jkr.detachment import CrackClosure, PohrtPopov
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.models import EQUILIBRIUM_SEPARATION
from restitution.contact.models import Adhesion as AdhesionModel
from restitution.contact.models import Plasticity as PlasticityModel
from restitution.contact.plasticity.bound import ConstantBound, Elastic
from restitution.contact.plasticity.cavity import ExpandingCavity
from restitution.contact.plasticity.size_effect import SizedBound
from restitution.contact.plasticity.truncated import Truncated

# The words of the keys; each is the label of a model.
Plasticity = Literal["expanding-cavity", "equilibrium", "truncated"]
Approach = Literal["equilibrium", "hertzian", "pull-increments"]
Adhesion = Literal["jkr", "cohesive"]
Detachment = Literal["crack-closure", "pohrt-popov"]

_APPROACHES = {
    model.label: model() for model in (AdhesiveApproach, HertzianApproach, PullIncrements)
}
_DETACHMENTS = {model.label: model() for model in (CrackClosure, PohrtPopov)}
_AT_A_PRESSURE = {model.label: model for model in (ConstantBound, Truncated)}


def plasticity_of(
    plasticity: Plasticity | None = None,
    yield_pressure: float = math.inf,
    yield_strength: float = math.inf,
    tangent_modulus: float = 0.0,
    size_effect: float = 0.0,
) -> PlasticityModel:
    """Make a model of plasticity; infinite pressures mean elastic bodies."""
    if math.isfinite(yield_strength):
        return ExpandingCavity(yield_strength, tangent_modulus, size_effect)
    if math.isinf(yield_pressure):
        return Elastic()
    if size_effect and plasticity != "truncated":
        return SizedBound(yield_pressure, size_effect)
    return _AT_A_PRESSURE[plasticity or "equilibrium"](yield_pressure)


def adhesion_of(
    adhesion: Adhesion = "jkr",
    work_of_adhesion: float = 0.0,
    approach: Approach = "equilibrium",
    detachment: Detachment = "crack-closure",
    equilibrium_separation: float = EQUILIBRIUM_SEPARATION,
) -> AdhesionModel | None:
    """Make a model of adhesion; None without work of adhesion."""
    if work_of_adhesion == 0:
        return None
    if adhesion == "cohesive":
        return Cohesive(work_of_adhesion, equilibrium_separation)
    return JKRLimit(
        work_of_adhesion, _APPROACHES[approach], _DETACHMENTS[detachment], equilibrium_separation
    )
