"""The last table of a page: the methods of the computation, with their sources."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from restitution.pages.page import PageTable

_ALWAYS = (
    (
        "displacement of the half-space",
        "rectangles of constant pressure",
        "Love (1929), Phil. Trans. R. Soc. A 228, 377–420; Johnson (1985), Contact Mechanics, "
        "eq. 3.25",
    ),
    ("free boundary", "zero-padded FFT convolution", "Liu, Wang and Liu (2000), Wear 243, 101–111"),
    (
        "equilibrium",
        "preconditioned conjugate gradients with bounds on the pressure",
        "after Polonsky and Keer (1999), Wear 231, 206–219",
    ),
    ("restitution", "sqrt(unloading work / loading work)", "Johnson (1985), §11.5"),
)
_YIELD = {
    "equilibrium": (
        "yield",
        "equilibrium of pressure and surface, with p_y as the upper limit of pressure",
        "Polonsky and Keer (1999)",
    ),
    "truncated": (
        "yield",
        "elastic pressure truncated at p_y",
        "Thornton and Ning (1998), Powder Technol. 99, 154–162",
    ),
    "expanding-cavity": (
        "yield",
        "upper limit of pressure that grows with the elastic pressure, from 1.6 to 3.5 yield "
        "strengths",
        "Johnson (1970), J. Mech. Phys. Solids 18, 115–126; Jackson and Green (2005), J. Tribol. "
        "127, 343–354",
    ),
}
_ADHESION = (
    "adhesion",
    "JKR limit, energy balance at the edge of contact",
    "Johnson, Kendall and Roberts (1971), Proc. R. Soc. A 324, 301–313",
)
_COHESIVE = (
    "adhesion",
    "Lennard-Jones law between half-spaces, minimum of the energy",
    "Muller, Yushchenko and Derjaguin (1980), J. Colloid Interface Sci. 77, 91–101; Greenwood "
    "(1997), Proc. R. Soc. A 453, 1277–1297",
)
_DETACHMENT = {
    "crack-closure": (
        "detachment",
        "crack closure over one cell",
        "Rybicki and Kanninen (1977), Eng. Fract. Mech. 9, 931–938",
    ),
    "pohrt-popov": (
        "detachment",
        "release of a node if its tension exceeds a limit",
        "Pohrt and Popov (2015), Facta Univ. Mech. Eng. 13, 3–10",
    ),
}
_ROUGHNESS = {
    "generated": (
        "roughness",
        "filtered white noise",
        "Hu and Tonder (1992), Int. J. Mach. Tools Manufact. 32, 83–90",
    ),
    "twin": (
        "roughness",
        "surrogate with the scan's heights and spectrum",
        "Schreiber and Schmitz (1996), Phys. Rev. Lett. 77, 635–638; Riedel and Sidorenko "
        "(1995), IEEE Trans. Signal Process. 43, 188–195",
    ),
}
_REFERENCES = (
    ("smooth reference", "elastic–plastic sphere, truncated pressure", "Thornton and Ning (1998)"),
    ("smooth reference", "elastic sphere", "Hertz (1882); Johnson (1985), §4.2"),
)


_PERIODIC = (
    ("displacement of the half-space", "periodic waves, 2/(E* |q|)", "Johnson (1985), §13.2"),
    _ALWAYS[2],
    (
        "contact area",
        "nodes in contact, corrected for the staircase edge",
        "Yastrebov, Anciaux and Molinari (2017), Tribol. Int. 114, 161–171",
    ),
    ("stiffness", "linear problem on the nodes in contact", ""),
)
_PERSSON = (
    "reference",
    "diffusion of the contact pressure with magnification, elastic",
    "Persson (2001), J. Chem. Phys. 115, 3840–3861",
)


def methods(summary: Mapping[str, Any]) -> PageTable:
    model = summary["model"]
    periodic = model["half_space"].startswith("periodic")
    rows = list(_PERIODIC if periodic else _ALWAYS)
    if model["plasticity"] != "none":
        rows.append(_YIELD[model["plasticity"]])
    if model["adhesion"] != "none":
        jkr = "detachment" in model
        rows += [_ADHESION, _DETACHMENT[model["detachment"]]] if jkr else [_COHESIVE]
    source = summary.get("surface", {}).get("source")
    if source in _ROUGHNESS:
        rows.append(_ROUGHNESS[source])
    rows += [_PERSSON] if periodic else _REFERENCES
    versions = ", ".join(f"{name} {number}" for name, number in summary["versions"].items())
    return PageTable(
        "Methods", ["quantity", "method", "source"], rows, [f"Computed with {versions}."]
    )
