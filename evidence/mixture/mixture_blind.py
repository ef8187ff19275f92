"""Laws interpolated in the reduced radius against laws computed there.

In four families of pairs, laws at three reduced radii are interpolated to all other reduced radii
and compared with laws that were computed there. Writes mixture_blind.csv. The errors of grid,
surface and materials are left out, because both laws share them. Takes about ten minutes.
"""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

from evidence.shared import write_table
from restitution.case.case_file import parse_case
from restitution.laws.from_results import bare_law
from restitution.laws.law import Law
from restitution.mixtures.family import Family, families
from restitution.mixtures.mixture_file import parse_mixture
from restitution.mixtures.scaling import FamilyLaws
from restitution.results.writer import ResultsFolder
from restitution.runs.run import run_case

MIXTURE = """
[materials.grains]
material = "{material}"
radius = ["40 um", "65 um", "100 um", "180 um"]
roughness = {{ kind = "gaussian", rms = "{rms}", correlation_length = "{length}", seed = {seed} }}
[interface]
work_of_adhesion = "{adhesion}"
[impact]
from = "0.02 m/s"
to = "2 m/s"
steps = 9
"""
NAMES = ("material", "rms", "length", "seed", "adhesion")
MIXTURES = (
    ("aluminium", "0.05 um", "3 um", 501, "0 J/m^2"),
    ("lactose", "0.1 um", "4 um", 502, "0 J/m^2"),
    ("steel", "0.2 um", "6 um", 503, "0 J/m^2"),
    ("polystyrene", "0.02 um", "4 um", 504, "0 J/m^2"),
)


def law_at(family: Family, radius: float, folder: Path) -> Law:
    """The law of `family` at a reduced radius (m), computed directly."""
    text = "total_error = false\n" + family.case(radius)
    out = folder / f"{family.first.body['material']} {radius}"
    run_case(parse_case(text), text, folder, ResultsFolder(out))
    return bare_law(out)


def checks(values: tuple[object, ...], folder: Path) -> list[dict]:
    """Compare laws at every reduced radius other than the three, at every velocity."""
    text = MIXTURE.format(**dict(zip(NAMES, values, strict=True)))
    (family,) = families(parse_mixture(text))
    radii = family.radii
    middle = min(radii, key=lambda R: abs(math.log(R * R / (radii[0] * radii[-1]))))
    known = (radii[0], middle, radii[-1])
    computed = FamilyLaws(family, tuple(law_at(family, R, folder) for R in known))
    rows = []
    for radius in radii:
        if radius in known:
            continue
        direct = law_at(family, radius, folder)
        pair = next(m for m in family.pairs if math.isclose(m.radius, radius, rel_tol=1e-9))
        for point in computed.law(pair).points:
            same_work = math.sqrt(2 * point.loading_work / direct.mass)
            found = direct.at(min(max(same_work, direct.lowest), direct.highest))
            rows.append(
                {
                    "material": values[0],
                    "reduced_radius_m": f"{radius:.6g}",
                    "velocity_m_per_s": f"{point.velocity:.6g}",
                    "restitution_interpolated": f"{point.restitution:.5f}",
                    "restitution_computed": f"{found.restitution:.5f}",
                    "error": f"{point.error + found.error:.5f}",
                }
            )
    return rows


def main() -> None:
    """Write the table, and print how often the error holds."""
    with tempfile.TemporaryDirectory() as folder:
        rows = [row for values in MIXTURES for row in checks(values, Path(folder))]
    write_table("mixture/mixture_blind.csv", rows)
    off = [
        abs(float(row["restitution_interpolated"]) - float(row["restitution_computed"]))
        for row in rows
    ]
    held = [miss <= float(row["error"]) + 1e-5 for miss, row in zip(off, rows, strict=True)]
    print(f"{sum(held)} of {len(held)} held; largest difference {max(off):.3f}")


if __name__ == "__main__":
    main()
