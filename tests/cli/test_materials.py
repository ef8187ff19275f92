"""`restitution materials`: the library in a terminal and as JSON."""

import json

from restitution.case.materials import adhesive, materials, work_of_adhesion


def test_the_list_has_every_material(cli):
    status, said, _ = cli("materials")
    assert status == 0
    rows = {line.split()[0]: line for line in said.splitlines()[1:-1]}
    assert list(rows) == list(materials())
    assert rows["steel"].split()[1:6] == ["203", "0.3", "7830", "3300", "7.9"]
    assert rows["glass"].split()[4] == "-"


def test_a_narrow_terminal_has_one_line_for_each_material(cli, monkeypatch):
    from restitution.cli import console

    cli("materials")
    monkeypatch.setattr(console.answers, "_width", 80)
    rows = cli("materials")[1].splitlines()[1:-1]
    assert [row.split()[0] for row in rows] == list(materials())
    assert max(map(len, rows)) <= 80


def test_one_material_has_its_sources(cli):
    status, said, _ = cli("materials", "Soda-Lime")
    assert status == 0
    flowing = " ".join(said.split())
    glass = materials()["glass"]
    assert glass.name in flowing
    assert glass.note in flowing
    assert "69 to 74 GPa" in flowing
    assert "EN 572-1" in flowing
    assert "yield strength" not in flowing


def test_a_value_from_memory_is_marked(cli):
    assert "not verified: AK Steel" in " ".join(cli("materials", "304")[1].split())


def test_json_has_values_in_si(cli):
    found = json.loads(cli("materials", "glass", "--json")[1])
    assert found["glass"]["youngs_modulus"]["value"] == 70e9
    assert found["glass"]["yield_strength"] is None
    assert list(json.loads(cli("materials", "--json")[1])) == list(materials())


def test_the_work_of_adhesion_of_pairs_is_listed(cli):
    status, said, _ = cli("materials", "--adhesion")
    assert status == 0
    rows = [line.split() for line in said.splitlines()]
    assert ["glass", "lactose", "71.8", "59.7", "to", "113"] in rows
    assert "2 sqrt(gamma_1 gamma_2)" in said
    own = cli("materials", "Lactose", "--adhesion")[1].splitlines()
    assert all("lactose" in line for line in own[1 : 1 + len(adhesive())])
    found = json.loads(cli("materials", "--adhesion", "--json")[1])
    assert found["glass lactose"]["low"] == work_of_adhesion("glass", "lactose").low


def test_a_surface_energy_is_shown_with_its_conditions(cli):
    flowing = " ".join(cli("materials", "lactose")[1].split())
    assert "surface energy 23.3 21 to 57.4" in flowing
    assert "1 %" in flowing


def test_pairs_of_a_material_without_a_surface_energy_are_refused(refused):
    assert "no surface energy of calcite" in refused("materials", "calcite", "--adhesion")


def test_a_material_of_which_little_is_known_is_shown(cli):
    flowing = " ".join(cli("materials", "acetaminophen")[1].split())
    assert "density 1293" in flowing
    assert "Young's modulus" not in flowing.split("Note")[0]


def test_a_name_that_is_not_known_is_refused(refused):
    assert 'did you mean "steel"?' in refused("materials", "stel")
