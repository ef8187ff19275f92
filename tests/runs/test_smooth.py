import numpy as np

from points import point
from restitution import Body, Contact, Grid, Pair, smooth
from restitution.contact.plasticity.bound import ConstantBound
from restitution.contact.plasticity.truncated import Truncated
from restitution.runs.smooth import smooth_curve
from restitution.theory import FirstYield, Hertz
from tolerance import approx

STEEL = Body(500e-6, 210e9, 0.25, density=7850)
PAIR = Pair(STEEL, STEEL)
P_Y = 750e6
YIELD = float(FirstYield(PAIR.radius, PAIR.contact_modulus, P_Y).indentation)
GRID = Grid((8, 8), (1e-6, 1e-6))


def rows(*depths, work=1e-12):
    return [point(indentation=depth, loading_work=work) for depth in depths]


def values(*arguments, **options):
    return {name: found[1] for name, found in smooth_curve(*arguments, **options).items()}


def test_it_follows_the_table_of_smooth_contact():
    """COR against x = δ/δ_y agrees with docs/method.md on any grid of the case."""
    for x, cor in [(2, 0.9379), (6, 0.752), (16, 0.6010), (36, 0.496)]:
        found = values(
            Contact(PAIR, smooth(GRID), plasticity=ConstantBound(P_Y)),
            rows(x * YIELD),
        )
        assert found["smooth_indentation"][-1] == approx(x * YIELD)
        assert found["smooth_restitution"][-1] == approx(cor, rel=3e-3)


def test_it_spans_the_depths_and_the_velocities_of_the_run():
    work = 1e-13
    found = values(
        Contact(PAIR, smooth(GRID), plasticity=ConstantBound(P_Y)),
        rows(1e-8, 3e-7, work=work),
    )
    assert found["smooth_indentation"].min() <= 1e-8
    assert found["smooth_indentation"].max() == 3e-7
    least = np.sqrt(2 * work / PAIR.mass)
    assert found["smooth_impact_velocity"].min() <= least * (1 + 1e-9)
    assert (np.diff(found["smooth_restitution"]) <= 0).all()


def test_up_to_yield_it_is_hertz():
    contact = Contact(PAIR, smooth(GRID))
    found = values(contact, rows(1e-8, 3e-7))
    assert (found["smooth_restitution"] == 1).all()
    assert found["smooth_force"] == approx(
        Hertz(PAIR.radius, PAIR.contact_modulus).force(found["smooth_indentation"])
    )


def test_without_density_there_is_no_velocity():
    light = Body(500e-6, 210e9, 0.25)
    found = values(
        Contact(Pair(light, light), smooth(GRID), plasticity=ConstantBound(P_Y)),
        rows(1e-7),
    )
    assert np.isnan(found["smooth_impact_velocity"]).all()


def test_the_truncated_model_has_thornton_and_ning():
    assert smooth_curve(Contact(PAIR, smooth(GRID), plasticity=Truncated(P_Y)), rows(1e-7)) == {}
