"""Height, slope and correlation parameters of a rough surface, after ISO 25178-2:2012."""

from __future__ import annotations

import math

import numpy as np

from restitution.arguments import typed
from restitution.surfaces.surface import Array, Surface

# Value of the autocorrelation that defines the correlation length (Hu and Tonder 1992), as in
# `generate_surface`. The autocorrelation length Sal of the standard uses 0.2 instead.
_CORRELATION_LEVEL = 0.1


@typed
def describe(surface: Surface) -> dict[str, float | None]:
    """Height, slope and correlation parameters, after ISO 25178-2:2012 (clauses in brackets).

    z is the height minus its mean, and ⟨ ⟩ is the mean over all cells.

    - `Sq_m`: root mean square height, ⟨z²⟩^½ (4.1.1)
    - `Ssk`: skewness, ⟨z³⟩/Sq³ (4.1.2)
    - `Sku`: kurtosis, ⟨z⁴⟩/Sq⁴; 3 for normally distributed heights (4.1.3)
    - `Sp_m`: maximum peak height, max z (4.1.4)
    - `Sv_m`: maximum pit height, −min z (4.1.5)
    - `Sz_m`: maximum height, Sp + Sv (4.1.6)
    - `Sa_m`: arithmetical mean height, ⟨|z|⟩ (4.1.7)
    - `Sdq`: root mean square gradient (4.3.1), from differences between neighbouring cells; central
      differences do not detect the shortest waves
    - `rms_curvature_per_m`: half the root mean square Laplacian, for isotropic asperities the rms
      curvature
    - `correlation_length_x_m`, `correlation_length_y_m`: lag at which the biased autocorrelation
      first falls to 10 % (Hu and Tonder 1992)

    Args:
        surface: Surface to describe; subtract its tilt and form first (`level`).

    Returns:
        Parameters by name (SI); None where undefined, or a correlation length beyond the domain.
    """
    height = surface.height
    z = height - height.mean()
    hx, hy = surface.grid.spacing
    Sq = math.sqrt(np.mean(z**2))
    Sp, Sv = float(z.max()), float(-z.min())
    values: dict[str, float | None] = {
        "Sq_m": Sq,
        "Sa_m": float(np.mean(np.abs(z))),
        "Ssk": None,
        "Sku": None,
        "Sp_m": Sp,
        "Sv_m": Sv,
        "Sz_m": Sp + Sv,
        "Sdq": rms_slope(surface),
        "rms_curvature_per_m": _rms_curvature(z, hx, hy),
        "correlation_length_x_m": None,
        "correlation_length_y_m": None,
    }
    # Rounding can make the heights of a flat surface differ from their mean.
    if Sq > 8 * np.finfo(np.float64).eps * float(np.abs(height).max()):
        unit = z / Sq
        values |= {
            "Ssk": float(np.mean(unit**3)),
            "Sku": float(np.mean(unit**4)),
            "correlation_length_x_m": _correlation_length(unit, hx),
            "correlation_length_y_m": _correlation_length(unit.T, hy),
        }
    return values


def rms_slope(surface: Surface) -> float:
    """Root mean square gradient (dimensionless), the parameter `Sdq` of `describe`."""
    hx, hy = surface.grid.spacing
    z = surface.height - surface.height.mean()
    return math.sqrt(_mean_square_slope(z, hx) + _mean_square_slope(z.T, hy))


def _mean_square_slope(z: Array, h: float) -> float:
    """Mean square slope ⟨(∂z/∂x)²⟩ along the first axis; 0 for a single line of cells."""
    return float(np.mean((np.diff(z, axis=0) / h) ** 2)) if z.shape[0] > 1 else 0.0


def _rms_curvature(z: Array, hx: float, hy: float) -> float:
    """Half the rms Laplacian (1/m) at the inner nodes; axes of fewer than 3 nodes are omitted."""
    laplacian = np.zeros([n - 2 if n > 2 else n for n in z.shape])
    inner = tuple(slice(1, -1) if n > 2 else slice(None) for n in z.shape)
    if z.shape[0] > 2:
        laplacian = laplacian + (np.diff(z, 2, axis=0) / hx**2)[:, inner[1]]
    if z.shape[1] > 2:
        laplacian = laplacian + (np.diff(z, 2, axis=1) / hy**2)[inner[0], :]
    return 0.5 * math.sqrt(np.mean(laplacian**2))


def _correlation_length(z: Array, h: float) -> float | None:
    from scipy.fft import irfft, next_fast_len, rfft

    # The FFT treats each line as periodic. Padding with zeros to twice the length prevents a
    # correlation between the two ends of a line.
    n = z.shape[0]
    padded = next_fast_len(2 * n, real=True)
    power = np.sum(np.abs(rfft(z, n=padded, axis=0)) ** 2, axis=1)
    R = irfft(power, n=padded)[:n]
    R = R / R[0]
    fallen = np.flatnonzero(R <= _CORRELATION_LEVEL)
    if fallen.size == 0:
        return None
    k = int(fallen[0])
    fraction = (R[k - 1] - _CORRELATION_LEVEL) / (R[k - 1] - R[k])
    return float((k - 1 + fraction) * h)
