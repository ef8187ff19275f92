"""MuJoCo gives back the restitution that was exported."""

import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import pytest

from restitution.dem.codes.mujoco import LOWEST, write
from restitution.dem.pair_table import pair_table
from restitution.errors import CaseError
from tolerance import approx

SCRIPT = "collision_mujoco.py"


@pytest.fixture
def mujoco(python_with):
    return python_with("mujoco", SCRIPT)


@pytest.mark.parametrize("V", [0.01, 0.5, 10.0])
def test_equal_spheres_rebound_as_exported(equal, mujoco, texts, V):
    asked = equal.laws[1, 1].at(V).restitution
    assert mujoco.ratios(texts(write(equal, V))) == approx([asked], rel=0.005)


def test_unlike_spheres_and_walls_rebound_as_exported_at_any_velocity(mixed, mujoco, texts):
    folder = texts(write(mixed, 0.5))
    for i, j, law in mixed.pairs():
        asked = law.at(0.5).restitution
        assert mujoco.ratios(folder, 0.5, i, j) == approx([asked], rel=0.005), (i, j)
    asked = mixed.laws[1, 2].at(0.5).restitution
    assert mujoco.ratios(folder, 5, 1, 2) == approx([asked], rel=0.005)


@pytest.mark.parametrize("e", [1.0, 0.99, 0.9, 0.2, LOWEST])
def test_restitution_is_reproduced_from_the_least_to_one(mujoco, law, constant, texts, e):
    folder = texts(write(pair_table([constant(law(), e)]), 1.0))
    assert mujoco.ratios(folder) == approx([e], rel=0.02)


@pytest.mark.parametrize(("radius", "velocity"), [(1e-5, 10.0), (0.05, 0.1)])
def test_small_and_large_spheres_rebound(mujoco, law, texts, radius, velocity):
    sphere = replace(law().first, radius=radius)
    found = law(sphere, sphere)
    asked = found.at(velocity).restitution
    folder = texts(write(pair_table([found]), velocity))
    assert mujoco.ratios(folder) == approx([asked], rel=0.005)


def test_the_softer_contact_that_is_offered_has_the_same_e(equal, mujoco, texts):
    files = write(equal, 0.5)
    name, text = "restitution_mujoco.xml", files["restitution_mujoco.xml"]
    stiff = re.search(r'<pair solref="(.*?)"', text)[1]
    step, soft = re.search(r'pair 1 1: timestep="(.*?)" solref="(.*?)"', text).groups()
    files[name] = text.replace(stiff, soft)
    files[SCRIPT] = re.sub(r"step = CONTACT.*", f"step = {step}", files[SCRIPT])
    asked = equal.laws[1, 1].at(0.5).restitution
    assert mujoco.ratios(texts(files)) == approx([asked], rel=0.02)


def test_contact_lasts_as_long_as_hertz(equal):
    root = ET.fromstring(write(equal, 1.0)["restitution_mujoco.xml"])
    (pair,) = root.iter("pair")
    stiffness, damping = (-float(word) for word in pair.get("solref").split())
    found = equal.laws[1, 1]
    depth = (15 * found.mass / (16 * found.contact_modulus * found.radius**0.5)) ** 0.4
    assert math.pi / math.sqrt(stiffness) == approx(2.943 * depth, rel=2e-3)
    assert damping > 0


def test_names_and_titles_stay_in_their_comments(hostile, mujoco, law, texts):
    bad = law(hostile, hostile, title='--> <a b="c"> -- -', warnings=('"""\nquit(-->',))
    files = write(pair_table([bad]), 1.0)
    assert all(text.isascii() for text in files.values())
    asked = bad.at(1.0).restitution
    assert mujoco.ratios(texts(files)) == approx([asked], rel=0.005)


def test_pairs_that_stick_are_refused(law, constant):
    with pytest.raises(CaseError, match=r"sticks \(e = 0\) at every computed velocity.*MuJoCo"):
        write(pair_table([constant(law(), 0.0)]), 1.0)
