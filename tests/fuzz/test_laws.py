"""Random laws through everything that reads one: estimates, fits and exports.

`FUZZ` in the environment multiplies how many are tried.
"""

import csv
import io
import math
import os
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from restitution.dem.export import CODES, export
from restitution.dem.fits import fitted_laws
from restitution.errors import DomainError, RestitutionError
from restitution.laws.compact_fit import compact_fit
from restitution.laws.law import Law, LawPoint
from restitution.laws.law_files import law_rows
from restitution.laws.particle import Particle
from restitution.plots.law import law_figure
from restitution.plots.static import draw

FUZZ = float(os.environ.get("FUZZ", "1"))
CONVENTIONS = {
    "yield_pressure": "mean pressure",
    "end_of_contact": "separation",
    "indentation_zero": "first touch",
    "restitution": "sqrt(W_u/W_l)",
    "restitution_error": "numerical error",
}


def tried(times):
    """So many examples, times `FUZZ`; slow machines are no failure."""
    return settings(
        max_examples=max(1, round(times * FUZZ)),
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )


def spread(low, high):
    """Numbers whose logarithm is spread evenly."""
    return st.floats(math.log(low), math.log(high)).map(math.exp)


spheres = st.builds(
    Particle,
    name=st.text(max_size=12),
    radius=spread(1e-6, 0.1),
    youngs_modulus=spread(1e5, 1e12),
    poissons_ratio=st.floats(-0.9, 0.5),
    density=st.one_of(st.none(), spread(1, 1e5)),
)
walls = spheres.map(lambda body: replace(body, radius=None))
ratios = st.one_of(st.floats(-2, 1), st.sampled_from([-1.0, 0.0, 1.0, 1 - 1e-9, 1e-12]))


@st.composite
def one_point(draw, velocity, mass):
    ratio = draw(ratios)
    return LawPoint(
        velocity=velocity,
        restitution=math.sqrt(min(max(ratio, 0.0), 1.0)),
        error=draw(st.floats(0, 0.3)),
        ratio=ratio,
        loading_work=0.5 * mass * velocity**2,
        indentation=draw(spread(1e-12, 1e-3)),
        force=draw(st.one_of(st.sampled_from([0.0, -1e-9]), spread(1e-12, 1e3))),
        pull_off_force=draw(st.one_of(st.none(), st.floats(0, 1))),
        resolved=draw(st.one_of(st.just(True), st.booleans())),
    )


@st.composite
def laws(draw, most=14):
    """A law of two spheres, equal or not, or of a sphere and a wall, at up to `most` velocities."""
    first = draw(spheres)
    second = draw(st.one_of(st.just(first), spheres, walls))
    E = 1 / sum((1 - body.poissons_ratio**2) / body.youngs_modulus for body in (first, second))
    R = 1 / sum(0 if body.wall else 1 / body.radius for body in (first, second))
    mass = draw(spread(1e-18, 1))
    steps = draw(st.lists(spread(1.001, 10), max_size=most - 1))
    velocities = draw(spread(1e-6, 1)) * np.cumprod([1.0, *steps])
    adhesion = draw(st.one_of(st.just(0.0), spread(1e-6, 10)))
    law = Law(
        title=draw(st.text(max_size=20)),
        first=first,
        second=second,
        radius=R,
        contact_modulus=E,
        mass=mass,
        yield_pressure=draw(st.one_of(st.none(), spread(1e3, 1e11))),
        work_of_adhesion=adhesion,
        model={},
        conventions=CONVENTIONS,
        yield_velocity=None,
        smooth_sticking_velocity=None,
        sticks_below=None,
        points=tuple(draw(one_point(V, mass)) for V in velocities.tolist()),
    )
    law = replace(law, sticks_below=law.curve().begins())
    return replace(law, fit=compact_fit(law))


shares = st.floats(0, 1)
beyond = st.one_of(spread(1 + 2e-4, 1e3), spread(1e-3, 1 - 2e-4))


def between(law, share):
    return law.lowest ** (1 - share) * law.highest**share


@tried(40)
@given(laws(), st.lists(shares, min_size=1, max_size=5), beyond)
def test_estimates_are_restitutions_with_errors_and_end_with_the_law(law, inside, factor):
    for share in inside:
        point = law.at(min(max(between(law, share), law.lowest), law.highest))
        assert 0 <= point.restitution <= 1
        assert 0 <= point.error < math.inf
    with pytest.raises(DomainError, match="nothing is extrapolated"):
        law.at(factor * (law.highest if factor > 1 else law.lowest))


@tried(40)
@given(laws(), shares)
def test_estimates_are_continuous(law, share):
    """Beside a point and anywhere else; steepest where e begins, as a root."""
    tolerance = 1e-3 + 100 * law.curve().adhesion * 1e-9 / law.lowest**2
    for V in (*law.column("velocity"), between(law, share)):
        near = [V * (1 - 1e-10), V, V * (1 + 1e-10)]
        a, b, c = (law.at(min(max(v, law.lowest), law.highest)) for v in near)
        for one, other in ((a, b), (b, c)):
            e, f = one.restitution, other.restitution
            assert abs(e**2 - f**2) < tolerance
            slack = math.sqrt(2 * tolerance)  # of a root near zero
            assert abs(one.error - other.error) < 2 * slack


@tried(40)
@given(laws(), st.lists(shares, min_size=1, max_size=5), beyond)
def test_the_compact_fit_holds_between_the_resolved_velocities_only(law, inside, factor):
    if law.fit is None:
        return
    low, high = law.fitted_range
    assert (law.fit.lowest, law.fit.highest) == (low, high)
    for share in inside:
        V = min(max(low ** (1 - share) * high**share, low), high)
        assert 0 <= law.fit.restitution(V) <= 1
    assert math.isnan(law.fit.restitution(factor * (high if factor > 1 else low)))
    for row in law_rows(law):
        within = low <= row["velocity_m_per_s"] <= high
        assert math.isnan(row["compact_fit"]) != within


def exported(law, code, V):
    """The files, or none and why."""
    try:
        return export([law], code, V), ""
    except RestitutionError as error:
        return {}, str(error)


@tried(20)
@given(laws(), shares, beyond)
def test_exports_hold_what_was_computed_or_refuse(law, share, factor):
    V = min(max(between(law, share), law.lowest), law.highest)
    outside = factor * (law.highest if factor > 1 else law.lowest)
    for code in CODES:
        texts, refusal = exported(law, code, V)
        assert len(refusal.splitlines()) == (not texts)
        assert all(texts.values())
        with pytest.raises(RestitutionError):
            export([law], code, outside)
    texts, _ = exported(law, "yade", V)
    if not texts:
        return
    text = texts["restitution_yade.py"]
    of_laws = text.split("LAWS = {")[1].split("\n}")[0]
    velocities = [float(v) for v in re.findall(r"^ {8}\((\S+), \S+\),$", of_laws, re.MULTILINE)]
    assert velocities
    assert min(velocities) >= law.lowest * (1 - 1e-8)
    assert max(velocities) <= law.highest * (1 + 1e-8)


@tried(15)
@given(laws())
def test_the_table_has_no_fit_where_nothing_is_resolved(law):
    text = export([law], "csv", None)["restitution.csv"]
    low, high = law.fitted_range or (math.inf, -math.inf)
    for row in csv.DictReader(io.StringIO(text)):
        if row["compact_fit"]:
            assert low <= float(row["velocity_m_per_s"]) <= high


@tried(3)
@given(laws(most=4))
def test_fitted_laws_are_silent_where_nothing_is_resolved(law):
    fitted = replace(law, laws=fitted_laws(law))
    low, high = fitted.fitted_range or (math.inf, -math.inf)
    for fit in fitted.laws:
        assert 0 <= fit.rms <= fit.worst * (1 + 1e-12) <= 1 + 1e-9
        for point, e in zip(fitted.points, fit.restitution, strict=True):
            assert e is None or (0 <= e <= 1 and low <= point.velocity <= high)
    for line in draw(law_figure(fitted)).axes[0].lines:
        if line.get_linestyle() in ("-", "--"):
            drawn = line.get_xdata()[np.isfinite(np.asarray(line.get_ydata(), float))]
            assert all(low * (1 - 1e-9) <= V <= high * (1 + 1e-9) for V in drawn)
