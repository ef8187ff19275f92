"""h* and H₀ from the hardness of indents."""

import numpy as np
import pytest

from restitution.errors import CaseError
from restitution.fit.indents import Indents, fit_size_effect, read_indents
from tolerance import approx

HEAD = "depth_nm,hardness_GPa\n"
ROWS = "".join(f"{h},{1.2 * (1 + 400 / h) ** 0.5}\n" for h in (60, 100, 200, 400, 1000, 3000))


def synthetic(length, seed, *, noise=0.05, points=20):
    random = np.random.default_rng(seed)
    depth = np.geomspace(60e-9, 3e-6, points)
    exact = 1e9 * np.sqrt(1 + length / depth)
    return Indents(depth, exact * (1 + noise * random.normal(size=points)), noise * exact)


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("length", [0.15e-6, 0.4e-6, 1.6e-6])
def test_the_interval_holds_the_length_in_18_of_20(length, known):
    inside = 0
    for seed in range(20):
        given = synthetic(length, seed)
        fit = fit_size_effect(given if known else Indents(given.depth, given.hardness))
        low, high = fit.interval("length")
        assert high < 3 * low
        assert fit.findings() == []
        inside += low <= length <= high
    assert inside >= 18


def test_exact_values_are_returned(tmp_path):
    (tmp_path / "h.csv").write_text(HEAD + ROWS)
    fit = fit_size_effect(read_indents(tmp_path / "h.csv"))
    assert fit.length == approx(400e-9, rel=1e-6)
    assert fit.hardness == approx(1.2e9, rel=1e-6)
    assert np.abs(fit.residuals).max() < 1e-7


def test_shallow_indents_and_unknown_lengths_are_said():
    depth = np.array([20e-9, 1.5e-6, 2e-6, 2.5e-6])
    hardness = 1e9 * np.array([2.0, 1.03, 1.0, 1.05])
    first, second = fit_size_effect(Indents(depth, hardness, 0.4 * hardness)).findings()
    assert "1 of 4 depths are below 50 nm" in first
    assert "h* is not identifiable" in second


def test_hardness_that_rises_with_depth_is_refused():
    depth = np.geomspace(1e-7, 1e-6, 6)
    with pytest.raises(CaseError, match=r"^hardness_GPa: rises with depth, from 1\.05 GPa to "):
        fit_size_effect(Indents(depth, 1e9 * np.linspace(1, 1.5, 6)))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (HEAD, "fewer than 4 different depths"),
        (HEAD + "100,1\n" * 5, "fewer than 4 different depths"),
        (HEAD + ROWS + "5,x\n", 'line 8: hardness_GPa = "x" is not a number from 0.001 to 1000'),
        (HEAD + ROWS + "-5,1\n", 'line 8: depth_nm = "-5" is not a number from 0.1 to'),
        ("depth_nm,H\n1,2\n", "the column hardness_GPa (hardness in GPa) is missing"),
    ],
)
def test_bad_tables_are_refused_in_one_line(tmp_path, text, words):
    (tmp_path / "h.csv").write_text(text)
    with pytest.raises(CaseError) as refused:
        read_indents(tmp_path / "h.csv")
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
