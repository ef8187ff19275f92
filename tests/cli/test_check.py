"""`restitution check`: what follows from a case without solving it."""

import re


def test_check_prints_the_derived_quantities_and_solves_nothing(cli, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text)
    status, said, warned = cli("check", tmp_path / "case.toml")
    assert status == 0
    for line in (
        r"reduced radius R\*\s+250\s+um",
        r"contact modulus E\*\s+112\s+GPa",
        r"reduced mass m\*\s+2.0551e-06\s+kg",
        r"yield indentation δ_y, smooth\s+27.661\s+nm",
        r"yield velocity V_y, smooth\s+0.010815\s+m/s",
        r"half width of the grid\s+18\s+um",
        r"contact radius there, smooth",
    ):
        assert re.search(line, said), line
    assert "The case is valid." in said
    assert not warned
    assert [p.name for p in tmp_path.iterdir()] == ["case.toml"]


def test_check_warns_of_a_contact_larger_than_the_grid(cli, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text.replace('"300 nm"', '"3 um"'))
    status, said, warned = cli("check", tmp_path / "case.toml")
    assert status == 0
    assert "with warnings" in said
    assert "the grid ends at 18 um" in warned


def test_check_says_that_a_run_far_beyond_the_grid_will_fail(cli, case_text, tmp_path):
    """Twice the half width of the grid is the limit."""
    for deepest, fails in (("3 um", False), ("6 um", True)):
        (tmp_path / "case.toml").write_text(case_text.replace('"300 nm"', f'"{deepest}"'))
        status, said, _ = cli("check", tmp_path / "case.toml")
        last = said.splitlines()[-1]
        assert status == 0
        assert last.startswith("A run will fail at the deeper depths" if fails else "Next: ")
    assert re.search(r"; use a grid of about 13\d um .* or stop at a smaller indentation\.$", last)


def test_check_prints_a_spacing_that_can_be_copied(cli, case_text, tmp_path):
    text = case_text.replace('["0.5 um", "0.6 um"]', '["0.078125 um", "0.15625 um"]')
    (tmp_path / "case.toml").write_text(text)
    assert "nodes of 0.078125 um x 0.15625 um" in cli("check", tmp_path / "case.toml")[1]
