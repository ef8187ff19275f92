"""What all exports share: the pairs at one velocity, comments, and templates.

DEM codes use one coefficient of restitution e for each pair, so an export is valid at one impact
velocity. The comments in an export give the origin of e, its error, and its values at other
velocities. Comments are plain ASCII without quotes, braces or line-continuation characters, so that
a name or title given by the user cannot end a comment.
"""

from __future__ import annotations

import re
import textwrap
import unicodedata
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.metadata import PackageNotFoundError, version

from jinja2 import Environment, PackageLoader, StrictUndefined

from restitution.dem.adhesion import adhesion_lines
from restitution.dem.pair_table import PairTable
from restitution.errors import CaseError, DomainError, one_line
from restitution.laws.law import FittedLaw, Law, Particle

FRICTION = 0.5  # coefficient of friction of pairs whose case gives none; users should replace it
STEPS = 5000  # number of time steps in a contact

_WIDTH = 98
_SIGNS = str.maketrans({'"': "'", "`": "'", "\\": "/", "&": "+", "{": "(", "}": ")", "$": "%"})
_PLAIN = str.maketrans("–—−‐‑’‘“”·×≈→µ", "-----''''.x~>u") | str.maketrans(
    {"±": "+/-", "≤": "<=", "≥": ">=", "…": "...", "ß": "ss", "⁄": "/"}
)


@dataclass(frozen=True)
class Pair:
    """A pair of particle types `i` ≤ `j` in an export.

    `restitution` is e at `velocity` (m/s), which is the impact velocity of the export.
    """

    i: int
    j: int
    first: Particle
    second: Particle
    law: Law
    velocity: float
    restitution: float

    @property
    def wall(self) -> bool:
        """Whether the second body is a wall."""
        return self.second.wall

    @property
    def friction(self) -> float:
        """The coefficient of friction of the case, or the placeholder `FRICTION`."""
        return FRICTION if self.law.friction is None else self.law.friction

    @property
    def contact_time(self) -> float:
        """Contact time (s) of an elastic impact at the velocity of the export."""
        return float(contact_time(self.law) * self.velocity**-0.2)

    @property
    def shear_modulus(self) -> float:
        """Mindlin's effective shear modulus G* (Pa): 1/G* = Σ 2 (2 − ν)(1 + ν)/E of both bodies."""
        bodies = self.first, self.second
        return 1 / sum(
            2 * (2 - b.poissons_ratio) * (1 + b.poissons_ratio) / b.youngs_modulus for b in bodies
        )

    @property
    def mindlin_stiffness(self) -> float:
        """Mindlin's tangential stiffness divided by the contact radius: 8 G* (Pa)."""
        return 8 * self.shear_modulus

    @property
    def twin(self) -> tuple[float, float]:
        """E (Pa) and ν of a material that, used for both bodies, gives the E* and G* of this pair.

        E and ν follow from E* = E/(2(1 − ν²)) and G* = E/(4(2 − ν)(1 + ν)). ν lies between the
        Poisson's ratios of the two materials of the pair.
        """
        k = self.shear_modulus / self.law.contact_modulus
        nu = min(max((1 - 4 * k) / (1 - 2 * k), 0.0), 0.5)
        return 2 * (1 - nu**2) * self.law.contact_modulus, nu

    def fitted(self, name: str) -> FittedLaw | None:
        """Return the force law `name` that was fitted to the law of the pair, or None."""
        return next((fit for fit in self.law.laws if fit.name == name), None)


@dataclass(frozen=True)
class Export:
    """An export of `table` to `code`.

    `velocity` (m/s) is the impact velocity at which the exported e of each pair holds. `lowest`
    is the smallest e that `code` reproduces. `ends` describes the condition at which `code` ends a
    contact. `constant` says whether e in `code` is the same at every velocity.
    """

    table: PairTable
    velocity: float
    code: str
    lowest: float
    ends: str
    constant: bool = True

    @cached_property
    def pairs(self) -> list[Pair]:
        """All pairs of the table with their e at `velocity`.

        Raises `CaseError` if e is below `lowest`. Raises `DomainError` if `velocity` is outside the
        computed velocities of a pair.
        """
        found, bodies = [], self.table.particles
        for i, j, law in self.table.pairs():
            e = law.at(self.velocity).restitution
            if e < self.lowest:
                raise CaseError(
                    f"{law.pair} {_failure(law, e)} at {self.velocity:.6g} m/s, but the export to "
                    f"{self.code} requires e of at least {self.lowest:g}; export at a higher "
                    "velocity, or use an adhesive contact model"
                )
            found.append(Pair(i, j, bodies[i - 1], bodies[j - 1], law, self.velocity, e))
        return found

    def header(self) -> list[str]:
        """Write the comment lines at the top of an exported file."""
        lines = [*self._origin(), "", "Types:"]
        lines += [f"  {k}: {particle}" for k, particle in enumerate(self.table.particles, 1)]
        for pair in self.pairs:
            lines += ["", *_about(pair, self.code)]
        return wrapped(lines)

    def summary(self, fragment: str) -> list[str]:
        """Write the comment lines at the top of a script that uses the file `fragment`.

        These comments are shorter than those of `header`, but contain all warnings.
        """
        lines = [*self._origin(), f"The comments in {fragment} give the origin of e."]
        for pair in self.pairs:
            lines += _warnings(pair)
        return wrapped(lines)

    def render(self, name: str, comments: str, **values: object) -> str:
        """Fill `comments` and `values` into the template of the file `name`.

        The template is `templates/NAME.j2`. It can also use `table`, `pairs` and `velocity` of the
        export, and the names and the filters of `_environment`.
        """
        template = _environment().get_template(f"{name}.j2")
        shared = {"table": self.table, "pairs": self.pairs, "velocity": self.velocity}
        return template.render(shared, comments=comments, **values)

    def _origin(self) -> list[str]:
        reason = (
            f"e is constant in {self.code}, but the e of the pairs depends on the velocity."
            if self.constant
            else f"at other velocities e in {self.code} differs from the e of the pairs."
        )
        return [
            f"Coefficients of restitution for {self.code}, written by restitution "
            f"{program_version()}.",
            f"They hold at the impact velocity {self.velocity:.6g} m/s only: {reason} Export again "
            "for another velocity.",
            f"End of a contact in {self.code}: {self.ends}",
            "SI units.",
        ]


def contact_time(law: Law, radius: float | None = None) -> float:
    """Contact time (s) of an elastic impact at 1 m/s.

    It is 2.87 (m*²/(R* E*² V))^⅕ with V = 1 m/s (Johnson 1985, eq. 11.24). `radius` (m),
    if given, replaces the R* of the law.
    """
    R = law.radius if radius is None else radius
    return float(2.87 * (law.mass**2 / (R * law.contact_modulus**2)) ** 0.2)


def density_of(particle: Particle) -> float:
    """The density of a sphere (kg/m³). Raises `CaseError` if the density is unknown."""
    if particle.density is None:
        raise CaseError(
            f"{particle}: has no density, but DEM needs one; give the density in the case"
        )
    return particle.density


def identifier(particle: Particle, number: int) -> str:
    """Make a name of letters, digits and `_`, ending in `number`, that every DEM code accepts."""
    word = (
        re.sub(r"[^A-Za-z0-9]+", "_", comment_text(particle.name))
        .strip("_")[:24]
        .rstrip("_")
        .lower()
        or "type"
    )
    return f"{word if word[0].isalpha() else f'p_{word}'}_{number}"


def commented(lines: Iterable[str], sign: str) -> str:
    """Turn `lines` into comments that begin with `sign`."""
    return "\n".join(f"{sign} {line}".rstrip() for line in lines)


def xml_comment(lines: Iterable[str]) -> str:
    """Make one XML comment of `lines`.

    Double hyphens are separated, because XML forbids them in comments.
    """
    safe = (re.sub("-(?=-)", "- ", line).rstrip() for line in lines)
    return "\n".join(["<!--", *safe, "-->"])


def comment_text(text: str) -> str:
    """Convert `text` to one line of ASCII that cannot end a comment.

    Greek letters are replaced by their names.
    """
    text = unicodedata.normalize("NFKD", one_line(text).translate(_PLAIN)).translate(_PLAIN)
    text = "".join(map(_ascii, text)).translate(_SIGNS)
    return text.replace("*/", "* /").replace("/*", "/ *").replace("??/", "?? /")


def number(value: float) -> str:
    """Format `value` in a notation that every code reads."""
    return f"{value:.9g}"


def program_version() -> str:
    """Return the installed version of this package, or "(version unknown)"."""
    try:
        return version("restitution")
    except PackageNotFoundError:  # the program is not installed
        return "(version unknown)"


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("restitution.dem"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"number": number, "comment_text": comment_text}
    environment.globals |= {
        "time_step": "the elastic contact time t_c = 2.87 (m*^2/(R* E*^2 V))^(1/5), for an "
        "accurate e",
        "contact_time": contact_time,
        "density_of": density_of,
        "identifier": identifier,
    }
    return environment


def _about(pair: Pair, code: str) -> list[str]:
    law, velocity = pair.law, pair.velocity
    p_y = "none (elastic)" if law.yield_pressure is None else f"{law.yield_pressure:.6g} Pa"
    title = textwrap.shorten(comment_text(law.title), 200, placeholder=" ...")
    lines = [
        f"Pair {pair.i} {pair.j}: {pair.first} and {pair.second}",
        *([f"  title: {title}"] if title else []),
        f"  e = {pair.restitution:.6g} +/- {law.at(velocity).error:.2g} at {velocity:.6g} m/s"
        + _elsewhere(law, velocity),
        f"  R* = {law.radius:.6g} m, E* = {law.contact_modulus:.6g} Pa, m* = {law.mass:.6g} kg",
        f"  yield pressure p_y: {p_y}; convention: {law.conventions.yield_pressure}",
        f"  end of contact assumed for e: {law.conventions.end_of_contact}",
        f"  the error of e includes: {law.conventions.restitution_error}",
        f"  elastic contact time: {pair.contact_time:.3g} s; a time step of 1/50 "
        "of this time changes e by at most 1 % in LAMMPS",
        f"  computed from {law.lowest:.4g} to {law.highest:.4g} m/s; nothing is extrapolated",
    ]
    return lines + adhesion_lines(law, velocity, code) + _warnings(pair)


def _warnings(pair: Pair) -> list[str]:
    lines, velocity = [], pair.velocity
    if not pair.law.at(velocity).resolved:
        lines.append(
            f"WARNING: unresolved at {velocity:.6g} m/s (pair {pair.i} {pair.j}): the grid was too "
            "coarse there, and the error of e may be too small"
        )
    if pair.restitution == 0:
        lines.append(
            f"WARNING: pair {pair.i} {pair.j} sticks at {velocity:.6g} m/s, but e = 0 does not "
            "keep the bodies in contact"
        )
    return lines + [f"WARNING: pair {pair.i} {pair.j}: {text}" for text in pair.law.warnings]


def _elsewhere(law: Law, velocity: float) -> str:
    """State e at half and at twice `velocity` (m/s), if the law includes these velocities."""
    said = []
    for V in (velocity / 2, velocity * 2):
        with suppress(DomainError):
            said.append(f"{law.at(V).restitution:.4g} at {V:.6g} m/s")
    return f" (but {', '.join(said)})" if said else ""


def _failure(law: Law, e: float) -> str:
    if e > 0:
        return f"has e = {e:.3g}"
    if law.sticks_everywhere:
        return "sticks (e = 0) at every computed velocity, so also"
    begins = law.sticks_below
    return "sticks (e = 0)" + ("" if begins is None else f" below {begins:.4g} m/s, so also")


def wrapped(lines: Iterable[str]) -> list[str]:
    """Convert `lines` to lines of ASCII of at most `_WIDTH` characters, for comments."""
    found = []
    for line in map(comment_text, lines):
        indent = " " * (len(line) - len(line.lstrip()) + 4)
        found += textwrap.wrap(line, _WIDTH, subsequent_indent=indent) or [""]
    return found


def _ascii(c: str) -> str:
    if c.isascii():
        return c
    if unicodedata.combining(c):
        return ""
    name = unicodedata.name(c, "")
    if name.startswith("GREEK"):
        word = name.split(" WITH ")[0].rsplit(" ", 1)[-1]
        return word.lower() if "SMALL" in name else word.capitalize()
    return "?"
