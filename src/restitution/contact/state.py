"""One state of a contact: a solve returns it, and the next step starts from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact, whole_grid
from restitution.display import counted, quantity, summary_html, summary_text
from restitution.errors import CaseError
from restitution.numerics.box import Box, reframe
from restitution.numerics.read_only import read_only

Array = NDArray[np.float64]

_EXCESS = (math.pi - 1 + math.log(2)) / 24  # of the area of a staircase edge, per face and cell


@dataclass(frozen=True, eq=False)
class State:
    """A contact in equilibrium at one indentation.

    States are compared and hashed by identity; to compare values, compare the fields.

    Attributes:
        contact: The contact before loading.
        indentation: Approach of the bodies (m).
        box: Block of the grid on which the contact was solved; the pressure is zero outside.
        box_pressure: Pressure (Pa) on `box`; tension is negative.
        box_displacement: Elastic displacement (m) on `box`.
        plastic_displacement: Depth (m) by which yielding has lowered the surface, shape
            `grid.nodes`.
        bound: Pressure (Pa) at which each node yields: one number, or an array of shape
            `grid.nodes`.
        plastic_work: Work dissipated by yielding so far (J).
        adhesive_work: Work done by adhesion so far (J).
        work_error: Error of plastic work and adhesive work together (J).
        residual: Largest violation of the contact conditions (dimensionless), relative to the
            largest overlap of the undeformed surfaces or, with adhesion, to
            `Adhesion.residual_length`.
        convolutions: Number of convolutions computed in the solve.
        force_before_release: Force (N) just before nodes were released in this step of adhesive
            unloading; None after loading.
        balance: Indentation (m) and force (N) at which the energy release rate, averaged along the
            edge of the previous contact area, equals the work of adhesion; None if unknown.
        is_first_loading: Whether the state was computed by loading the undeformed bodies, not by a
            step from another state (bool).
        adhesive_loss: Energy dissipated so far by jumps between equilibria of an attraction of
            finite range (J).
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
    balance: tuple[float, float] | None = None
    is_first_loading: bool = True
    adhesive_loss: float = 0.0

    def __post_init__(self) -> None:
        for name in ("box_pressure", "box_displacement", "plastic_displacement", "bound"):
            values = getattr(self, name)
            if isinstance(values, np.ndarray):
                object.__setattr__(self, name, read_only(values))

    @property
    def pressure(self) -> Array:
        """Pressure on the whole grid (Pa), shape `grid.nodes`."""
        return self.pressure_on(whole_grid(self.contact))

    def pressure_on(self, box: Box) -> Array:
        """Pressure on a block of the grid.

        Args:
            box: Slices of the rows and columns.

        Returns:
            Pressure (Pa), shape of `box`.
        """
        return reframe(self.box_pressure, self.box, box)

    @cached_property
    def force(self) -> float:
        """Normal force (N), the sum of the pressure over all nodes times the cell area."""
        return float(self.box_pressure.sum()) * self.contact.grid.cell_area

    @property
    def box_touching(self) -> NDArray[np.bool_]:
        """Whether each node of `box` is in contact (bool), that is, its pressure is not 0."""
        return np.asarray(self.box_pressure != 0)

    @cached_property
    def contact_nodes(self) -> int:
        """Number of nodes in contact."""
        return int(np.count_nonzero(self.box_touching))

    @property
    def contact_area(self) -> float:
        """Real contact area (m²), the number of nodes in contact times the cell area."""
        return self.contact_nodes * self.contact.grid.cell_area

    @property
    def corrected_area(self) -> float:
        """Real contact area of a periodic contact (m²), corrected for its staircase edge.

        The whole cell of a node counts as contact, which adds a strip along the edge. Its area is
        (π − 1 + ln 2)/24 times the length of the staircase edge times the spacing (Yastrebov,
        Anciaux and Molinari 2017, Tribol. Int. 114, 161–171).
        """
        touching = reframe(self.box_touching, self.box, whole_grid(self.contact))
        hx, hy = self.contact.grid.spacing
        # A face of the staircase edge has the length hy and separates cells of the width hx, or the
        # other way round. So length times spacing is hx hy for each face.
        faces = sum(np.count_nonzero(touching != np.roll(touching, 1, axis)) for axis in (0, 1))
        return self.contact_area - _EXCESS * int(faces) * hx * hy

    @property
    def relative_area(self) -> float:
        """Real contact area divided by the area of the grid (dimensionless)."""
        return self.contact_nodes / math.prod(self.contact.grid.nodes)

    @property
    def nominal_pressure(self) -> float:
        """Normal force divided by the area of the grid (Pa)."""
        return self.force / math.prod(self.contact.grid.size)

    @property
    def mean_gap(self) -> float:
        """Mean of the deformed gap (m), the distance between the mean planes of the surfaces.

        Raises:
            CaseError: The contact is not periodic.
        """
        if not self.contact.periodic:
            raise CaseError("mean_gap: only a periodic contact has a mean gap")
        gap = self.contact.gap.mean() + self.plastic_displacement.mean() - self.indentation
        return float(gap)

    @cached_property
    def stored_energy(self) -> float:
        """Elastic energy ½ Σ p u hx hy (J).

        p is the pressure, u the elastic displacement and hx hy the cell area.
        """
        twice = float(np.einsum("ij,ij->", self.box_pressure, self.box_displacement))
        return 0.5 * twice * self.contact.grid.cell_area

    @property
    def plastic_volume(self) -> float:
        """Plastic volume (m³), the sum of the plastic displacement times the cell area."""
        return float(self.plastic_displacement.sum()) * self.contact.grid.cell_area

    @property
    def loading_work(self) -> float:
        """Work done on the bodies so far (J), elastic energy + plastic work − adhesive work."""
        return self.stored_energy + self.plastic_work - self.adhesive_work

    @property
    def separation_indentation(self) -> float:
        """Indentation (m) at which bodies without adhesion separate.

        It is the smallest sum h₀ + u_p of initial gap and plastic displacement.
        """
        # It suffices to search the box, because h₀ + u_p is smaller at nodes in contact than at
        # nodes outside the box.
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
        """Sizes of the contact patches, which are sets of contact nodes connected by cell edges.

        Patches of a periodic contact continue across the edges of the grid.

        Returns:
            Sizes (nodes), shape (patches,), largest first.
        """
        from scipy.ndimage import label

        labels, count = label(self.box_touching)
        sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
        if self.contact.periodic and count:
            sizes = np.bincount(_joined(labels, count), weights=sizes).astype(np.int64)
        return np.sort(sizes)[::-1]


def _joined(labels: NDArray[np.int32], count: int) -> NDArray[np.int32]:
    """Patch number (from 0) of each label (from 1); labels join across opposite edges."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edges = np.hstack([[labels[0], labels[-1]], [labels[:, 0], labels[:, -1]]])
    pairs = edges[:, edges.all(axis=0)] - 1
    graph = coo_array((np.ones(pairs.shape[1]), pairs), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])
