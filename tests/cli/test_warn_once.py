"""A warning that is repeated with other numbers is printed once and counted."""

from restitution.cli.console import warn_once


def warned(capsys, *messages):
    with warn_once() as warn:
        for message in messages:
            warn(*message)
    return capsys.readouterr().err.splitlines()


def test_repetitions_are_counted(capsys):
    assert warned(
        capsys,
        ("the edge is 1.5 um away",),
        ("the scan is tilted",),
        ("the edge is 2e-07 um away",),
        ("the edge is 30 um away",),
    ) == [
        "Warning: the edge is 1.5 um away",
        "Warning: the scan is tilted",
        'Warning: this warning was repeated 2 times with other numbers: "the edge is 1.5 um away"',
    ]


def test_subjects_are_named(capsys):
    long = "a warning" + 10 * " that is long"
    lines = warned(capsys, *((long, name) for name in ("glass", "steel", "zinc")))
    assert lines[0] == f"Warning: glass: {long}"
    assert lines[1].startswith("Warning: this warning was repeated 2 times (steel, zinc): ")
    assert lines[1].endswith('…"')
    assert len(lines) == 2


def test_of_many_subjects_the_first_six_are_named(capsys):
    lines = warned(capsys, *(("tilted", f"pair {k}") for k in range(10)))
    assert lines[1] == (
        "Warning: this warning was repeated 9 times (pair 1, pair 2, pair 3, pair 4, pair 5, "
        'pair 6 and 3 more): "tilted"'
    )


def test_a_run_that_fails_on_every_surface_says_why_once(cli, case_text, tmp_path):
    text = case_text.replace("seed = 1", "seed = 1\nrealisations = 3")
    text = text.replace('to = "300 nm"', 'to = "3 um"').replace("steps = 4", "steps = 2")
    (tmp_path / "case.toml").write_text(text)
    status, _, said = cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert status == 0
    assert said.count("the contact reaches the edge of the 36 um x 38.4 um grid") == 1
    assert "this warning was repeated 2 times with other numbers" in said
