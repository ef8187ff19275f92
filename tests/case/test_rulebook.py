"""A key of the case file is declared once: the parser, the page and the documentation follow."""

import tomllib
from pathlib import Path
from typing import Annotated

import pytest
from pydantic import Field, ValidationError

from document_blocks import key_table, with_tables
from restitution.app.form import form
from restitution.case.case import Case
from restitution.case.case_file import in_words
from restitution.case.interface import InterfaceTable
from restitution.case.rulebook import Input, key, rules, tables_in

PAGE = Path(__file__).parents[2] / "docs" / "case-file.md"


class Interface(InterfaceTable):
    rolling_friction: Annotated[float, Field(ge=0, le=1)] | None = key(
        None,
        "coefficient of rolling friction",
        only=("adhesion", "cohesive"),
        otherwise='rolling_friction: {value} needs adhesion = "cohesive"',
        page=Input("Rolling friction µ_r", hint="of both bodies", slider=(0, 0.5)),
    )


class Extended(Case):
    interface: Interface = Interface()


def parsed(text, keys):
    interface = f"[interface]\n{keys}\n"
    return Extended.model_validate(tomllib.loads(text.replace("[interface]\n", interface)))


COHESIVE = 'work_of_adhesion = "50 mJ/m^2"\nadhesion = "cohesive"\n'


def test_the_parser_reads_the_new_key(case_text):
    case = parsed(case_text, f"{COHESIVE}rolling_friction = 0.1")
    assert case.interface.rolling_friction == 0.1


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (f"{COHESIVE}rolling_friction = 2", "interface.rolling_friction: 2 should be less than"),
        ("rolling_friction = 0.1", 'rolling_friction: 0.1 needs adhesion = "cohesive"'),
        ("rolling_friktion = 0.1", 'unknown key; did you mean "rolling_friction"?'),
    ],
)
def test_the_parser_refuses_what_the_rule_excludes(case_text, keys, words):
    with pytest.raises(ValidationError) as refused:
        parsed(case_text, keys)
    assert words in in_words(refused.value, Extended)


def fields(case, title):
    (group,) = (group for group in form(case)["groups"] if group["title"] == title)
    return {field["key"]: field for field in group["fields"]}


def test_the_page_shows_the_new_key():
    known, extended = fields(Case, "Interface"), fields(Extended, "Interface")
    new = extended.pop("interface.rolling_friction")
    assert extended == known
    assert (new["label"], new["hint"]) == ("Rolling friction µ_r", "of both bodies")
    assert (new["low"], new["high"], new["logarithmic"]) == (0, 0.5, False)
    assert new["when"] == ("interface.adhesion", "cohesive")


def test_the_documentation_lists_the_new_key():
    assert key_table("interface", Extended) == key_table("interface") + (
        '| `rolling_friction` | number from 0 to 1 | none | with `adhesion` = `"cohesive"`: '
        "coefficient of rolling friction |\n"
    )


def test_the_tables_of_the_documentation_are_up_to_date():
    """`python tests/document_blocks.py docs/case-file.md` writes them."""
    page = PAGE.read_text(encoding="utf-8")
    assert page.count("<!-- keys: ") == 12
    assert with_tables(page) == page


def all_rules(table):
    for rule in rules(table):
        yield rule
        for inner in tables_in(rule.field):
            yield from all_rules(inner)


def test_every_key_that_takes_a_value_has_a_meaning():
    silent = {rule.name for rule in all_rules(Case) if not (rule.key.meaning or rule.field is None)}
    assert silent <= {"x", "y", *(name for name in Case.model_fields if tables_in_field(name))}


def tables_in_field(name):
    return tables_in(Case.model_fields[name])


def test_a_key_depends_only_on_a_key_of_its_table():
    for table in (InterfaceTable, *tables_in(Case.model_fields["roughness"])):
        names = {rule.name: rule for rule in rules(table)}
        for rule in names.values():
            if rule.key.only:
                other, *values = rule.key.only
                assert set(values) <= {"", *names[other].words}, rule.name


def test_the_keys_of_the_page_are_keys_of_the_case():
    known = {"second", "depths"}
    for name in Case.model_fields:
        known |= {
            name,
            *(f"{name}.{rule.name}" for table in tables_in_field(name) for rule in rules(table)),
        }
    assert {field["key"] for group in form()["groups"] for field in group["fields"]} <= known
