"""Keys that a case omits: warnings if the default may be wrong, information if it is not."""

from __future__ import annotations

from restitution.case.case import Case
from restitution.case.generated import GeneratedRoughness
from restitution.case.materials import adhesive
from restitution.theory import JKR, Hertz

# Typical work of adhesion (J/m²). Ghanbarzadeh et al. (2019) state a range of 0.01 to 0.09 J/m².
TYPICAL_ADHESION = 0.05
# Adhesion matters if V/V_s is below this ratio. V is the impact velocity, and particles stick below
# the velocity V_s. Adhesion lowers the square of COR by (V_s/V)² (Thornton and Ning 1998). At
# V = 8.5 V_s, it lowers a COR of 0.7 by 0.01.
_MATTERS = 8.5


def omissions(case: Case) -> list[str]:
    """Make a warning for each omitted key whose default may be wrong for the case."""
    return list(filter(None, (_no_adhesion(case), _no_shortest_wave(case))))


def default_yield(source: str) -> str:
    """Where a yield pressure that the case leaves out comes from (`source` of `Case.yielding`)."""
    if source in ("given", "elastic"):
        return ""
    return (
        f"The contact yields according to {source}; interface.yield_strength or "
        "interface.yield_pressure sets another value."
    )


def _no_adhesion(case: Case) -> str | None:
    pair = case.pair()
    if case.interface.work_of_adhesion is not None or pair.mass is None:
        return None
    smooth = JKR(pair.radius, pair.contact_modulus, TYPICAL_ADHESION)
    # `below` holds for smooth bodies. Rough bodies adhere less, so for them it is an upper bound.
    below = _MATTERS * float(smooth.sticking_velocity(pair.mass))
    if _lowest_velocity(case, pair.mass) >= below:
        return None
    return (
        "interface.work_of_adhesion is left out, so there is no adhesion: at velocities below "
        f"about {below:.2g} m/s, a typical value of {TYPICAL_ADHESION} J/m2 would change COR of "
        f'smooth bodies by more than 0.01; give a value{_library(case)}, or "0 J/m^2"'
    )


def _library(case: Case) -> str:
    names = [body.material for body in case.bodies().values()]
    known = all(name in adhesive() for name in names)
    return ', "library" for the one of the materials library' if known else ""


def _lowest_velocity(case: Case, mass: float) -> float:
    """The lowest impact velocity (m/s); for loads and indentations, of smooth elastic bodies."""
    first, pair = case.depths()[0], case.pair()
    if case.impact is not None:
        return first
    smooth = Hertz(pair.radius, pair.contact_modulus)
    if case.load is not None:
        first = float(smooth.indentation(first))
    return float(smooth.impact_velocity(first, mass))


def _no_shortest_wave(case: Case) -> str | None:
    for part in case.roughness:
        if (
            isinstance(part, GeneratedRoughness)
            and part.kind != "gaussian"
            and part.shortest is None
        ):
            return (
                f'roughness.shortest is left out: the shortest wave of kind = "{part.kind}" is '
                "then two grid spacings; COR of shallow contacts depends on the shortest wave, and "
                "total_error does not include this influence; give roughness.shortest"
            )
    return None
