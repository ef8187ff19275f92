"""The works of loading and unloading."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator


def loading_work(indentation, force, first_exponent=1.5) -> np.ndarray:
    """Return ∫F dδ (J) up to each point, with F a power of δ between two points.

    Args:
        indentation: depths (m), increasing, the first above 0.
        force: forces (N).
        first_exponent: F ∝ δ^exponent below the first point.
    """
    d, f = np.asarray(indentation), np.asarray(force)
    n = np.log(f[1:] / f[:-1]) / np.log(d[1:] / d[:-1])
    parts = (f[1:] * d[1:] - f[:-1] * d[:-1]) / (n + 1)
    return np.concatenate([[0], np.cumsum(parts)]) + f[0] * d[0] / (first_exponent + 1)


def unloading_work(indentation, force) -> float:
    """Return ∫F dδ (J) over an unloading curve (m, N) by monotone cubic interpolation."""
    d, f = np.asarray(indentation)[::-1], np.asarray(force)[::-1]
    keep = np.concatenate([[True], np.diff(d) > 0])
    return float(PchipInterpolator(d[keep], f[keep]).integrate(d[0], d[-1]))
