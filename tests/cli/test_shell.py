"""The shell: completion, short help, names of arguments, and the command that follows."""

import re

import pytest
import typer

from restitution.cli.parameters import ExportFormat
from restitution.cli.verbs import program
from restitution.dem.export import CODES

COMMANDS = typer.main.get_command(program).commands


def complete(cli, monkeypatch, words, number):
    monkeypatch.setenv("_RESTITUTION_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(number))
    return cli()[1].split()


def test_a_shell_completes_verbs_options_and_values(cli, monkeypatch):
    assert complete(cli, monkeypatch, "restitution co", 1) == [
        "converge",
        "compare",
        "compare-theory",
    ]
    assert "--velocity" in complete(cli, monkeypatch, "restitution export --", 2)
    assert complete(cli, monkeypatch, "restitution export --to l", 3) == [
        "lammps",
        "liggghts",
        "lammps-adhesive",
        "liggghts-adhesive",
    ]
    assert complete(cli, monkeypatch, "restitution materials st", 2) == [
        "steel",
        "stainless-steel",
        "starch",
    ]


def test_completion_can_be_installed(cli):
    said = cli("--help")[1]
    assert "--install-completion" in said
    assert "--show-completion" in said


@pytest.mark.parametrize("verb", sorted(COMMANDS))
def test_h_is_help(cli, verb):
    status, said, _ = cli(verb, "-h")
    assert (status, said) == cli(verb, "--help")[:2]
    assert status == 0


@pytest.mark.parametrize("verb", sorted(COMMANDS))
def test_inputs_and_outputs_have_the_names_of_the_help(verb):
    command = COMMANDS[verb]
    summary = command.help.splitlines()[0]
    named = set(re.findall(r"\b[A-Z]{3,}\b", summary)) - {"COR", "HTML", "ISO", "DEM"}
    metavars = {each.name: each.metavar for each in command.params}
    assert named <= set(metavars.values())
    arguments = [each for each in command.params if each.param_type_name == "argument"]
    assert all(each.metavar and each.metavar != "OUT" for each in arguments)
    if "out" in metavars:
        (out,) = (each for each in command.params if each.name == "out")
        assert out.opts == ["-o", "--out"]
        assert out.metavar == ("OUT" if "older" in out.help else "FILE")


def test_the_next_command_can_be_pasted(cli, case_text, tmp_path):
    case = tmp_path / "a case.toml"
    case.write_text(case_text)
    said = cli("check", case)[1].splitlines()
    assert said[-1] == f"Next: restitution run '{case}' -o OUT"


def test_every_code_of_an_export_is_a_choice():
    assert list(ExportFormat) == list(CODES)
