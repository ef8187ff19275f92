"""Random runs: they end, what is stored is possible and can be read, and no row claims too much.

The seed of a run is its number: `made(number)` is its case.
"""

import math
import random

import pytest
import tomli_w

from restitution.case.case_file import parse_case
from restitution.errors import DomainError, NotConvergedError, RestitutionError
from restitution.results.reader import RunResults
from restitution.results.writer import ResultsFolder
from restitution.runs.ensemble import run_realisations
from tolerance import approx

BLOCKS, RUNS = 8, 5  # blocks of so many runs, times FUZZ


def between(rng, low, high):
    """Drawn evenly in the logarithm."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def made(number):
    """The tables of run `number`: any material, surface and range on a small grid."""
    rng = random.Random(number)
    R, E, nu = between(rng, 3e-6, 1e-3), between(rng, 1e6, 4e11), rng.uniform(0.0, 0.5)
    E_star, R_star = E / (2 * (1 - nu**2)), R / 2
    body = {
        "radius": f"{R} m",
        "youngs_modulus": f"{E} Pa",
        "poissons_ratio": nu,
        "density": "2500 kg/m^3",
    }
    nodes = [rng.choice([16, 25, 32]), rng.choice([16, 25, 32])]
    h = R * between(rng, 1e-4, 5e-3)
    interface = {"yield_pressure": "elastic"}
    if rng.random() < 0.8:
        interface["yield_pressure"] = f"{E_star * between(rng, 1e-4, 0.2)} Pa"
        interface["plasticity"] = rng.choice(["equilibrium", "equilibrium", "truncated"])
    if rng.random() < 0.25:  # a_c = (9πwR*²/(8E*))^⅓ in one to six cells
        w = (h * rng.uniform(1, 6)) ** 3 * 8 * E_star / (9 * math.pi * R_star**2)
        interface["work_of_adhesion"] = f"{w} J/m^2"
        if rng.random() < 0.5:
            interface["detachment"] = rng.choice(["pohrt-popov", "crack-closure"])
    else:
        interface["work_of_adhesion"] = "0 J/m^2"
    case = {"first": body, "interface": interface, "grid": {"nodes": nodes, "spacing": f"{h} m"}}
    deep = (min(nodes) * h * between(rng, 0.05, 0.4)) ** 2 / R_star
    if rng.random() < 0.75:
        kind = rng.choice(["gaussian", "exponential", "self-affine"])
        rough = {"kind": kind, "rms": f"{deep * between(rng, 1e-3, 3)} m"}
        rough["seed"] = rng.randrange(1000)
        if kind == "self-affine":
            rough |= {"hurst": rng.uniform(0.1, 1), "rolloff": f"{h * rng.uniform(5, 30)} m"}
        else:
            rough["correlation_length"] = f"{h * between(rng, 1, 20)} m"
        if rng.random() < 0.2:
            rough["realisations"] = 2
        case["roughness"] = rough
    if "0 J/m^2" not in interface.values() and number % 4:
        case["total_error"] = False  # with adhesion it takes most of the time
    depths = sorted(deep * between(rng, 0.01, 1) for _ in range(rng.choice([1, 3])))
    case |= rng.choice(
        [
            {"indentation": {"values": [f"{d} m" for d in depths]}},
            {"load": {"values": [f"{E_star * math.sqrt(R_star * d) * d} N" for d in depths]}},
            {
                "impact": {
                    "velocity": [
                        f"{math.sqrt(E_star * math.sqrt(R_star * d) * d * d / (2500 * R**3))} m/s"
                        for d in depths
                    ]
                }
            },
        ]
    )
    return case


def check(row, case):
    """What holds of every row, whatever the contact."""
    e, total = row["restitution"], row["total_error"]
    if math.isnan(e):  # no impact has this depth
        assert row["loading_work_J"] <= 0
        return
    assert 0 <= e <= 1
    assert row["residual"] <= 1e-8
    known = min(row["restitution_error"], max(e, 1 - e))  # no error is more than COR can be off
    assert math.isnan(total) or known <= total * (1 + 1e-9)
    assert math.isnan(total) or total <= max(e, 1 - e)
    if not row["resolved"]:
        assert total != 0
        assert math.isnan(total) or total > 1e-3 or e in (0, 1)
    lost = row["loading_work_J"] - row["unloading_work_J"]
    if case.interface.adhesive_energy == 0 and row["loading_work_J"] > 0:
        assert -1e-6 <= lost / row["loading_work_J"] <= 1
        if math.isinf(case.yielding().hardness):
            assert e == approx(1, rel=1e-9)
        else:
            largest = row["force_N"] / row["contact_area_m2"]
            assert largest <= case.yielding().hardness * (1 + 1e-6)


def run(number, folder):
    """Run it, check what is stored, and say how it ended."""
    text = tomli_w.dumps(made(number))
    case = parse_case(text)
    out = ResultsFolder(folder)
    status = "complete"
    try:
        run_realisations(case, text, folder.parent, out)
    except (DomainError, NotConvergedError):
        status = "failed"
        if not folder.exists():
            return "nothing stored"
    stored = RunResults(folder)
    summary = stored.summary
    assert summary["status"] == status
    rows = stored.curve.rows
    assert rows
    for row in rows:
        check(row, case)
    flagged = " ".join(summary["warnings"])
    if any(not row["resolved"] for row in rows):
        assert "not resolved" in flagged
    assert stored.dataset.sizes["indentation_max"] == len(rows)
    return status


@pytest.mark.parametrize("block", range(BLOCKS))
def test_random_runs(block, fuzz, tmp_path, within, plainly_refused):
    ends = []
    for k in range(round(RUNS * fuzz)):
        number = BLOCKS * k + block
        try:
            with within(120):
                ends.append(run(number, tmp_path / str(number)))
        except RestitutionError as error:
            ends.append("refused" if plainly_refused(error) else str(error)[:1000])
        except Exception as error:
            raise AssertionError(f"run {number}: {error!r}"[:2000]) from error
    assert set(ends) <= {"complete", "failed", "nothing stored", "refused"}, (block, ends)
    assert "complete" in ends
