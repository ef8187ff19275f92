"""
Surface statistics
==================

This figure shows three generated surfaces with the same Rq: a section, the distribution of heights
and the power spectral density. COR at low velocity depends on the power spectral density.
"""

import matplotlib.pyplot as plt
import numpy as np

import restitution as rs

grid = rs.Grid(nodes=(512, 512), spacing=(50e-9, 50e-9))
kinds = {
    "gaussian": {"correlation_length": 2e-6},
    "exponential": {"correlation_length": 2e-6, "shortest": 0.2e-6},
    "self-affine": {"hurst": 0.8, "rolloff": 5e-6, "shortest": 0.2e-6},
}

fig, (sections, heights, spectra) = plt.subplots(1, 3, figsize=(10, 3.4), layout="constrained")
for i, (kind, waves) in enumerate(kinds.items()):
    surface = rs.generate_surface(grid, kind=kind, rms=50e-9, seed=1, **waves)
    z = 1e9 * surface.height
    slope = rs.describe(surface)["Sdq"]
    label = f"{kind}, slope {slope:.2f}"
    sections.plot(1e6 * grid.x, z[:, 0] + 400 * i, lw=0.8, label=label)
    heights.hist(z.ravel(), bins=60, density=True, histtype="step")
    power = np.abs(np.fft.fft(z, axis=0)[1:256]) ** 2
    spectra.loglog(np.arange(1, 256) / (1e6 * 512 * 50e-9), power.mean(axis=1))
sections.set(xlabel="x (µm)", ylabel="height (nm), shifted", ylim=(None, 1500))
sections.legend(fontsize="x-small", loc="upper right")
heights.set(xlabel="height (nm)", ylabel="density (1/nm)")
spectra.set(xlabel="wave number (1/µm)", ylabel="power of sections", ylim=(1e-3, None))
plt.show()
