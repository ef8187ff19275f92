"""A known self-affine surface as instruments of different pixels, edges and faults see it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft2, rfft2
from scipy.integrate import trapezoid

from restitution.numerics.grid import Grid
from restitution.surfaces import Surface
from restitution.surfaces.noise import white_noise


@dataclass(frozen=True)
class KnownSurface:
    """Isotropic surface with C ∝ q^−2(H+1) below `rolloff`, constant above; lengths in m."""

    rms: float = 100e-9
    hurst: float = 0.8
    rolloff: float = 20e-6
    shortest: float = 0.0

    def density(self, q):
        """C (m⁴) at the wave numbers q (rad/m)."""
        waves = np.geomspace(1e-6, 1e3, 20001) * 2 * math.pi / self.rolloff
        power = trapezoid(self._shape(waves) * waves**2, np.log(waves)) / (2 * math.pi)
        return self.rms**2 / power * self._shape(q)

    def _shape(self, q):
        shape = np.maximum(q * self.rolloff / (2 * math.pi), 1.0) ** (-2 * (self.hurst + 1))
        if self.shortest:
            shape = np.where(q <= 2 * math.pi / self.shortest * (1 + 1e-9), shape, 0.0)
        return shape

    def slope(self, shortest, longest):
        """Rms slope of the waves between two wavelengths."""
        q = np.geomspace(2 * math.pi / longest, 2 * math.pi / shortest, 4001)
        return math.sqrt(trapezoid(self.density(q) * q**4, np.log(q)) / (2 * math.pi))

    def scan(self, edge, pixels, seed, *, smoothing=0.0, noise=0.0):
        """Part of a random surface with waves that the pixels carry, as one instrument sees it.

        `smoothing` (m) is the standard deviation of a Gaussian blur, `noise` (m) that of heights.
        """
        N, h = 3 * pixels, edge / pixels
        qx, qy = 2 * math.pi * np.fft.fftfreq(N, h), 2 * math.pi * np.fft.rfftfreq(N, h)
        q = np.hypot(qx[:, None], qy[None, :])
        C = self.density(q) * np.exp(-((q * smoothing) ** 2))
        C[0, 0] = 0.0
        z = irfft2(np.sqrt(C) / h * rfft2(white_noise((N, N), seed)), s=(N, N))[:pixels, :pixels]
        z += noise * white_noise((pixels, pixels), seed + 10**6)
        return Surface(np.ascontiguousarray(z), Grid((pixels, pixels), (h, h)))

    def line(self, edge, pixels, seed):
        """A line scan of such a surface."""
        h = edge / pixels
        q = 2 * math.pi * np.fft.rfftfreq(3 * pixels, h)
        u = np.linspace(0.0, 6.0, 241)
        across = np.maximum(q, q[1])[:, None] * np.cosh(u)
        C = trapezoid(self.density(across.ravel()).reshape(across.shape) * across, u, axis=1)
        C /= math.pi
        C[0] = 0.0
        modes = np.fft.rfft(white_noise((3 * pixels, 1), seed)[:, 0])
        z = np.fft.irfft(np.sqrt(C / h) * modes, n=3 * pixels)[:pixels]
        return Surface(z[:, None], Grid((pixels, 1), (h, h)))
