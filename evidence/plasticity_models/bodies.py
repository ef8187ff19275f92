"""Compare the models with impacts in which a sphere or a flat yields.

Writes bodies.csv and the figure, in minutes; `--figure` only draws the figure.

The references are in `finite_elements/data/bodies.csv`. COR of a model depends only on
ω, and its contact radius over the radius is proportional to the strength over the contact modulus.
"""

from __future__ import annotations

import argparse
import csv
import math
from pathlib import Path

import numpy as np

from compare import IMAGES, MODELS, NODES, at_depth, material, pair_of

HERE = Path(__file__).parent
REFERENCES = HERE.parent / "finite_elements" / "data" / "bodies.csv"
TABLE = HERE / "bodies.csv"
_STRENGTH = 0.001  # over the contact modulus
_R, _E, _NU = 500e-6, 210e9, 0.3


def critical_indentation(strength: float) -> float:
    """Indentation of first yield over the radius; `strength` is over the contact modulus."""
    return (math.pi * 1.295 * math.exp(0.736 * _NU) * strength / 2) ** 2


def impact(name: str, omega: float) -> tuple[float, float]:
    """COR of a model, and its contact radius over the radius divided by the strength over E*."""
    from restitution import Contact, Grid, smooth

    model = {
        "radius_m": _R,
        "youngs_modulus_Pa": _E,
        "poissons_ratio": _NU,
        "yield_strength_Pa": _STRENGTH * _E / (1 - _NU**2),
        "hardening_modulus_Pa": 0.0,
    }
    depth = omega * critical_indentation(_STRENGTH) * _R
    steps = max(2, math.ceil(math.log(omega / 0.3) / math.log(1.3)))
    half_width = 1.15 * math.sqrt(2 * _R * depth)
    contact = Contact(
        pair_of(model), smooth(Grid(NODES, 2 * half_width / NODES)), **material(model, name)
    )
    mine = at_depth(contact, np.geomspace(0.3 * depth / omega, depth, steps), depth)
    radius = math.sqrt(mine["contact_area_m2"] / math.pi) / _R
    return mine["restitution"], radius / _STRENGTH


def compute() -> list[dict]:
    """A row for each reference and model."""
    with open(REFERENCES, newline="", encoding="utf-8") as file:
        references = list(csv.DictReader(file))
    omegas = sorted({float(row["omega"]) for row in references})
    mine = {(name, omega): impact(name, omega) for name in MODELS for omega in omegas}
    rows = []
    for row in references:
        for name in MODELS:
            e, radius = mine[name, float(row["omega"])]
            reference = float(row["restitution"])
            rows.append(
                {
                    **{k: row[k] for k in ("code", "body", "strains", "strength", "omega", "use")},
                    "model": name,
                    "contact_radius": f"{radius * float(row['strength']):.6g}",
                    "restitution_reference": row["restitution"],
                    "restitution": f"{e:.6g}",
                    "restitution_off": f"{e / reference - 1:.4f}",
                }
            )
    return rows


def draw(rows: list[dict]) -> None:
    """Error of COR of `expanding-cavity` over the contact radius, for each body that yields."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 4.2), layout="constrained")
    ax = figure.subplots()
    styles = {"sphere": "C0o", "flat": "C1s"}
    for body, style in styles.items():
        for code, fill in (("own", style[:2]), ("calculix", "none")):
            of = [
                row
                for row in rows
                if (row["model"], row["strains"]) == (MODELS[0], "finite")
                and (row["body"], row["code"]) == (body, code)
            ]
            x = [float(row["contact_radius"]) for row in of]
            y = [100 * float(row["restitution_off"]) for row in of]
            if of:
                label = f"{body} yields" + (", CalculiX" if code == "calculix" else "")
                marker = {"color": style[:2], "mfc": fill, "ms": 6, "label": label}
                ax.plot(x, y, style[2], **marker)
    ax.set(
        xlabel="contact radius of the model over the radius, a/R",
        ylabel="error of COR (%)",
        xscale="log",
    )
    ticks = (0.01, 0.02, 0.05, 0.1, 0.2, 0.4)
    ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    ax.minorticks_off()
    ax.axhline(0, color="0.5", lw=1)
    ax.grid(alpha=0.3)
    ax.legend()
    figure.savefig(IMAGES / "bodies.png", dpi=130)


def main() -> None:
    """Compute, write and draw."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--figure", action="store_true", help="only draw the figure")
    if parser.parse_args().figure:
        with open(TABLE, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    else:
        rows = compute()
        with open(TABLE, "w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            table.writeheader()
            table.writerows(rows)
    draw(rows)


if __name__ == "__main__":
    main()
