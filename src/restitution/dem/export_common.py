"""What all exports share: the pairs at one velocity, their notes, and templates."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property, partial
from importlib.metadata import PackageNotFoundError, version
from operator import itemgetter

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from restitution.dem.notes import about, grouped_warnings
from restitution.dem.own_laws import OwnLaws, closest
from restitution.dem.own_laws import constant as constant_law
from restitution.dem.pair import (
    FRICTION,
    ExportedPair,
    adhesive_time,
    contact_time,
    pull_off_force,
)
from restitution.dem.pair_table import PairTable
from restitution.dem.text import (
    comment_text,
    commented,
    identifier,
    number,
    numbers,
    real,
    wrapped,
    xml_safe,
)
from restitution.dem.units import SI, Units
from restitution.display import quantity
from restitution.errors import CaseError
from restitution.laws.law import Law
from restitution.laws.particle import Particle

STEPS = 5000  # number of time steps in a contact

# Measured in LAMMPS, LIGGGHTS, YADE and Kratos (evidence/codes/time_steps.csv).
ACCURACY = (
    "Then e of 0.5 and more is within 1 %; e of 0.2 needs 1/200. With 1/10, 0.5 becomes 0.476 to "
    "0.519."
)
NOT_RUN = "Then e of 0.5 and more is within 1 % in LAMMPS; {} was not run."
SCRIPT = "match_velocity.py"
_ROUNDS = 6  # largest number of runs of the simulation
_TOLERANCE = 0.005  # change of e below which the script stops
_SAMPLES = 4  # number of table intervals between two neighbouring computed velocities
_AGAIN = "Export again for another velocity."


@dataclass(frozen=True)
class Export:
    """An export of `table` to `code`, at the impact velocity `velocity` (m/s).

    `lowest` is the smallest e that `code` reproduces. `ends` says when `code` ends a contact, and
    `constant` whether its e is the same at every velocity. `setting` tells how to set e of pairs of
    spheres if all laws are those of walls; empty if `code` does not need them. With `whole`, the
    files contain e at every computed velocity; with `adhesive`, also the pull-off force. `steps` is
    the number of time steps in a contact with which `code` has the `accuracy`, in words; 0 if it
    chooses its time steps itself. `own` are the laws e(V) that
    `code` has. Numbers of the files that are
    not comments are in `units`.
    """

    table: PairTable
    velocity: float
    code: str
    lowest: float
    ends: str
    constant: bool = True
    setting: str = ""
    whole: bool = False
    adhesive: bool = False
    steps: int = 50
    accuracy: str = ACCURACY
    units: Units = SI
    own: OwnLaws = constant_law

    @cached_property
    def pairs(self) -> list[ExportedPair]:
        """All pairs, with e at `velocity`. Raises `CaseError` below `lowest`, and `DomainError`."""
        pairs, bodies = [], self.table.particles
        for i, j, law in self.table.pairs():
            e = law.at(self.velocity).restitution
            if e < self.lowest:
                raise CaseError(
                    f"{law.pair} {_failure(law, e)} at {self.velocity:.6g} m/s, but the "
                    f"export to {self.code} requires e of at least {self.lowest:g}; export at a "
                    "higher velocity, or use an adhesive contact model"
                )
            pairs.append(ExportedPair(i, j, bodies[i - 1], bodies[j - 1], law, self.velocity, e))
        return pairs

    @property
    def notes_name(self) -> str:
        """Name of the file with the origin and the conventions of e."""
        return f"restitution_{self.code.lower()}.txt"

    def notes(self) -> dict[str, str]:
        """The file `notes_name`: types, origin, conventions and warnings; its name and text."""
        reason = (
            f"e is constant in {self.code}, but the e of the pairs depends on the velocity."
            if self.constant
            else f"at other velocities e in {self.code} differs from the e of the pairs."
        )
        lines = [
            self._title(),
            *([] if self.whole else [f"They hold at this velocity only: {reason} {_AGAIN}"]),
            f"End of a contact in {self.code}: {self.ends}",
            "This file is in SI units.",
            *self._about_files(),
            self._time_step(),
            "",
            *self._ending(),
            "",
            "Types:",
            *(f"  {k}: {particle}" for k, particle in enumerate(self.table.particles, 1)),
            *about(self.pairs, self.code, pulls=self.adhesive),
            *(["", "e(V) of the law and of the files:", *self._closest()] if self._fits else []),
        ]
        return {self.notes_name: "\n".join(wrapped(lines)) + "\n"}

    def render(self, name: str, sign: str = "#", **values: object) -> str:
        """Fill `values` into `templates/NAME.j2`.

        The template also has `table`, `pairs`, `velocity` and `units`, what `_environment` holds,
        `u(value, unit)` for numbers in `units`, and two comments whose lines begin with `sign`:
        `head`, and `ending` with the time step and all warnings.
        """
        template = _environment().get_template(f"{name}.j2")
        shared = {
            "table": self.table,
            "pairs": self.pairs,
            "velocity": self.velocity,
            "units": self.units,
            "u": lambda value, unit: number(self.units.of(value, unit)),
        }
        return template.render(shared, head=self.head(sign), ending=self.ending(sign), **values)

    def matching_script(self, command: str, fragment: str, matched: str) -> str:
        """The script that finds one e for each pair of types in a simulation, which `command` runs.

        `fragment` is the exported file with the pairs, and `matched` the file that the script
        writes.
        """
        return self.render(
            SCRIPT,
            code=self.code,
            command=command,
            fragment=fragment,
            matched=matched,
            lowest=self.lowest,
            points=partial(law_points, lowest=self.lowest),
            rounds=_ROUNDS,
            tolerance=_TOLERANCE,
        )

    def friction_note(self, sign: str = "", tangential: str = "") -> str:
        """The origin of the coefficients of friction, as comments that begin with `sign` if given.

        `tangential` describes the tangential settings of pairs whose cases state a coefficient.
        """
        pairs = self.pairs
        missing = [f"{pair.i} {pair.j}" for pair in pairs if pair.law.friction is None]
        stated = f"The coefficients of friction are those of the cases. {tangential}"
        if len(missing) == len(pairs):
            stated = (
                f"Friction {FRICTION} is a placeholder: friction is not computed here; set your "
                "value."
            )
        elif missing:
            stated = (
                f"Friction {FRICTION} of the pairs {', '.join(missing)} is a placeholder: their "
                "cases have no interface.friction; set your value. The other coefficients of "
                f"friction are those of the cases. {tangential}"
            )
        return commented(wrapped([stated.strip()]), sign) if sign else stated.strip()

    def head(self, sign: str) -> str:
        """The comment at the top of each exported file."""
        lines = [
            self._title(),
            *self._about_files(),
            f"Types, errors, origin and conventions of e: {self.notes_name}",
        ]
        if self._ending():
            lines.append("WARNINGS are at the end of this file.")
        return commented(wrapped(lines), sign)

    def lines(self) -> list[str]:
        """Title, file of notes and warnings, for files without comments."""
        return list(
            map(
                comment_text,
                [
                    self._title(),
                    *self._about_files(),
                    f"Types, errors, origin: {self.notes_name}",
                    self._time_step(),
                    *self._ending(),
                ],
            )
        )

    def ending(self, sign: str) -> str:
        """The comment at the end of each exported file: its time step, and all warnings."""
        return commented(wrapped([self._time_step(), *self._ending()]), sign)

    @property
    def _fits(self) -> bool:
        return not (self.whole or self.adhesive)

    def _closest(self) -> list[str]:
        """How far e(V) of the files, and of the closest law of the code, is off for each pair."""
        said = [(pair, closest(pair, self.code, self.own)) for pair in self.pairs]
        return [f"  {pair.i} {pair.j}: {text}." for pair, text in said if text]

    def closest_note(self, sign: str) -> str:
        """How close the laws of the code come to e(V) of the worst pair, as comments."""
        pairs = [pair for pair in self.pairs if closest(pair, self.code, self.own)]
        if not pairs:
            return ""
        worst = max(pairs, key=lambda pair: self.own(pair)[0].misfit(pair))
        others = f" (other pairs: {self.notes_name})" if len(pairs) > 1 else ""
        text = f"Pair {worst.i} {worst.j}: {closest(worst, self.code, self.own)}{others}."
        return commented(wrapped([text]), sign)

    def _title(self) -> str:
        at = "at the computed velocities" if self.whole else f"at {self.velocity:.6g} m/s"
        return (
            f"Coefficients of restitution for {self.code} {at}, "
            f"written by restitution {program_version()}"
        )

    def _about_files(self) -> list[str]:
        """Units, and the size of coarse-grained particles."""
        size, said = self.table.size, []
        if self.units is not SI:
            said.append(
                f"The commands are in LAMMPS units {self.units.name} ({self.units.names}), the "
                "comments in SI units."
            )
        if size != 1:
            said.append(
                f"Coarse-grained: particles are {size:g} times as large as those for which e was "
                "computed, with the same density. e(V) is that of the real size. Forces are "
                f"{size**2:.4g} times the real ones, masses {size**3:.4g} times."
            )
        return said

    def _time_step(self) -> str:
        time, pair, when = min(map(self._shortest, self.pairs), key=itemgetter(0))
        shortest = f"the shortest contact ({time:.3g} s, pair {pair.i} {pair.j} {when})"
        if self.steps:
            step = time / self.steps
            own = (
                f" ({self.units.of(step, 's'):.3g} in these units)" if self.units.time != 1 else ""
            )
            limit = f"at most {step:.3g} s{own}, 1/{self.steps} of {shortest}"
        else:
            limit = f"chosen by the code for {shortest}"
        return f"Time step: {limit}. {self.accuracy}"

    def _shortest(self, pair: ExportedPair) -> tuple[float, ExportedPair, str]:
        """The shortest duration (s) that counts for the time step, and when it occurs."""
        law = pair.law
        time = float(contact_time(law) * law.highest**-0.2)
        when = f"at {law.highest:.4g} m/s, the highest velocity of its law"
        if self.adhesive and not self.whole and law.work_of_adhesion > 0:
            adhesive = adhesive_time(law, pull_off_force(law, self.velocity))
            if adhesive < time:
                return adhesive, pair, "when its attraction takes hold"
        return time, pair, when

    def _ending(self) -> list[str]:
        return [*self.unset(), *grouped_warnings(self.pairs, holds=self.adhesive)]

    def unset(self) -> list[str]:
        """The pairs of spheres without a law, and how the user sets their e."""
        return unset_pairs(self.table, self.code, self.setting)


def law_points(law: Law, lowest: float) -> list[tuple[float, float]]:
    """e of `law`, at least `lowest`, against velocity (m/s), fine enough to be linear between."""
    V = law.column("velocity")
    fine = np.interp(
        np.arange((V.size - 1) * _SAMPLES + 1) / _SAMPLES, np.arange(V.size), np.log(V)
    )
    return [(v, max(law.at(v).restitution, lowest)) for v in np.exp(fine).tolist()]


def unset_pairs(table: PairTable, code: str, setting: str) -> list[str]:
    """The pairs of spheres without a law, and how to set their e (`Export.setting`)."""
    if not setting or not table.walls_only:
        return []
    pairs = [f"{i} {j}" for i, j in table.missing_spheres()]
    some, names = ("s", "e_1_1, ...") if len(pairs) > 1 else ("", "e_" + pairs[0].replace(" ", "_"))
    return [
        f"No law is given for the pair{some} {', '.join(pairs)}, whose spheres can touch, and "
        f"{code} needs e for every pair: {setting.replace('NAMES', names)}"
    ]


def density_of(particle: Particle) -> float:
    """The density of a sphere (kg/m³). Raises `CaseError` if it is unknown."""
    if particle.density is None:
        raise CaseError(
            f"{particle}: has no density, but DEM needs one; give the density in the case"
        )
    return particle.density


def program_version() -> str:
    """The installed version of this package, or "(version unknown)"."""
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
    environment.filters |= {
        "number": number,
        "comment_text": comment_text,
        "numbers": numbers,
        "real": real,
        "quantity": quantity,
        "xml_safe": xml_safe,
    }
    environment.globals |= {
        "time_step": "the elastic contact time t_c = 2.87 (m*^2/(R* E*^2 V))^(1/5), for an "
        "accurate e",
        "contact_time": contact_time,
        "density_of": density_of,
        "identifier": identifier,
    }
    return environment


def _failure(law: Law, e: float) -> str:
    if e > 0:
        return f"has e = {e:.3g}"
    if law.sticks_everywhere:
        return "sticks (e = 0) at every computed velocity, so also"
    if law.sticks_below is None:
        return "sticks (e = 0)"
    return f"sticks (e = 0) below {law.sticks_below:.4g} m/s, so also"
