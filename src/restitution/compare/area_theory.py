"""Contact area of a periodic contact from Persson's theory, beside the computed area."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from restitution.case.case import Case
from restitution.errors import CaseError, OutputError
from restitution.laws.law import Array
from restitution.results.periodic import PeriodicResults
from restitution.results.writer import make_folder, write_table
from restitution.theory import Persson


@dataclass(frozen=True, eq=False)
class AreaTheory:
    """Relative contact area at nominal pressures `pressure` (Pa), shape (depths,).

    `theory` has the rms slope of the surface. `computed` is the area corrected for the staircase
    edge and `stiffness` in Pa/m; NaN where not computed. `left_out` says what the bodies do and the
    theory does not.
    """

    title: str
    theory: Persson
    pressure: Array
    computed: Array
    stiffness: Array
    left_out: str

    @property
    def area(self) -> Array:
        """Relative contact area from the theory."""
        return self.theory.relative_area(self.pressure)

    @property
    def kappa(self) -> Array:
        """Computed area divided by p/(E* h′); 1.60 in Persson's theory at low pressure."""
        scale = float(self.theory.contact_modulus) * float(self.theory.rms_slope)
        return self.computed * scale / self.pressure

    def write(self, out: Path) -> Path:
        """Write `theory.csv` into `out`, which must be new or empty. Raises `OutputError`."""
        make_folder(out)
        names = ("nominal_pressure_Pa", "persson", "computed", "kappa", "stiffness_Pa_per_m")
        columns = (self.pressure, self.area, self.computed, self.kappa, self.stiffness)
        rows = [
            dict(zip(names, map(float, row), strict=True)) for row in zip(*columns, strict=True)
        ]
        write_table(out / "theory.csv", rows)
        return out / "theory.csv"


def area_of_case(case: Case, folder: Path) -> AreaTheory:
    """The theory at the nominal pressures of a periodic case, with files in `folder`.

    Raises `CaseError` if the case prescribes indentations, whose pressures only a run tells.
    """
    if case.indentation is not None:
        raise CaseError(
            "[indentation]: only a run tells the nominal pressures of these depths; run the case, "
            "and give the folder of its results to compare-theory"
        )
    contact = case.contact(folder)
    p = np.array(case.depths())
    if case.load is not None:
        p /= contact.grid.size[0] * contact.grid.size[1]
    yields = math.isfinite(contact.hardness)
    unknown = np.full(p.shape, np.nan)
    theory = Persson(contact.slope, contact.pair.contact_modulus)
    return AreaTheory(case.title, theory, p, unknown, unknown, _left_out(yields, contact.adhesive))


def area_of_results(results: PeriodicResults) -> AreaTheory:
    """The theory at the nominal pressures of stored results. Raises `OutputError`."""
    data, summary = results.dataset, results.summary
    data = data.isel(depth=data["nominal_pressure"].values > 0)
    p = data["nominal_pressure"].values
    if not p.size:
        raise OutputError(
            f"{results.folder}: no depth has a positive nominal pressure; begin deeper"
        )
    derived, model = summary["derived"], summary["model"]
    stiffness = data["stiffness"].values if "stiffness" in data else np.full(p.shape, np.nan)
    return AreaTheory(
        summary["title"],
        Persson(derived["rms_slope"], derived["contact_modulus_Pa"]),
        p,
        data["corrected_relative_area"].values,
        stiffness,
        _left_out(model["plasticity"] != "none", model["adhesion"] != "none"),
    )


def _left_out(yields: bool, adheres: bool) -> str:
    return " and ".join(["yielding"] * yields + ["adhesion"] * adheres)
