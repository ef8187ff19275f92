"""One state of a contact: what a solve returns and the next step starts from.

Nothing here changes after it is made: arrays are read-only. Fields hold what was solved for; force,
area, energies and maps are properties of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact
from restitution.display import counted, quantity, summary_html, summary_text
from restitution.numerics.box import Box, reframe
from restitution.numerics.read_only import read_only

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class State:
    """A contact in equilibrium at one indentation.

    `box` is the part of the grid that was solved on; `box_pressure` (Pa) and the elastic
    displacement `box_displacement` (m) are known there, and outside it the pressure is zero.
    `plastic_displacement` (m, the surface is left lower by it) has the shape of the grid, and so
    has `bound`, the largest pressure (Pa) that each node carries from now on, unless it is one for
    all.
    `plastic_work` (J) is what yielding has dissipated so far and `adhesive_work` what adhesion has
    done, known within `work_error`. `residual` is the largest violation of the contact conditions
    over the indentation, `convolutions` what the solve cost.

    The arrays are read-only, and copies of those given unless nobody can write to those. States are
    equal (and hash) by identity: compare their fields to compare values.
    """

    contact: Contact
    indentation: float
    box: Box
    box_pressure: Array
    box_displacement: Array
    plastic_displacement: Array
    bound: Array | float
    plastic_work: float
    adhesive_work: float
    work_error: float
    residual: float
    convolutions: int
    force_before_release: float | None = None
    is_first_loading: bool = True

    def __post_init__(self) -> None:
        for name in ("box_pressure", "box_displacement", "plastic_displacement", "bound"):
            values = getattr(self, name)
            if isinstance(values, np.ndarray):
                object.__setattr__(self, name, read_only(values))

    @property
    def pressure(self) -> Array:
        """Pressure on the whole grid, Pa."""
        rows, columns = (slice(0, n) for n in self.contact.grid.nodes)
        return self.pressure_on((rows, columns))

    def pressure_on(self, box: Box) -> Array:
        """Pressure on a box of the grid, Pa."""
        return reframe(self.box_pressure, self.box, box)

    @property
    def force(self) -> float:
        """Normal force F = Σ p hx hy, N."""
        return float(self.box_pressure.sum()) * self.contact.grid.cell_area

    @property
    def contact_nodes(self) -> int:
        """Number of nodes that carry pressure."""
        return int(np.count_nonzero(self.box_pressure))

    @property
    def contact_area(self) -> float:
        """Real contact area, nodes in contact times hx hy, m²."""
        return self.contact_nodes * self.contact.grid.cell_area

    @property
    def stored_energy(self) -> float:
        """Elastic energy E_el = ½ Σ p u hx hy, J."""
        twice = float(np.einsum("ij,ij->", self.box_pressure, self.box_displacement))
        return 0.5 * twice * self.contact.grid.cell_area

    @property
    def plastic_volume(self) -> float:
        """Volume V_p = Σ u_p hx hy by which yielding has lowered the surface, m³."""
        return float(self.plastic_displacement.sum()) * self.contact.grid.cell_area

    @property
    def loading_work(self) -> float:
        """Work done on the bodies so far, W = E_el + plastic work, J."""
        return self.stored_energy + self.plastic_work - self.adhesive_work

    @property
    def separation_indentation(self) -> float:
        """Indentation at which the bodies part on unloading: min(h₀ + u_p), m (no adhesion)."""
        # What is in contact lies lower than all that is outside the box.
        box = self.box if self.contact_nodes else ...
        return float((self.contact.gap[box] + self.plastic_displacement[box]).min())

    def _summary(self) -> list[str]:
        stored, plastic = quantity(self.stored_energy, "J"), quantity(self.plastic_work, "J")
        nodes, area = self.contact_nodes, quantity(self.contact_area, "m²")
        return [
            f"indentation {quantity(self.indentation, 'm')}, force {quantity(self.force, 'N')}",
            f"contact area {area} ({counted(nodes, 'node')})",
            f"stored energy {stored}, plastic work {plastic}",
        ]

    __repr__ = summary_text
    _repr_html_ = summary_html

    def patch_sizes(self) -> NDArray[np.int64]:
        """Nodes in each contact patch (nodes joined by an edge), largest first."""
        from scipy.ndimage import label

        labels, count = label(self.box_pressure != 0)
        sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
        return np.sort(sizes)[::-1]
