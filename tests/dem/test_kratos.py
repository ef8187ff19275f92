"""Kratos DEM reproduces the exported restitution (`make test-kratos`)."""

import json
import re
from dataclasses import replace

import pytest

from restitution.dem.codes.kratos import LOWEST, write
from restitution.dem.pair_table import pair_table
from restitution.errors import CaseError
from tolerance import approx


def test_ten_pairs_rebound_as_exported(mixed, kratos, texts):
    for V in (0.05, 2.0):
        folder = texts(write(mixed, V), f"at-{V}")
        for i, j, law in mixed.pairs():
            (e,) = kratos.ratios(folder, "collision_kratos.py", V, i, j)
            assert e == approx(law.at(V).restitution, rel=0.01), (i, j)


@pytest.mark.parametrize("e", [1.0, LOWEST])
def test_restitution_is_reproduced_from_the_least_to_one(kratos, law, constant, texts, e):
    folder = texts(write(pair_table([constant(law(), e)]), 1.0))
    assert kratos.ratios(folder, "collision_kratos.py") == approx([e], rel=0.01)


def test_the_packing_runs_and_its_lowest_layer_rebounds(mixed, kratos, texts):
    said = kratos.says(texts(write(mixed, 1.0)), "packing_kratos.py", 2e-4)
    assert "spheres = 200" in said
    lowest = float(re.search(r"lowest centre = (\S+)", said)[1])
    assert 0.9 * 4e-4 < lowest < 3e-3
    assert int(re.search(r"rebounding = (\d+)", said)[1]) >= 10


def test_the_settings_avoid_late_contacts(kratos, law, constant, texts):
    """With the default search every 50 steps, e = 1 comes back larger than 1."""
    files = write(pair_table([constant(law(), 1.0)]), 1.0)
    late = files["restitution_kratos.py"].replace('Frequency": 1,', 'Frequency": 50,')
    assert late != files["restitution_kratos.py"]
    script = files["collision_kratos.py"].replace("contact / 500", "contact / 100")
    changed = {"restitution_kratos.py": late, "collision_kratos.py": script}
    (e,) = kratos.ratios(texts(files | changed), "collision_kratos.py")
    assert e > 1.02


def test_every_pair_has_a_relation_and_every_type_a_part(mixed):
    read = json.loads(write(mixed, 1.0)["MaterialsDEM.json"])
    assert [m["material_id"] for m in read["materials"]] == [1, 2, 3]
    pairs = [tuple(r["material_ids_list"]) for r in read["material_relations"]]
    assert pairs == [(i, j) for i, j, _ in mixed.pairs()]
    parts = [part for part, _ in read["material_assignation_table"]]
    assert parts == ["SpheresPart.type_1", "SpheresPart.type_2", "RigidFacePart.wall_3"]
    relation = read["material_relations"][1]["Variables"]
    assert relation["COEFFICIENT_OF_RESTITUTION"] == approx(
        mixed.laws[1, 2].at(1.0).restitution, rel=1e-8
    )


def test_adhesive_pairs_are_sent_to_the_portable_contact(law):
    points = tuple(replace(p, pull_off_force=1e-6) for p in law().points)
    files = write(pair_table([law(work_of_adhesion=0.1, points=points)]), 1.0)
    said = " ".join(files["restitution_kratos.txt"].split())
    assert "the export to c or python has it" in said


def test_pairs_that_stick_and_missing_pairs_are_refused(law, constant, mixed):
    with pytest.raises(CaseError, match=r"sticks \(e = 0\) at every computed velocity.*Kratos"):
        write(pair_table([constant(law(), 0.0)]), 1.0)
    some = [law for i, j, law in mixed.pairs() if (i, j) != (2, 3)]
    with pytest.raises(CaseError, match="Kratos needs a separate law for every sphere on every"):
        write(pair_table(some), 1.0)


def test_names_stay_in_json(hostile, law):
    files = write(pair_table([law(hostile, hostile, title='"\\', warnings=('"]}',))]), 1.0)
    assert all(text.isascii() for text in files.values())
    assert any("WARNING" in line for line in json.loads(files["MaterialsDEM.json"])["about"])
