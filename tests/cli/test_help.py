"""`--help` of every verb says what its source says."""

import re
from typing import get_type_hints

import pytest

from restitution.cli.app import app

VERBS = {
    command.callback.__name__.replace("_", "-"): command.callback
    for command in app.registered_commands
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
