"""`--help` of every verb says what its source says."""

import inspect
import re
from importlib import import_module
from typing import get_type_hints

import pytest

from restitution.cli import parameters
from restitution.cli.verbs import program

VERBS = {
    command.callback.__name__.replace("_", "-"): command.callback
    for command in program.registered_commands
}


def flowing(text):
    """`text` without frames and breaks."""
    return " ".join(re.sub(r"[│╭╮╰╯─]", " ", text).split())


@pytest.mark.parametrize("verb", sorted(VERBS))
def test_no_word_of_help_is_swallowed_as_markup(cli, verb):
    status, said, _ = cli(verb, "--help")
    assert status == 0
    said = flowing(said)
    texts = [VERBS[verb].__doc__.strip().splitlines()[0]]
    for annotation in get_type_hints(VERBS[verb], include_extras=True).values():
        texts += [each.help for each in getattr(annotation, "__metadata__", ()) if each.help]
    assert len(texts) > 1
    for text in texts:
        assert flowing(text.replace("\\[", "[")) in said


def test_help_of_study_names_its_table(cli):
    assert "a case and a table [sweep]." in flowing(cli("study", "--help")[1])


@pytest.mark.parametrize("verb", sorted(VERBS))
def test_the_function_behind_a_verb_has_its_parameters(verb, monkeypatch):
    """It is imported by name when the verb runs, so a type checker does not compare them."""
    call = VERBS[verb]
    called = []
    given = inspect.signature(call).parameters
    monkeypatch.setattr(
        parameters, "import_module", lambda name: called.append(import_module(name)) or called[0]
    )
    with pytest.raises(TypeError, match="unexpected keyword argument 'no_such'"):
        call(**dict.fromkeys(given), no_such=None)
    implementation = getattr(called[0], call.__name__)
    assert set(inspect.signature(implementation).parameters) == set(given)
    plain = get_type_hints(call)
    assert get_type_hints(implementation) == plain
