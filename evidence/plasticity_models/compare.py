"""How far each model of plasticity is from finite elements and from a rough contact in 3D.

    python evidence/plasticity_models/compare.py [CASE ...]

reads the references in `finite_elements/data` and `rough_plastic/data`, computes each of their
contacts (or those of the cases that are named) with every model, and writes `models.csv` (a row for
each model and depth) and the figure of docs/validation.md. `--figures` only draws it again.

COR and force of the steepest waves are compared with the values extrapolated to vanishing element
size (`finite_elements/data/convergence.csv`). Columns `_raw` have the value of one mesh,
and `_uncertainty` that of the extrapolation.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
CONVERGENCE = HERE.parent / "finite_elements" / "data" / "convergence.csv"
TABLE = HERE / "models.csv"
IMAGES = HERE.parents[1] / "docs" / "images"
# Constants of the model were chosen on these; all others were computed afterwards.
CHOSEN_ON = ("smooth_0.001", "waves_A0.03um_L8um")
MODELS = ("expanding-cavity", "equilibrium", "truncated")
QUANTITIES = ("force_N", "contact_area_m2", "loading_work_J", "unloading_work_J", "restitution")
EXTRAPOLATED = ("restitution", "force_N")
NODES, NODES_ON_WAVES, NODES_PER_WAVE = 192, 304, 32
_RATIO = 1.3  # of successive depths
_ROUGH_RATIO = 1.17  # the same for rough contacts


def extrapolations() -> dict[tuple[str, float], dict[str, str]]:
    """Values extrapolated to vanishing element size, by case and ω."""
    with open(CONVERGENCE, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["mesh"] == "extrapolated"]
    return {(row["case"], float(row["omega"])): row for row in rows}


def material(model: dict, name: str) -> dict:
    """Arguments of `Contact` for one of our models of the material of a reference."""
    Y, H = model["yield_strength_Pa"], model["hardening_modulus_Pa"]
    from restitution.case.models import plasticity_of

    if name != "expanding-cavity":
        return {"plasticity": plasticity_of(name, 2.8 * Y)}
    E = model["youngs_modulus_Pa"]
    return {"plasticity": plasticity_of(name, yield_strength=Y, tangent_modulus=H * E / (H + E))}


def pair_of(model: dict):
    """The deformable sphere of a reference on its rigid flat: here two spheres, twice as stiff."""
    from restitution import Body, Pair

    R, E = model["radius_m"], model["youngs_modulus_Pa"]
    body = Body(2 * R, 2 * E, model["poissons_ratio"])
    return Pair(body, body)


def waves(grid, model: dict):
    """The surface of a reference: concentric waves with a crest at the apex."""
    from restitution import Surface

    A, wavelength = model["wave_amplitude_m"], model["wavelength_m"]
    if A == 0:
        return Surface(np.zeros(grid.nodes), grid)
    r = np.hypot(grid.x[:, None], grid.y[None, :])
    return Surface(-A * (1 - np.cos(2 * np.pi * r / wavelength)), grid)


def at_depth(contact, depths, last) -> dict:
    """Force, area, works and COR of `contact` at the last of `depths`, loaded through all."""
    from restitution.collision import collide
    from restitution.contact.path import loading_path

    through = [depth for depth in depths if depth < last * (1 - 1e-9)]
    *_, state = loading_path(contact, [*through, last])
    return _quantities(state, collide(state))


def _quantities(state, collision) -> dict:
    return {
        "force_N": state.force,
        "contact_area_m2": state.contact_area,
        "loading_work_J": collision.loading_work,
        "unloading_work_J": collision.unloading_work,
        "restitution": collision.restitution,
    }


def axisymmetric(reference: dict) -> list[dict]:
    """Rows of one finite-element case, each depth on a grid of its own."""
    from restitution import Contact, Grid

    model, found = reference["model"], []
    smooth = model["wave_amplitude_m"] == 0
    for row in reference["summary"]:
        depth, R = row["indentation_m"], model["radius_m"]
        first = (0.3 if smooth else 0.003) * reference["critical_indentation_m"]
        steps = max(2, math.ceil(math.log(depth / first) / math.log(_RATIO)))
        depths = list(np.geomspace(first, depth, steps))
        half_width = 1.1 * math.sqrt(2 * R * depth)
        if not smooth:
            half_width += 0.5 * model["wavelength_m"]
        nodes = NODES
        if not smooth:
            cells = 2 * half_width / (model["wavelength_m"] / NODES_PER_WAVE)
            nodes = max(NODES_ON_WAVES, math.ceil(cells))
        grid = Grid((nodes, nodes), (2 * half_width / nodes,) * 2)
        for name in MODELS:
            contact = Contact(pair_of(model), waves(grid, model), **material(model, name))
            mine = at_depth(contact, depths, depth)
            found.append(
                _row(reference["case"], name, _strength_and_slope(contact, model), row, mine)
            )
    return found


def rough(reference: dict, folder: Path) -> list[dict]:
    """Rows of one rough contact in 3D, on the grid of the reference, at the same forces.

    The indentation of the reference does not count from first touch. The curve therefore ends where
    its force exceeds that of the reference.
    """
    from scipy.interpolate import PchipInterpolator

    from restitution import Contact, Grid, Surface
    from restitution.collision import collide
    from restitution.contact.path import loading_path

    model, found = reference["model"], []
    height = np.load(folder / reference["heights_file"]).astype(float)
    spacing = reference["grid"]["spacing_m"]
    grid = Grid(height.shape, (spacing, spacing))
    deepest, most = (
        max(row[name] for row in reference["summary"]) for name in ("indentation_m", "force_N")
    )
    for name in MODELS:
        contact = Contact(pair_of(model), Surface(height, grid), **material(model, name))
        states = []
        for state in loading_path(contact, 0.003 * deepest * _ROUGH_RATIO ** np.arange(60)):
            states.append(state)
            if state.force > most:
                break
        curve = [_quantities(state, collide(state)) for state in states]
        force = np.log([each["force_N"] for each in curve])
        for row in reference["summary"]:
            mine = {
                name: float(
                    PchipInterpolator(force, [q[name] for q in curve], extrapolate=False)(
                        np.log(row["force_N"])
                    )
                )
                for name in QUANTITIES
            }
            found.append(
                _row(reference["case"], name, _strength_and_slope(contact, model), row, mine)
            )
    return found


def _strength_and_slope(contact, model: dict) -> tuple:
    return model["yield_strength_Pa"] / contact.pair.contact_modulus, contact.slope


def _row(case: str, name: str, contact_of: tuple, reference: dict, mine: dict) -> dict:
    row = {"case": case, "model": name, "omega": reference.get("omega", "")}
    row["indentation_m"] = reference["indentation_m"]
    row["yield_strength_over_contact_modulus"] = f"{contact_of[0]:.6g}"
    row["rms_slope"] = f"{contact_of[1]:.4g}"
    omega = reference.get("omega")
    limit = {} if omega is None else extrapolations().get((case, omega), {})
    for quantity in QUANTITIES:
        # Use values without the oscillation due to nodes of the finite elements entering the
        # contact.
        smoothed = quantity.replace("_N", "_smoothed_N")
        its = raw = reference.get(smoothed, reference[quantity])
        if quantity in EXTRAPOLATED:
            its = float(limit.get(quantity, raw))
            row[f"{quantity}_reference_raw"] = raw
            row[f"{quantity}_reference_uncertainty"] = limit.get(f"{quantity}_uncertainty", "")
        row[f"{quantity}_reference"] = its
        row[quantity] = f"{mine[quantity]:.6g}"
        row[f"{quantity}_off"] = f"{mine[quantity] / its - 1:.4f}"
    return row


def compute(names: list[str]) -> list[dict]:
    """Compute the rows of the named cases, or of all cases."""
    rows = []
    for file in sorted(HERE.parent.glob("*/data/*.json")):
        if names and file.stem not in names:
            continue
        reference = json.loads(file.read_text())
        if file.parts[-3] == "finite_elements":
            rows += axisymmetric(reference)
        elif reference["heights_file"] is not None:
            rows += rough(reference, file.parent)
        print(file.stem, flush=True)
    return rows


def summary(rows: list[dict]) -> str:
    """The largest differences of each model from each case, as a table."""
    lines = ["| case | model | COR | force | area |", "|---|---|---|---|---|"]
    for case in dict.fromkeys(row["case"] for row in rows):
        for name in MODELS:
            of = [row for row in rows if row["case"] == case and row["model"] == name]
            worst = [
                max((float(row[f"{quantity}_off"]) for row in of), key=abs)
                for quantity in ("restitution", "force_N", "contact_area_m2")
            ]
            lines.append(f"| {case} | {name} | " + " | ".join(f"{x:+.1%}" for x in worst) + " |")
    return "\n".join(lines)


def draw(rows: list[dict]) -> None:
    """COR of every model beside the references: smooth bodies, waves, rough bodies."""
    from matplotlib.figure import Figure

    groups = {
        "smooth": ("Smooth spheres", "indentation over that of first yield, ω"),
        "waves": (
            "Spheres on concentric waves",
            "ω of the smooth sphere at the same indentation",
        ),
        "rough": ("Rough spheres in 3D, at the same force", "force (N)"),
    }
    figure = Figure(figsize=(12, 7), layout="constrained")
    axes = figure.subplots(2, 3)
    styles = {"expanding-cavity": "C0o", "equilibrium": "C1s", "truncated": "C2^"}
    for column, (kind, (title, label)) in enumerate(groups.items()):
        of = [row for row in rows if _kind(row["case"]) == kind]
        second = "contact_area_m2" if kind == "rough" else "force_N"  # rough ones have one force
        for row, quantity in enumerate(("restitution", second)):
            ax = axes[row, column]
            ax.axhline(0, color="0.5", lw=1)
            for name, style in styles.items():
                chosen = [each for each in of if each["model"] == name]
                x = [float(r["omega"] or r["force_N_reference"]) for r in chosen]
                y = [100 * float(r[f"{quantity}_off"]) for r in chosen]
                above = 3 if name == MODELS[0] else 2
                ax.plot(x, y, style[2], color=style[:2], ms=5, alpha=0.75, label=name, zorder=above)
            ax.set_xscale("log")
            ax.set_xticks(sorted(set(x)), [f"{value:.3g}" for value in sorted(set(x))])
            ax.minorticks_off()
            what = {"restitution": "COR", "force_N": "force"}.get(quantity, "contact area")
            ax.set(xlabel=label, ylabel=f"error of {what} (%)")
            if row == 0:
                ax.set_title(title)
            ax.grid(alpha=0.3)
    axes[0, 0].legend()
    figure.savefig(IMAGES / "validation.png", dpi=130)


def _kind(case: str) -> str:
    return "waves" if case.startswith("wave") else "rough" if case.startswith("rough") else "smooth"


def main() -> None:
    """Compute, write and draw."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="CASE", help="cases to compute; others stay")
    parser.add_argument("--figures", action="store_true", help="only draw the table again")
    options = parser.parse_args()
    rows = []
    if options.names or options.figures:
        with open(TABLE, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    if not options.figures:
        new = compute(options.names)
        computed = {row["case"] for row in new}
        rows = sorted(
            [*(row for row in rows if row["case"] not in computed), *new],
            key=lambda row: (row["case"], MODELS.index(row["model"]), float(row["indentation_m"])),
        )
        with open(TABLE, "w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            table.writeheader()
            table.writerows(rows)
    draw(rows)
    print(summary(rows))


if __name__ == "__main__":
    main()
