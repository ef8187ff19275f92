"""The tables of docs/materials.md, from the library of materials.

`python evidence/materials/materials.py` prints them.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

from restitution.case.materials import adhesive, materials, work_of_adhesion

QUANTITIES = {
    "youngs_modulus": ("Young's modulus E", "GPa", 1e9),
    "poissons_ratio": ("Poisson's ratio ν", "", 1),
    "density": ("Density ρ", "kg/m³", 1),
    "yield_strength": ("Yield strength Y", "MPa", 1e6),
    "hardness": ("Hardness H", "GPa", 1e9),
    "surface_energy": ("Surface energy γ", "mJ/m²", 1e-3),
}


def table() -> str:
    """One table of the materials, and one of each quantity; † marks what was not verified."""
    lines = ["| name | aliases | what it is | beware |", "|---|---|---|---|"]
    for each in materials().values():
        aliases = ", ".join(f"`{alias}`" for alias in each.aliases)
        lines.append(f"| `{each.key}` | {aliases} | {each.name} | {each.note} |")
    for key, (title, unit, scale) in QUANTITIES.items():
        lines += ["", f"## {title}{f', {unit}' if unit else ''}", ""]
        lines += ["| material | value | spread | source |", "|---|---|---|---|"]
        for each in materials().values():
            if found := getattr(each, key):
                value, low, high = (
                    f"{v / scale:.6g}" for v in (found.value, found.low, found.high)
                )
                mark = "" if found.verified else " †"
                spread = low if low == high else f"{low} to {high}"
                where = f" ({found.conditions})" if key == "surface_energy" else ""
                lines.append(f"| {each.key} | {value}{mark} | {spread} | {found.source}{where} |")
    return "\n".join(lines)


def pairs() -> str:
    """The rows of the table of works of adhesion."""
    return "\n".join(
        f"| {first}, {second} | {1e3 * w.value:.3g} | {1e3 * w.low:.3g} to {1e3 * w.high:.3g} |"
        for first, second in combinations_with_replacement(adhesive(), 2)
        if (w := work_of_adhesion(first, second))
    )


if __name__ == "__main__":
    print(pairs(), table(), sep="\n\n")
