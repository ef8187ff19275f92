"""Bad input: one clear line that names the key or file and the remedy, and nothing lost."""

import os
import time

import pytest


@pytest.fixture
def refused_case(refused, case_text, tmp_path):
    """Refusal of the small case with parts of its text replaced."""

    def call(*replacements, verb="run"):
        text = case_text
        for old, new in replacements:
            assert old in text
            text = text.replace(old, new, 1)
        (tmp_path / "case.toml").write_text(text)
        out = () if verb == "check" else ("-o", tmp_path / "out")
        message = refused(verb, tmp_path / "case.toml", *out)
        assert not (tmp_path / "out").exists()
        return message

    return call


@pytest.mark.parametrize(
    ("old", "new", "key", "remedy"),
    [
        ("radius =", "radus =", "first.radus", 'did you mean "radius"?'),
        ("[grid]", "[gird]", "gird", 'did you mean "grid"?'),
        ("seed = 1", "seed = 1\nxyz = 1", "roughness.xyz", "known keys: kind, rms"),
        ("seed = 1", "seed = 1\nhurst = 0.8", "roughness.hurst", "does not belong to kind"),
        (
            "seed = 1",
            "seed = 1\nlay = 30",
            "roughness.lay",
            '30 has no unit; write for example "30 deg"',
        ),
        ("seed = 1", 'seed = 1\nlay = "30 deg"', "roughness.lay", "has no lay; give two"),
        (
            "seed = 1",
            "seed = 1\nskewness = 2\nkurtosis = 3",
            "roughness.kurtosis",
            "at least skewness",
        ),
        (
            "seed = 1",
            'seed = 1\nshortest = "1 um"\nbelow_grid = "omit"',
            "roughness.shortest",
            "1.2 to 38.4 um",
        ),
        ('"gaussian"', '"self-affine"', "roughness.correlation_length", "does not belong to kind"),
        ('correlation_length = "2 um"', "", "roughness.correlation_length", "missing"),
        ('"500 um"', "500", "first.radius", '500 has no unit; write for example "0.25 um"'),
        ('"500 um"', '"500"', "first.radius", "has no unit"),
        ('"500 um"', '"500 kg"', "first.radius", '"500 kg" is not a length'),
        ('"500 um"', '"500 furlonx"', "first.radius", "an unknown unit"),
        ('"500 um"', '"9**9**9 um"', "first.radius", "is not one number followed by a unit"),
        ('"500 um"', '"nan um"', "first.radius", "is not one number followed by a unit"),
        ('"500 um"', '"1e999 um"', "first.radius", "not a finite number"),
        ('"210 GPa"', '"-210 GPa"', "first.youngs_modulus", "greater than zero"),
        ('"210 GPa"', '"0 GPa"', "first.youngs_modulus", "greater than zero"),
        ('"750 MPa"', '"-1 MPa"', "interface.yield_pressure", "greater than zero"),
        ("ratio = 0.25", "ratio = 0.51", "first.poissons_ratio", "less than or equal to 0.5"),
        ("ratio = 0.25", "ratio = -1.0", "first.poissons_ratio", "greater than -1"),
        ("ratio = 0.25", "ratio = nan", "first.poissons_ratio", "less than or equal to 0.5"),
        ("[72, 64]", "0", "grid.nodes", "greater than 0"),
        ("[72, 64]", "[72, 0]", "grid.nodes", "greater than 0"),
        ("[72, 64]", "[72, 64, 2]", "grid.nodes", "a list of two"),
        ("[72, 64]", "72.5", "grid.nodes", "a whole number"),
        ("[72, 64]", "100_000", "grid.nodes", "more than a grid may have (134217728 in all)"),
        ("[72, 64]", "1" * 4000, "grid.nodes", "more than a grid may have"),
        ("[72, 64]", "1" * 5000, "case.toml", "a number with thousands of digits; correct it"),
        ("seed = 1", f"seed = {2**63}", "roughness.seed", "less than"),
        ("seed = 1", 'seed = 1\n"a\\nb" = 2', "roughness.a\\nb", "unknown key"),
        ("seed = 1", 'seed = 1\nsecond = "steel"', "roughness.second", "above the first [table]"),
        ("ratio = 0.25", 'ratio = "0.25"', "first.poissons_ratio", '"0.25" should be a number'),
        ("ratio = 0.25", "ratio = true", "first.poissons_ratio", "true should be a number"),
        ('"500 um"', '"500 km"', "first.radius", "outside the plausible range (1e-12 to 1000 m)"),
        ('"500 um"', '"500 fm"', "first.radius", "check the unit"),
        ('"750 MPa"', '"750 mPa"', "interface.yield_pressure", "did you mean MPa?"),
        ('"750 MPa"', '"750 mpa"', "interface.yield_pressure", "did you mean MPa?"),
        ('"500 um"', f'"{"x" * 500}"', "first.radius", f'"{"x" * 59}…" is not one number'),
        ('"500 um"', '"5\\n\\u001b[31m um"', "first.radius", r'"5\n\x1b[31m um" is not one number'),
        ('yield_pressure = "750 MPa"', "", "interface.yield_strength", "is missing, and so are"),
        (
            '"750 MPa"',
            '"elastic"\nplasticity = "truncated"',
            "interface.plasticity",
            "give a pressure",
        ),
        ("steps = 4", "steps = 1", "indentation", "use `values = [...]`"),
        ("steps = 4", "steps = 10_001", "indentation.steps", "less than or equal to 10000"),
        ('to = "300 nm"', 'to = "20 nm"', "indentation", "use `values = [...]`"),
        ("steps = 6", "steps = 10_001", "unloading.steps", "less than or equal to 10000"),
        ("curves = 2", "curves = 10_001", "unloading.curves", "less than or equal to 10000"),
        ("curves = 2", "curves = true", "unloading.curves", "true should be a whole number"),
        ("title =", f"deep = {'[' * 5000}{']' * 5000}\ntitle =", "case.toml", "nested too deeply"),
        ('"0.6 um"]', '"0 um"]', "grid.spacing", "greater than zero"),
        (
            '"gaussian"',
            '"gausian"',
            "roughness.kind",
            "'exponential', 'gaussian', 'self-affine', 'measured'",
        ),
        ('kind = "gaussian"', "", "roughness.kind", "is missing"),
        ('"2 um"', '"0.1 um"', "roughness.correlation_length", "below the grid spacing"),
        ('"2 um"', '"200 um"', "roughness.correlation_length", "above half of the domain"),
        ('rms = "0.05 um"', "", "roughness.rms", "is missing"),
        ("steps = 4", "", "indentation", "give `from`, `to` and `steps`"),
        ('to = "300 nm"', 'to = "3 nm"', "indentation", "`from` must be smaller than `to`"),
        ("steps = 4", 'scale = "cubic"', "indentation.scale", "'log' or 'linear'"),
        (
            "[unloading]",
            '[load]\nvalues = ["1 N"]\n[unloading]',
            "[load]",
            "this case has [indentation] and [load]",
        ),
        ("[first]", "[first", "case.toml", "not valid TOML"),
    ],
)
def test_a_key_that_is_wrong(refused_case, old, new, key, remedy):
    message = refused_case((old, new))
    assert key in message
    assert remedy in message


def test_nothing_says_how_deep(refused_case, case_text):
    span = case_text[case_text.index("[indentation]") : case_text.index("[unloading]")]
    message = refused_case((span, ""))
    assert (
        "give one of the tables [indentation], [load], [impact] and [pressure]; this case has none"
        in message
    )


@pytest.mark.parametrize(
    ("impact", "remedy"),
    [
        ("velocity = [1.0]", '1.0 has no unit; write for example "0.5 m/s"'),
        ('velocity = "1 m/h^2"', "is not a velocity"),
        ('velocity = "-1 m/s"', "greater than zero"),
        ("velocity = []", "impact.velocity"),
        ('from = "1 m/s"', "give `from`, `to` and `steps` (or `velocity = [...]`)"),
        ('velocity = "20 m/s"', "grid"),
        ('velocity = "90 m/s"', "beyond R* = 250 um"),
    ],
)
def test_an_impact_that_is_wrong(refused_case, case_text, impact, remedy):
    span = case_text[case_text.index("[indentation]") : case_text.index("[unloading]")]
    assert remedy in refused_case((span, f"[impact]\n{impact}\n"))


def test_an_impact_needs_masses(refused_case, case_text):
    span = case_text[case_text.index("[indentation]") : case_text.index("[unloading]")]
    impact = (span, '[impact]\nvelocity = "0.1 m/s"\n')
    assert "first.density: is missing" in refused_case(impact, ('density = "7850 kg/m^3"', ""))


@pytest.mark.parametrize("verb", ["check", "run"])
def test_two_flat_bodies(refused_case, verb):
    message = refused_case(('"500 um"', '"flat"'), verb=verb)
    assert "case.toml: first.radius: both bodies are flat" in message
    assert "[second] is left out and defaults to [first]; add [second]" in message


@pytest.mark.parametrize(
    ("replacement", "words"),
    [
        (("[interface]", "[interfaces]"), "interfaces: unknown key"),
        (('values = ["1 N"]', "values = []"), "[] should be a list with at least one value"),
        (('values = ["1 N"]', 'values = "1 N"'), '"1 N" should be a list'),
        (('title = "A small rough contact"', "title = 3"), "title: 3 should be a text"),
        (('[grid]\nnodes = [72, 64]\nspacing = ["0.5 um", "0.6 um"]', ""), "[grid] is missing"),
        (("[unloading]\ncurves = 2\nsteps = 6", "[[unloading]]"), "should be a table"),
    ],
)
def test_plain_words(refused_case, case_text, replacement, words):
    span = case_text[case_text.index("[indentation]") : case_text.index("[unloading]")]
    assert words in refused_case((span, '[load]\nvalues = ["1 N"]\n'), replacement, verb="check")


def test_other_problems_are_named_by_key(refused_case):
    """Two places in one list are one key."""
    once = refused_case(('["0.5 um", "0.6 um"]', '["a", "b"]'), verb="check")
    assert "grid.spacing" in once
    assert "also wrong" not in once
    twice = refused_case(('["0.5 um", "0.6 um"]', '["a", "b"]'), ("seed = 1", ""), verb="check")
    assert twice.endswith("(also wrong: grid.spacing)")


def test_what_is_wrong_with_a_surface_names_the_case(refused_case):
    message = refused_case(('"2 um"', '"200 um"'), verb="surface")
    assert "case.toml: roughness.correlation_length" in message


def test_a_byte_order_mark_is_no_error(cli, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text, encoding="utf-8-sig")
    assert cli("check", tmp_path / "case.toml")[0] == 0


def test_no_case_file(refused, tmp_path):
    assert "cannot be read (No such file" in refused("run", tmp_path / "none.toml", "-o", tmp_path)


def test_a_case_file_that_is_no_text(refused, tmp_path):
    (tmp_path / "case.toml").write_bytes(b"\xff\xfe\x00\x01")
    assert "is not a text file" in refused("check", tmp_path / "case.toml")


def test_contact_off_the_domain_keeps_the_depths_before_it(cli, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text.replace('"300 nm"', '"3 um"'))
    status, _, said = cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert status == 1
    assert "the contact reaches the edge of the 36 um x 38.4 um grid" in said
    assert "use a grid of about" in said
    assert "3 of 4 depths were computed and are kept" in said
    # What is foreseen is said before the solve that fails on it.
    assert said.index("Warning: the contact is predicted to reach") < said.index("Error: ")
    assert (tmp_path / "out" / "load-displacement.png").exists()
    assert len((tmp_path / "out" / "curve.csv").read_text().splitlines()) == 4
    assert '"status": "failed"' in (tmp_path / "out" / "summary.json").read_text()
    assert (tmp_path / "out" / "results.nc").exists()


def test_more_load_than_the_grid_carries(refused_case, case_text):
    span = case_text[case_text.index("[indentation]") : case_text.index("[unloading]")]
    message = refused_case((span, '[load]\nvalues = ["5 N"]\n'), verb="run")
    assert "load: 5 N is more than the whole grid carries at the yield pressure" in message


def test_results_are_never_overwritten(refused, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "curve.csv").write_text("mine")
    for verb in ("run", "surface"):
        message = refused(verb, tmp_path / "case.toml", "-o", tmp_path / "out")
        assert "not empty, and nothing in it is overwritten; name another folder with -o" in message
    assert [p.name for p in (tmp_path / "out").iterdir()] == ["curve.csv"]
    assert (tmp_path / "out" / "curve.csv").read_text() == "mine"


def test_an_output_that_cannot_be_a_folder(refused, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text)
    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file", tmp_path / "file" / "below", tmp_path / ("x" * 300)):
        message = refused("run", tmp_path / "case.toml", "-o", out)
        assert "cannot be written" in message
        assert "name another folder with -o" in message


def test_a_case_that_is_no_regular_file_is_refused_at_once(refused, tmp_path):
    os.mkfifo(tmp_path / "pipe.toml")
    for path in (tmp_path / "pipe.toml", "/dev/zero"):
        assert "is not a regular file" in refused("check", path)
    with (tmp_path / "large.toml").open("wb") as stream:
        stream.truncate(2**33)
    assert "has 8589934592 bytes" in refused("check", tmp_path / "large.toml")


SPACES, MANY = 10**5 * " ", 5000


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"500 um"', f'"5 {"(" * MANY}m{")" * MANY}"', "is not one number followed by a unit"),
        ('"500 um"', f'"5 m{"*m" * MANY}"', "is not one number followed by a unit"),
        ('"500 um"', f'"5{SPACES}x y"', "is not one number followed by a unit"),
        ('"500 um"', f'"{10**5 * "1"} x y"', "is not one number followed by a unit"),
        ('"750 MPa"', f'"2{SPACES}*{SPACES}Z"', "is not one number followed by a unit"),
        ('"750 MPa"', f'"{10**5 * "2"}Z"', "is not one number followed by a unit"),
        ("title =", f"a{'.a' * MANY} = 1\ntitle =", "nested too deeply"),
        ('radius = "500 um"', f"radius{'.a' * MANY} = 1", "nested too deeply"),
        ('radius = "500 um"', f"radius{'.a' * 40} = 1", "nested too deeply"),
        ('radius = "500 um"', "radius" + MANY * ".'a'" + " = 1", "nested too deeply"),
        ("[first]", f"[first{'.a' * MANY}]", "nested too deeply"),
        ('radius = "500 um"', f"radius = {'{a=' * 200}1{'}' * 200}", "nested too deeply"),
    ],
)
def test_what_would_take_minutes_is_refused_at_once(case_text, old, new, words):
    from restitution.case.case_file import parse_case
    from restitution.errors import CaseError

    parse_case(case_text)  # the table of units is read once
    assert old in case_text
    began = time.perf_counter()
    with pytest.raises(CaseError, match=words):
        parse_case(case_text.replace(old, new, 1))
    assert time.perf_counter() - began < 1.0  # minutes, with backtracking


def test_the_other_keys_that_are_wrong_are_named(refused_case):
    message = refused_case(("radius =", "radus ="), ("rms =", "rns ="), ("nodes =", "nods ="))
    assert 'first.radus: unknown key; did you mean "radius"?' in message
    assert "(also wrong: roughness.rns, grid.nods, first.radius, 1 more)" in message
    one = refused_case(("seed = 1", 'seed = "1"'), ("steps = 6", "steps = true"))
    assert one.endswith("(also wrong: unloading.steps)")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ("export", "x", "-o", "y", "--to", "lamps"),
            '"lamps" is not one of lammps, liggghts, yade, mercurydpm, edem, kratos, mujoco, '
            "drake, lammps-adhesive, liggghts-adhesive, yade-adhesive, c, python, csv; "
            'did you mean "lammps"?',
        ),
        (("run", "x", "-o", "y", "--device", "gpuu"), '"gpuu" is not one of cpu, gpu, auto; did'),
        (("run", "x", "-o", "y", "--figures", "docx"), '"docx" is not one of png, svg, pdf '),
    ],
)
def test_a_misspelt_choice_is_refused_with_the_nearest_one(cli, arguments, words):
    status, _, said = cli(*arguments)
    assert status == 2
    assert words in " ".join(said.replace("│", "").split())  # it is wrapped in a box
    assert "Value error" not in said


def test_a_misspelt_verb_is_refused_with_the_nearest_one(cli):
    status, _, said = cli("rnu")
    assert status == 2
    assert "No such command 'rnu'. Did you mean 'run'?" in said


def test_a_law_with_a_wrong_value_is_said_in_plain_words(tmp_path):
    from restitution.errors import CaseError
    from restitution.laws.law_files import read_law

    (tmp_path / "law.json").write_text("{}")
    with pytest.raises(CaseError) as caught:
        read_law(tmp_path / "law.json")
    assert "Value error" not in str(caught.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('"500 um"', '"0.1 um"'), "radius: the particle of 0.1 um is smaller than its roughness"),
        (('to = "300 nm"', 'to = "300 um"'), "beyond R* = 250 um"),
    ],
)
@pytest.mark.parametrize("verb", ["check", "run"])
def test_what_is_larger_than_the_particle(refused_case, change, words, verb):
    assert words in refused_case(change, verb=verb)


def test_other_kinds_of_files_are_named(refused, tmp_path):
    (tmp_path / "mix.toml").write_text('[materials.a]\nmaterial = "steel"\nradius = "1 mm"\n')
    said = refused("run", tmp_path / "mix.toml", "-o", tmp_path / "out")
    assert "this is a mixture: use `restitution mixture FILE`" in said
    (tmp_path / "m.csv").write_text("velocity_m_per_s,restitution\n0.1,0.8\n")
    said = refused("run", tmp_path / "m.csv", "-o", tmp_path / "out")
    assert "this is a table of values, not a case file: give the case file" in said


HEAD = '[first]\nmaterial = "steel"\n'


@pytest.mark.parametrize("verb", ["check", "run"])
@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            HEAD + 'diameter = "5 um"',
            "first.diameter: unknown key; give radius = half the diameter",
        ),
        ('materials = ["steel"]', "this is a mixture: use `restitution mixture FILE`"),
        (HEAD + "radius = 5 um", 'write texts and quantities in quotes: radius = "5 um"'),
        (HEAD + "radius = um", 'write texts and quantities in quotes: radius = "um"'),
        (HEAD + 'radius = "5 um"\nradius = "6 um"', '"radius" is given twice: remove one of them'),
        ("velocity,restitution\n1,0.5", "this is a table of values, not a case file"),
    ],
)
def test_the_likely_cause_of_a_wrong_file_is_named(refused, tmp_path, verb, text, words):
    (tmp_path / "case.toml").write_text(text)
    more = ("-o", tmp_path / "out") if verb == "run" else ()
    assert words in refused(verb, tmp_path / "case.toml", *more)


def test_a_study_is_not_run_as_a_case(refused, tmp_path):
    (tmp_path / "study.toml").write_text(HEAD + '[sweep]\n"first.radius" = ["1 um"]')
    message = refused("run", tmp_path / "study.toml", "-o", tmp_path / "out")
    assert "this is a study: use `restitution study FILE`" in message
