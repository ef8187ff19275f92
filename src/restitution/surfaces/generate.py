"""Random rough surfaces with prescribed wave amplitudes and height distribution.

z = IFFT(H · FFT(white noise)) with the amplitudes H of `spectra` (Hu and Tonder 1992, Int. J. Mach.
Tools Manufact. 32, 83–90); `heights` gives another skewness or kurtosis than a normal distribution.
"""

from __future__ import annotations

import math
from typing import Literal, TypedDict, Unpack

import numpy as np

from restitution.arguments import typed
from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.heights import adjusted, distribution, filtered, in_order
from restitution.surfaces.johnson import LEAST_KURTOSIS, possible
from restitution.surfaces.noise import white_noise
from restitution.surfaces.spectra import Autocorrelated, SelfAffine, Spectrum
from restitution.surfaces.surface import Array, Surface

RoughnessKind = Literal["exponential", "gaussian", "self-affine"]

# A non-periodic surface is cut from a larger periodic surface, so that opposite edges are
# uncorrelated. The additional length along each axis is at most this factor times the correlation
# distance `Spectrum.longest`.
_MARGIN = 2.0


class Waves(TypedDict, total=False):
    """Arguments of `generate_surface` that describe the waves; lengths in m, `lay` in rad."""

    correlation_length: float | tuple[float, float] | None
    lay: float | None
    hurst: float | None
    rolloff: float | None
    shortest: float | None


WAVES: dict[str, tuple[str, ...]] = {
    "exponential": ("correlation_length", "lay", "shortest"),
    "gaussian": ("correlation_length", "lay", "shortest"),
    "self-affine": ("hurst", "rolloff", "shortest"),
}


@typed
def generate_surface(
    grid: Grid,
    *,
    kind: RoughnessKind,
    rms: float,
    seed: int,
    skewness: float = 0.0,
    kurtosis: float = 3.0,
    periodic: bool = True,
    **waves: Unpack[Waves],
) -> Surface:
    """Generate a random surface with zero mean and a given rms height.

    The same arguments give the same surface on every machine, within rounding. The noise depends on
    seed and grid; use `refine` to get the same surface on a finer grid.

    Args:
        grid: Grid of the surface.
        kind: `exponential` or `gaussian` autocorrelation, or `self-affine` power spectrum.
        rms: Root mean square height Rq (m). The surface has exactly this value.
        seed: Seed of the noise, not negative.
        skewness: Skewness of the heights (dimensionless).
        kurtosis: Kurtosis of the heights (dimensionless), 3 for a normal distribution; at least
            skewness² + 1.1. Where filtered noise cannot have it, the provenance states the misfit
            of the wave amplitudes.
        periodic: Whether opposite edges of the surface match (bool).
        **waves: Parameters of the waves of this `kind`; None counts as left out.
            `correlation_length` (m; exponential, gaussian): length over which the autocorrelation
            falls to 10 %, or two such lengths, along and across the lay.
            `lay` (rad; exponential, gaussian): angle of the lay from the x axis, default 0.
            `hurst` (dimensionless; self-affine): Hurst exponent.
            `rolloff` (m; self-affine): wavelength above which the spectrum is constant, by default
            the size of the domain.
            `shortest` (m; all kinds): wavelength below which waves are left out.

    Returns:
        Surface on `grid`.

    Raises:
        SurfaceError: An argument does not belong to this kind or is out of range, or the grid
            cannot represent the waves.
        TypeError: An argument is unknown.
    """
    spectrum = spectrum_of_kind(kind, waves)
    if not (math.isfinite(rms) and rms > 0):
        raise SurfaceError(
            f"{rms:g} m is not a positive length; give the rms height, such as 0.1 um",
            argument="rms",
        )
    if seed < 0:
        raise SurfaceError(f"{seed} is negative; give a whole number from 0 up", argument="seed")
    if not possible(skewness, kurtosis):
        raise SurfaceError(
            f"no surface can be made with a skewness of {skewness:g} and a kurtosis of "
            f"{kurtosis:g}; kurtosis must be at least skewness² + {LEAST_KURTOSIS:g} = "
            f"{skewness**2 + LEAST_KURTOSIS:g}",
            argument="kurtosis",
        )
    spectrum.check(grid)
    height, made = _heights(grid, spectrum, seed, (skewness, kurtosis), periodic)
    height -= height.mean()
    height *= rms / math.sqrt(np.mean(height**2))
    provenance = {
        "source": "generated",
        **made,
        "kind": kind,
        "rms_m": float(rms),
        **spectrum.parameters(grid),
        "skewness": float(skewness),
        "kurtosis": float(kurtosis),
        "seed": int(seed),
        "noise": "PCG64 raw stream, inverse normal distribution",
        "periodicity": "periodic over the domain" if periodic else "none",
    }
    return Surface(height, grid, provenance)


def spectrum_of_kind(kind: RoughnessKind, waves: Waves) -> Spectrum:
    """The spectrum of `generate_surface`, whose errors it raises."""
    if kind not in WAVES:
        raise SurfaceError(
            f"{kind!r} is unknown; choose 'exponential', 'gaussian' or 'self-affine'",
            argument="kind",
        )
    for name, value in waves.items():
        if name not in Waves.__annotations__:
            raise TypeError(f"generate_surface() got an unexpected keyword argument {name!r}")
        # A lay of 0 is the default, so it is allowed for every kind.
        if name not in WAVES[kind] and value is not None and (name, value) != ("lay", 0):
            raise SurfaceError(f"does not belong to kind = {kind!r}; leave it out", argument=name)
    shortest = waves.get("shortest")
    if kind == "self-affine":
        if (hurst := waves.get("hurst")) is None:
            raise SurfaceError(
                "missing; a self-affine surface needs a Hurst exponent, such as 0.8",
                argument="hurst",
            )
        return SelfAffine(hurst, waves.get("rolloff"), shortest)
    if (beta := waves.get("correlation_length")) is None:
        raise SurfaceError(
            f"missing; kind = {kind!r} needs the length over which "
            "the autocorrelation falls to 10 %, such as 2 um",
            argument="correlation_length",
        )
    both = beta if isinstance(beta, tuple) else (beta, beta)
    return Autocorrelated(kind, both, waves.get("lay") or 0.0, shortest)


def _heights(
    grid: Grid, spectrum: Spectrum, seed: int, wanted: tuple[float, float], periodic: bool
) -> tuple[Array, dict[str, str | float]]:
    """Heights with the skewness and kurtosis `wanted` and any rms, and provenance of the method."""
    from scipy.fft import irfft2, rfft2

    larger = grid if periodic else _enlarged(grid, spectrum.longest)
    noise, H = white_noise(larger.nodes, seed), spectrum.amplitude(larger)
    # The first mode is the mean, not a wave. A grid of one node has no other mode.
    if not H.ravel()[1:].any() or grid.nodes == (1, 1):
        raise SurfaceError(
            f"grid: {grid.nodes[0]} x {grid.nodes[1]} nodes cannot represent any wave of this "
            "roughness; give more nodes"
        )
    made: dict[str, str | float] = {"method": "Hu and Tonder 1992"}
    z: Array = irfft2(H * rfft2(noise), s=larger.nodes)
    if wanted == (0.0, 3.0):
        return z[: grid.nodes[0], : grid.nodes[1]].copy(), made
    if (translated := filtered(noise, H, *wanted)) is not None:
        z, made["method"] = translated, "Hu and Tonder 1992, Johnson-translated noise"
    else:
        if (heights := distribution(z.size, *wanted)) is None:
            raise SurfaceError(
                f"this program cannot make heights with a skewness of {wanted[0]:g} "
                f"and a kurtosis of {wanted[1]:g}; give a larger kurtosis",
                argument="kurtosis",
            )
        z, made["amplitude_misfit"] = adjusted(z, heights)
        made["method"] = "Schreiber and Schmitz 1996, adjusted amplitudes"
    z = z[: grid.nodes[0], : grid.nodes[1]].copy()
    if not periodic:  # cropping changed skewness and kurtosis
        heights = distribution(z.size, *wanted)
        z = z if heights is None else in_order(heights, z)
    return z, made


def _enlarged(grid: Grid, longest: float) -> Grid:
    from scipy.fft import next_fast_len

    nx, ny = (
        next_fast_len(n + math.ceil(min(_MARGIN * longest, size) / h), real=True)
        for n, h, size in zip(grid.nodes, grid.spacing, grid.size, strict=True)
    )
    return Grid((nx, ny), grid.spacing)
