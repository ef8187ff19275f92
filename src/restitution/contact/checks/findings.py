"""Findings: what a check says about a contact, with its remedy in terms of the case file."""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from restitution.display import counted, quantity
from restitution.errors import CaseError, RestitutionError, SurfaceError
from restitution.surfaces.refine import FACTORS

CLEANING = "roughness.outliers"  # key that removes spikes
# How to avoid a contact that is too large, for each table that prescribes the depths.
_STOPS = {
    "indentation": "stop at a smaller indentation",
    "load": "stop at a smaller load",
    "impact": "stop at a lower impact velocity",
}


_FINER = 0.99  # keeps a limit valid that is printed with four digits


@dataclass(frozen=True)
class Finding(ABC):
    """The result of a check: its values (SI units), and the text that they make.

    `error` is raised if the contact cannot be solved or would give meaningless results.
    """

    error: ClassVar[type[RestitutionError]] = CaseError

    @property
    def code(self) -> str:
        """Name of the finding: "few-nodes"."""
        return re.sub(r"(?<!^)([A-Z])", r"-\1", type(self).__name__).lower()

    @abstractmethod
    def text(self, prescribed: str = "indentation") -> str:
        """One line with the remedy; `prescribed` is the table that prescribes the depths."""


@dataclass(frozen=True)
class RoughnessAboveRadius(Finding):
    radius: float  # of the smaller particle
    peak: float  # highest point above the mean

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"radius: the particle of {1e6 * self.radius:.4g} um is smaller than its roughness, "
            f"whose highest peak is {1e6 * self.peak:.4g} um above the mean; check the units of "
            "the radius and of the roughness"
        )


@dataclass(frozen=True)
class ContactBeyondRadius(Finding):
    radius: float  # of the predicted contact
    indentation: float
    reduced_radius: float

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"the contact is predicted to reach {1e6 * self.radius:.4g} um from the centre at an "
            f"indentation of {_nm(self.indentation)}, beyond R* = "
            f"{1e6 * self.reduced_radius:.4g} um: stop earlier, or check the units of the depths "
            "and of the radius"
        )


@dataclass(frozen=True)
class PixelAboveContact(Finding):
    file: str
    pixel: float
    radius: float  # of the contact at this indentation
    indentation: float

    error = SurfaceError

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"{self.file}: one pixel ({_um(self.pixel)}) is larger than the contact radius at the "
            f"deepest indentation ({_um(self.radius)} at {_nm(self.indentation)}), so the scan "
            "does not resolve this contact; use a finer scan, a larger particle or a deeper contact"
        )


@dataclass(frozen=True)
class RangeUnresolved(Finding):
    spacing: float
    needed: float
    times: int  # power of two that divides the cells enough
    periodic: bool

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"grid.spacing: cells of {_nm(self.spacing)} are too coarse for the range of the "
            f'attraction; interface.adhesion = "cohesive" needs {_nm(self.needed)} or less (0.3 '
            "times the smaller of E* z0^2/w and sqrt(R* z0), with the work of adhesion w and the "
            f"equilibrium separation z0): multiply grid.refine by {self.times}"
            + ("" if self.periodic else ', or set interface.adhesion = "jkr"')
        )


@dataclass(frozen=True)
class PatchRangeUnresolved(Finding):
    spacing: float
    needed: float

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"grid.spacing: cells of {_nm(self.spacing)} are too coarse for the range of the "
            f"attraction of rough surfaces, the waves of which are in patches; set grid.spacing to "
            f"{_nm(_FINER * self.needed)} or less"
        )


@dataclass(frozen=True)
class ImpossibleSlope(Finding):
    slope: float
    limit: float
    file: str  # "" if the surface is not a scan

    error = SurfaceError

    def text(self, prescribed: str = "indentation") -> str:
        keys = "the unit of roughness.rms and the lengths of its waves"
        if self.file:
            keys = f"the unit of the heights in {self.file} and roughness.size"
        return (
            f"roughness: the rms slope is {self.slope:.3g}, and half-space theory means nothing "
            f"above {self.limit:g} (real surfaces have slopes below 2): check {keys}; heights in "
            "nm read as um are 1000 times too large"
        )


@dataclass(frozen=True)
class _AtEdge(Finding):
    indentation: float
    size: tuple[float, float]  # edge lengths of the grid
    needed: tuple[float, float]  # edge lengths of a grid that is large enough
    first_touch: tuple[float, float]
    off_centre: bool
    levelling: str | None  # of a measured surface, as is `scan`, its size
    scan: tuple[float, float] | None

    def needed_in_words(self) -> str:
        wide, long = self.needed
        long_too = "" if math.isclose(wide, long) else f" x {1e6 * long:.3g} um"
        return f"{1e6 * wide:.3g} um{long_too}"

    def advice(self, prescribed: str) -> str:
        """How to keep the contact inside the grid, for the end of a message."""
        x, y = self.first_touch
        at = f"x = {1e6 * x:.3g} um, y = {1e6 * y:.3g} um"
        where = f"the bodies touch first at {at}, off the centre; " * self.off_centre
        size, scan = self.needed_in_words(), self.scan
        if scan is None:
            return (
                f"{where}use a grid of about {size} (more grid.nodes or a larger grid.spacing) or "
                f"{_STOPS[prescribed]}"
            )
        remedies = {"tilt": 'roughness.detrend = "curvature", ', "curvature": ""}
        either = 'roughness.detrend = "tilt" or "curvature", '
        detrend = remedies.get(str(self.levelling), either)
        larger = "a larger scan, roughness.extend"
        if all(edge <= of for edge, of in zip(self.needed, scan, strict=True)):
            has = f"{1e6 * scan[0]:.3g} x {1e6 * scan[1]:.3g}"
            larger = f"a grid of about {size} (the scan has {has})"
        return f"{where}use {detrend}{larger}, a smaller radius, or {_STOPS[prescribed]}"


@dataclass(frozen=True)
class EdgeReached(_AtEdge):
    def text(self, prescribed: str = "indentation") -> str:
        wide, long = (1e6 * edge for edge in self.size)
        return (
            f"the contact reaches the edge of the {wide:.4g} um x {long:.4g} um grid at an "
            f"indentation of {_nm(self.indentation)}; {self.advice(prescribed)}"
        )


@dataclass(frozen=True)
class EdgePredicted(_AtEdge):
    gap: float  # smallest gap on the edge of the grid at first touch

    def text(self, prescribed: str = "indentation") -> str:
        return (
            "the contact is predicted to reach the edge of the grid: the gap there is "
            f"{_nm(self.gap)} at first touch, and the deepest indentation is "
            f"{_nm(self.indentation)}; {self.advice(prescribed)}"
        )


@dataclass(frozen=True)
class ContactBeyondGrid(Finding):
    radius: float
    indentation: float
    half_width: float  # of the grid
    whole_scan: bool

    def text(self, prescribed: str = "indentation") -> str:
        larger = "a larger scan, roughness.extend" if self.whole_scan else "more nodes"
        return (
            f"the contact is predicted to reach {_um(self.radius)} from the centre at an "
            f"indentation of {_nm(self.indentation)}, but the grid ends at "
            f"{_um(self.half_width)}: use {larger} or stop earlier"
        )


@dataclass(frozen=True)
class FewNodes(Finding):
    spacing: float  # the larger one of grid spacing and pixel
    radius: float
    needed: int  # nodes per radius

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"the contact radius of the smooth bodies, {_um(self.radius)} at the deepest "
            f"indentation, has only {self.radius / self.spacing:.2g} nodes at the spacing "
            f"{_um(self.spacing)} ({self.needed} are needed): use a finer grid or scan"
        )


@dataclass(frozen=True)
class NoHalfSpace(Finding):
    radius: float
    reduced_radius: float
    limit: float

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"the contact radius {_um(self.radius)} is {self.radius / self.reduced_radius:.4g} of "
            f"R*: the half-space approximation holds up to about {self.limit} R* (a tenth of the "
            "radius of two equal spheres)"
        )


@dataclass(frozen=True)
class FinerThanScan(Finding):
    spacing: float  # before refinement
    pixel: float

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"the grid spacing {_um(self.spacing)} is finer than the scan's pixel "
            f"{_um(self.pixel)}: roughness below the pixel is missing; use a finer scan"
        )


@dataclass(frozen=True)
class Spikes(Finding):
    file: str
    count: int
    height: float
    threshold: float  # standard deviations beyond which pixels are replaced

    error = SurfaceError

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"{self.file}: {counted(self.count, 'spike')} of up to {quantity(self.height, 'm')}: "
            f"{CLEANING} = {self.threshold:g} replaces spikes by their surroundings"
        )


@dataclass(frozen=True)
class TiltedScan(Finding):
    file: str
    explained: float  # fraction of the variance of the heights
    curved: bool

    def text(self, prescribed: str = "indentation") -> str:
        remedy = '"curvature"' if self.curved else '"tilt" or "curvature"'
        return (
            f"{self.file}: the scan is tilted (a plane explains {self.explained:.0%} of the "
            f"variance of its heights): set roughness.detrend = {remedy}"
        )


@dataclass(frozen=True)
class CurvedScan(Finding):
    file: str
    explained: float  # fraction of the variance that a plane leaves
    radius: float  # negative for a hollow
    reduced_radius: float

    def text(self, prescribed: str = "indentation") -> str:
        form = "hollow" if self.radius < 0 else "sphere"
        whole = self.reduced_radius
        effect = (
            "only a part of it would touch a flat body"
            if math.isinf(whole)
            else f"this adds to the shape of the particles, which R* = {quantity(whole, 'm')} "
            "contains"
        )
        return (
            f"{self.file}: the scan is curved like a {form} with a radius of "
            f"{quantity(abs(self.radius), 'm')} (which explains {self.explained:.0%} of the "
            f'variance of its heights), and {effect}: set roughness.detrend = "curvature"'
        )


@dataclass(frozen=True)
class SteepSurface(Finding):
    slope: float
    limit: float

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"the rms slope of the surface is {self.slope:.2g}: half-space theory holds for small "
            f"slopes, below about {self.limit}; check the units of the heights, or level or filter "
            "the surface"
        )


@dataclass(frozen=True)
class UnusualYieldPressure(Finding):
    ratio: float  # to the contact modulus
    low: float
    high: float

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"the yield pressure is {self.ratio:.2g} of the contact modulus E*, and usual values "
            f"are {self.low:g} to {self.high:g}: check the units of yield_pressure and "
            "youngs_modulus"
        )


@dataclass(frozen=True)
class OblongPixels(Finding):
    file: str
    x: float
    y: float

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"{self.file}: the pixels are {1e6 * self.x:.4g} x {1e6 * self.y:.4g} um, not square: "
            "if scan lines are missing in the file, the scan is stretched; check the size"
        )


@dataclass(frozen=True)
class CoarserThanScan(Finding):
    spacing: float
    pixel: float
    axis: str

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"the grid spacing {_um(self.spacing)} is coarser than the scan's pixel "
            f"{_um(self.pixel)} along {self.axis}: waves shorter than {_um(2 * self.spacing)} are "
            "left out; to keep them, make cells as small as the pixel (grid.refine)"
        )


@dataclass(frozen=True)
class SurfaceNotice(Finding):
    notice: str  # from the provenance: how the surface differs from its scan

    def text(self, prescribed: str = "indentation") -> str:
        return self.notice


@dataclass(frozen=True)
class PatchesUnresolved(Finding):
    few: int  # depths with too few nodes
    depths: int
    deepest: float
    needed: int  # nodes per patch

    def text(self, prescribed: str = "indentation") -> str:
        return (
            f"{self.few} of {self.depths} depths (up to {_nm(self.deepest)}) are not resolved "
            "(resolved is false): half of their contact is in patches of fewer than "
            f"{self.needed} nodes, and their results depend on the grid; refine the grid "
            "(grid.refine)"
        )


@dataclass(frozen=True)
class AdhesionUnresolved(Finding):
    few: int  # depths with too large cells
    depths: int
    first: float
    last: float
    spacing: float
    needed: float
    refine: int  # power of two that divides the cells enough

    def text(self, prescribed: str = "indentation") -> str:
        remedy = f"; set grid.refine = {self.refine}"
        if self.refine > FACTORS[-1]:
            remedy = (
                ", finer than grid.refine allows; leave out short waves (roughness.shortest), or "
                "use a smaller grid.spacing"
            )
        return (
            f"adhesion is not resolved at {self.few} of {self.depths} depths ({_nm(self.first)} to "
            f"{_nm(self.last)}; adhesion_resolved is false): cells of {_nm(self.spacing)} are too "
            "large for the adhesion of the asperities in contact, which needs "
            f"{_nm(self.needed)} or less{remedy}"
        )


@dataclass(frozen=True)
class PatchesBelowSizeEffect(Finding):
    material: str
    length: float  # h*
    depth: float  # of the Berkovich indent that is as sharp as the median of what yields
    velocity: float  # at which COR changes most; NaN without density
    restitution: float
    harder: float  # COR with the size effect

    def text(self, prescribed: str = "indentation") -> str:
        at = f" at {quantity(self.velocity, 'm/s')}" if self.velocity > 0 else ""
        return (
            f"the asperities that yield are as sharp as Berkovich indents of "
            f"{quantity(self.depth, 'm')}, and {self.material} is harder below h* = "
            f"{quantity(self.length, 'm')}: COR would be about {self.harder:.2g} instead of "
            f'{self.restitution:.2g}{at}; set interface.size_effect = "{_um(self.length)}", or '
            '"0 um" without this effect'
        )


def _um(length: float) -> str:
    return f"{1e6 * length:.3g} um"


def _nm(length: float) -> str:
    return f"{1e9 * length:.4g} nm"
