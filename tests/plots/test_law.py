"""The figure of a law."""

from dataclasses import replace

import numpy as np

from restitution.dem.fits import fitted_laws
from restitution.laws.compact_fit import compact_fit
from restitution.plots.law import law_figure
from restitution.plots.static import draw


def test_fits_are_drawn_over_the_resolved_velocities_only(law):
    points = [replace(point, resolved=3 <= k < 12) for k, point in enumerate(law().points)]
    found = law(points=tuple(points))
    fits = {"fit": compact_fit(found), "laws": fitted_laws(found)}
    drawing = draw(law_figure(replace(found, **fits)))
    lines = [line for line in drawing.axes[0].lines if line.get_linestyle() in ("-", "--")]
    assert len(lines) > 5
    V = found.column("velocity")
    for line in lines:
        drawn = line.get_xdata()[np.isfinite(line.get_ydata())]
        assert drawn.min() >= V[3] * (1 - 1e-9)
        assert drawn.max() <= V[11] * (1 + 1e-9)
