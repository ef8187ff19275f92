"""List the reference cases and the check cases, with their settings."""

from __future__ import annotations

from dataclasses import dataclass, replace

from problem import Model

_E, _R = 210e9, 500e-6


@dataclass(frozen=True)
class Range:
    """Depths that are read from one mesh.

    Args:
        name: label of the mesh.
        omegas: values of δ/δ_c from which the body is unloaded.
        low: δ/δ_c from which the curve is read on this mesh; steps are fine above it.
        start: δ/δ_c of the first step.
        elements: elements over the contact radius (smooth) or over one wavelength (waves).
        coarse: relative step below `low`.
        fine: relative step above `low`.
        refinement: divisor of all element sizes.
        crests: whether only the elements near the crests of waves are fine.
    """

    name: str
    omegas: tuple[float, ...]
    low: float
    start: float
    elements: float
    coarse: float = 0.07
    fine: float = 0.035
    refinement: int = 1
    crests: bool = False


@dataclass(frozen=True)
class Case:
    """One model with its ranges and kinematics (see `indentation.Indentation`)."""

    name: str
    model: Model
    ranges: tuple[Range, ...]
    kinematics: str = "small"


def _smooth(name, ratio, nu, top, elements=80, **hardening):
    contact_modulus = _E / (1 - nu**2)
    model = Model(_E, nu, ratio * contact_modulus, radius=_R, **hardening)
    ranges = [Range("a", (2, 4, 8), 0.8, 0.8, elements)]
    if top > 128:
        ranges += [
            Range("b", (16, 32, 64), 8, 0.8, elements),
            Range("c", (128, 256, 512), 64, 0.8, elements, coarse=0.1),
        ]
    else:
        ranges += [Range("b", (16, 32, 64, 128), 8, 0.8, elements)]
    return Case(name, model, tuple(ranges))


def _waves(amplitude_um, wavelength_um, finer=1):
    model = Model(
        _E, 0.3, 1e9, radius=_R, wave_amplitude=amplitude_um * 1e-6, wavelength=wavelength_um * 1e-6
    )
    start = 0.8 * model.crest_radius / model.radius
    ranges = (
        Range("a", (0.25, 0.5, 1), start, start, 64 * finer, fine=0.05),
        Range("b", (2, 4, 8), 1, start, (32 if wavelength_um > 6 else 24) * finer, coarse=0.1),
    )
    return Case(f"waves_A{amplitude_um:g}um_L{wavelength_um:g}um", model, ranges)


def _refined(case, name, **changes):
    return replace(case, name=name, ranges=tuple(replace(r, **changes) for r in case.ranges))


def _with_kinematics(case, name, kinematics):
    return replace(case, name=name, kinematics=kinematics)


def all_cases() -> list[Case]:
    """Return all cases in the order in which they run."""
    cases = [_smooth("smooth_0.001", 0.001, 0.3, 512), _smooth("smooth_0.005", 0.005, 0.3, 128)]
    cases += [_waves(a, w) for a in (0.03, 0.1) for w in (8, 4)]
    cases += [
        _smooth("hardening_0.02E", 0.002, 0.3, 128, hardening_modulus=0.02 * _E),
        _smooth("poisson_0.2", 0.001, 0.2, 128, 60),
        _smooth("poisson_0.4", 0.001, 0.4, 128),
        _smooth("smooth_0.0005", 0.0005, 0.3, 512),
        _smooth("hardening_0.1E", 0.002, 0.3, 128, 60, hardening_modulus=0.1 * _E),
    ]
    cases += [_waves(0.01, w) for w in (8, 4)]
    cases += [
        _with_kinematics(cases[1], "finite_0.005", "finite"),
        _with_kinematics(cases[1], "flattening_0.005", "flattening"),
        _with_kinematics(cases[0], "finite_0.001", "finite"),
    ]
    # Computed after the constants of the model had been chosen on the waves above.
    cases += [_waves(a, w) for a, w in ((0.02, 6), (0.05, 6), (0.06, 10), (0.1, 12))]
    cases += [_waves(a, w, finer=2) for a, w in ((0.06, 4), (0.2, 12))]
    # Computed after the last change of the model.
    cases += [_waves(a, w) for a, w in ((0.04, 5), (0.08, 7), (0.15, 10))]
    return cases


def check_cases() -> list[Case]:
    """Return cases for comparison and convergence; they go to data/checks."""
    by_name = {c.name: c for c in all_cases()}
    smooth = by_name["smooth_0.001"]
    wave, rough = by_name["waves_A0.03um_L8um"], by_name["waves_A0.1um_L4um"]
    result = [
        Case(f"compare_{s:g}MPa", Model(_E, 0.3, s * 1e6, radius=_R), smooth.ranges[:2])
        for s in (1000, 250)
    ]
    first = replace(smooth, ranges=smooth.ranges[:1])
    both = replace(smooth, ranges=smooth.ranges[:2])
    result += [
        _refined(both, "smooth_0.001_double_elements", elements=40),
        _refined(first, "smooth_0.001_half_steps", fine=0.0175),
        *(
            replace(
                wave,
                name=f"{wave.name}_double_elements",
                ranges=tuple(replace(r, elements=r.elements / 2) for r in wave.ranges),
            )
            for wave in (wave, by_name["waves_A0.06um_L4um"], by_name["waves_A0.2um_L12um"])
        ),
        _refined(first, "smooth_0.001_half_elements", refinement=2),
        _refined(
            replace(rough, ranges=rough.ranges[:1]), "waves_A0.1um_L4um_half_elements", elements=128
        ),
    ]
    for refinement in (1, 2):
        result += convergence_cases(refinement)
    for factor in (1, 2, 4):
        result += crest_cases(factor)
    result += [c for k in ("deformed-contact", "finite") for c in convergence_cases(1, k)]
    return result


# Depths of the waves where a model was farthest from the reference: amplitude (µm), wavelength
# (µm), δ/δ_c, and elements per wavelength on the coarsest of the meshes.
_CONVERGENCE = (
    (0.1, 8, 2, 32),
    (0.2, 12, 4, 32),
    (0.06, 4, 0.25, 64),
    (0.1, 4, 0.5, 64),
    (0.1, 4, 4, 24),
    (0.06, 10, 8, 32),
    (0.1, 12, 2, 32),
    (0.1, 12, 8, 32),
    (0.06, 4, 4, 24),
    (0.1, 8, 1, 64),
    (0.03, 4, 0.25, 64),
    (0.04, 5, 8, 24),
    (0.15, 10, 4, 32),
)


def convergence_cases(refinement: int, kinematics: str = "small") -> list[Case]:
    """Return one depth of each steep wave on meshes with all elements `refinement` times smaller.

    The gradings become finer, too, so the meshes of a depth are of one family.
    """
    found = []
    for amplitude, wavelength, omega, elements in _CONVERGENCE:
        wave = _waves(amplitude, wavelength)
        part = wave.ranges[0]
        mesh = Range(
            f"refined_{refinement}",
            (omega,),
            omega / 2,
            part.start,
            elements,
            coarse=0.1,
            fine=0.05,
            refinement=refinement,
        )
        name = f"{wave.name}_omega{omega:g}_refined_{refinement}"
        if kinematics != "small":
            name += f"_{kinematics}"
        found.append(replace(wave, name=name, ranges=(mesh,), kinematics=kinematics))
    return found


def crest_cases(factor: int) -> list[Case]:
    """Return the depths of `convergence_cases` with `factor` times smaller elements at the crests.

    The elements elsewhere are as large on all meshes of a depth.
    """
    found = []
    for case, depth in zip(convergence_cases(1), _CONVERGENCE, strict=True):
        elements = factor * depth[-1]
        mesh = replace(case.ranges[0], name=f"crests_{factor}", elements=elements, crests=True)
        name = case.name.replace("refined_1", f"crests_{factor}")
        found.append(replace(case, name=name, ranges=(mesh,)))
    return found
