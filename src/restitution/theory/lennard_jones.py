"""Surface forces of finite range: the Lennard-Jones law between half-spaces and rigid spheres.

Integrating the Lennard-Jones potential of atoms over two half-spaces gives the traction

    σ(g) = 8w/(3z₀) [(z₀/g)³ − (z₀/g)⁹]

at the gap g (attraction positive), with the work of adhesion w = ∫σ dg from z₀ to infinity and the
equilibrium separation z₀ (V. M. Muller, V. S. Yushchenko, B. V. Derjaguin, J. Colloid Interface
Sci. 77 (1980) 91–101; J. A. Greenwood, Proc. R. Soc. Lond. A 453 (1997) 1277–1297). The traction is
largest, σ₀ = 16w/(9√3 z₀), at g = 3^{1/6} z₀.

Integrating this traction over rigid spheres (a paraboloid of reduced radius R*) gives the force

    F = −(8/3) πwR* [(z₀/g)² − ¼ (z₀/g)⁸]

at the smallest gap g between the spheres, with the pull-off force 2πwR* at g = z₀ (R. S. Bradley,
Phil. Mag. 13 (1932) 853–862). Elastic spheres approach this limit as their Tabor parameter tends to
zero.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ._inputs import Array, PositiveFields, Values, positive, scalar_or_array


@dataclass(frozen=True, eq=False)
class LennardJones(PositiveFields):
    """Lennard-Jones traction between two surfaces, and the force between rigid spheres.

    Attributes:
        work_of_adhesion: Work of adhesion w (J/m²).
        equilibrium_separation: Gap z₀ at which the traction is zero (m).

    Raises:
        CaseError: A field is not positive and finite.

    Source:
        V. M. Muller, V. S. Yushchenko, B. V. Derjaguin, J. Colloid Interface Sci. 77 (1980) 91–101.
    """

    work_of_adhesion: Values
    equilibrium_separation: Values

    def traction(self, gap: Values) -> Array:
        """Attractive force per area between two surfaces.

        Args:
            gap: Gap g between the surfaces (m), positive.

        Returns:
            Traction σ (Pa), positive for attraction.
        """
        x = self._ratio(gap)
        scale = 8 * self.work_of_adhesion / (3 * self.equilibrium_separation)
        return scalar_or_array(scale * x**3 * (1 - x**6))

    def energy(self, gap: Values) -> Array:
        """Interaction energy per area, −∫σ dg from the gap to infinity.

        Args:
            gap: Gap g between the surfaces (m), positive.

        Returns:
            Energy per area (J/m²). At the equilibrium separation it is −w, where w is the work of
            adhesion; at infinity it is 0.
        """
        x2 = self._ratio(gap) ** 2
        return scalar_or_array(-self.work_of_adhesion * x2 * (4 - x2**3) / 3)

    @property
    def largest_traction(self) -> Array:
        """Largest attraction σ₀ = 16w/(9√3 z₀) (Pa)."""
        return scalar_or_array(
            16 * self.work_of_adhesion / (9 * math.sqrt(3) * self.equilibrium_separation)
        )

    @property
    def dugdale_traction(self) -> Array:
        """Constant traction 0.548 w/z₀ (Pa) of the Dugdale law that replaces the Lennard-Jones law.

        Both laws have the same work of adhesion w and the same integral ∫σ² dg of the squared
        traction. With the constant traction, `MaugisDugdale` gives the pull-off force of the
        Lennard-Jones law within 1.5 %. With `largest_traction` instead, `MaugisDugdale` gives a
        pull-off force that is up to 5.4 % too small (docs/adhesion.md).
        """
        factor = 64 / 9 * (1 / 5 - 2 / 11 + 1 / 17)
        return scalar_or_array(factor * self.work_of_adhesion / self.equilibrium_separation)

    @property
    def gap_of_largest_traction(self) -> Array:
        """Gap 3^{1/6} z₀ (m) at which the attraction is largest."""
        return scalar_or_array(3 ** (1 / 6) * np.asarray(self.equilibrium_separation))

    def rigid_sphere_force(self, gap: Values, radius: Values) -> Array:
        """Force between rigid spheres (Bradley 1932).

        Args:
            gap: Smallest gap g between the spheres (m), positive.
            radius: Reduced radius R* (m).

        Returns:
            Normal force F (N), positive in compression.

        Raises:
            CaseError: `radius` is not positive and finite.
        """
        (R,) = positive(radius=radius)
        x2 = self._ratio(gap) ** 2
        return scalar_or_array(-8 / 3 * math.pi * self.work_of_adhesion * R * x2 * (1 - x2**3 / 4))

    def rigid_sphere_energy(self, gap: Values, radius: Values) -> Array:
        """Interaction energy of rigid spheres, ∫F dg from the gap to infinity.

        Args:
            gap: Smallest gap g between the spheres (m), positive.
            radius: Reduced radius R* (m).

        Returns:
            Energy (J), 0 at infinity.

        Raises:
            CaseError: `radius` is not positive and finite.
        """
        (R,) = positive(radius=radius)
        x, z0 = self._ratio(gap), self.equilibrium_separation
        return scalar_or_array(-8 / 3 * math.pi * self.work_of_adhesion * R * z0 * (x - x**7 / 28))

    def rigid_pull_off_force(self, radius: Values) -> Array:
        """Largest tension between rigid spheres (Bradley 1932).

        Args:
            radius: Reduced radius R* (m).

        Returns:
            Magnitude 2πwR* of the pull-off force (N).

        Raises:
            CaseError: `radius` is not positive and finite.
        """
        (R,) = positive(radius=radius)
        return scalar_or_array(2 * math.pi * self.work_of_adhesion * R)

    def _ratio(self, gap: Values) -> Array:
        """Ratio z₀/g of the equilibrium separation to the gap."""
        return scalar_or_array(self.equilibrium_separation / np.asarray(gap, dtype=np.float64))
