"""Companion curves that show the errors of a law of patches (docs/two-scales.md)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from restitution.curve.columns import Array
from restitution.curve.work_curve import WorkCurve
from restitution.numerics.intervals import half_interval

# Scatter between patches of a run, divided by that between its companion's, whose waves are twice
# as long in patches as large.
_OF_SHORTER = 0.5
# Error of the change of COR by the patches, as a fraction of this change, where the radius of the
# real contact area is the wavelength of the split; and the largest ratio of wavelength to radius.
_OF_CHANGE, _LARGEST_RATIO = 0.2, 10.0
# The same fraction at any radius if the bound grows. Both were chosen on the 76 cases of
# evidence/two_scales/parts.csv.
_OF_GROWING_CHANGE = 0.25


@dataclass(frozen=True)
class ScaleCurves:
    """Curves that show the errors of a law of patches.

    `single` has the curve of the law of each patch, `weaker` that of weaker bodies if their bound
    grows, and `without` that without the waves of the patches if the bodies do not attract each
    other. `wavelength` is that of the split of the run, and `edge` that of a patch (m); `edge` is 0
    if asperities have their places in the contact, so that other surfaces show the scatter of such
    a sample.
    """

    own: WorkCurve
    single: tuple[WorkCurve, ...]
    weaker: WorkCurve | None
    without: WorkCurve | None
    edge: float
    wavelength: float

    def error(self, quantity_of: Callable[[WorkCurve], Array], area: Array | float) -> Array:
        """Error of a quantity due to the scatter of patches, and to a bound that grows.

        The waves in the contact are one sample as large as its nominal `area` (m²).
        """
        own = quantity_of(self.own)
        growth = 0 * own
        if self.weaker is not None:
            growth = np.abs(quantity_of(self.weaker) - own)
        if len(self.single) < 2:
            return np.asarray(growth)
        deviation = np.std([quantity_of(curve) for curve in self.single], axis=0, ddof=1)
        sample = np.sqrt(self.edge**2 / np.maximum(area, 1e-300))
        # Laws with attraction have not been compared.
        share = 1.0 if self.without is None else _OF_SHORTER
        scatter = share * deviation * np.hypot(half_interval(len(self.single)), sample)
        return np.asarray(np.hypot(scatter, growth))

    def split_ratio(self, area: Array) -> Array:
        """Wavelength of the split divided by the radius of the real `area` (m²).

        Errors between bodies without attraction grow with it; 1 if they attract each other.
        """
        if self.without is None:
            return np.ones(area.size)
        ratio = self.wavelength / np.sqrt(np.maximum(area, 1e-300) / math.pi)
        return np.asarray(np.minimum(ratio, _LARGEST_RATIO))

    def separation_error(self, work: Array, area: Array) -> Array:
        """Error of COR at `work` (J) as a fraction of its change by the patches.

        Waves are not short beside the real `area` (m²), and a bound that grows is approximate.
        """
        if self.without is None:
            return np.zeros(work.size)
        fraction = _OF_CHANGE * self.split_ratio(area)
        if self.weaker is not None:
            fraction = np.hypot(fraction, _OF_GROWING_CHANGE)
        return np.asarray(fraction * np.abs(self.own.at(work) - self.without.at(work)))
