"""Messages about a contact, in terms of the keys of the case file."""

import math
import re

import numpy as np
import pytest

from restitution import Body, Contact, Grid, Pair, Surface, generate_surface, smooth
from restitution.case.case_file import parse_case
from restitution.case.models import adhesion_of
from restitution.contact.checks.resolution import (
    NODES_PER_PATCH,
    NODES_PER_RADIUS,
    unresolved_adhesion,
    unresolved_patches,
)
from restitution.contact.path import loading_path
from restitution.contact.plasticity.bound import ConstantBound
from restitution.curve.follow import loaded
from restitution.errors import CaseError, DomainError, NotConvergedError, SurfaceError
from restitution.runs.depths import loads_of
from restitution.runs.messages import (
    input_warnings,
    naming_keys,
    require_possible,
    surface_warnings,
)

STEEL = Pair(*2 * [Body(500e-6, 210e9, 0.25)])
GRID = Grid((64, 64), (0.5e-6, 0.5e-6))
X, Y = GRID.x[:, None], GRID.y[None, :]
ROUGH = generate_surface(GRID, kind="gaussian", rms=2e-8, correlation_length=3e-6, seed=1).height


def measured(height, **provenance):
    provenance = {"source": "measured", "file": "scan.npy", "levelling": "none", **provenance}
    return Contact(
        STEEL,
        Surface(height, GRID, provenance),
        plasticity=ConstantBound(750e6),
    )


def test_a_good_contact_is_let_pass():
    assert input_warnings(Contact(STEEL, smooth(GRID), plasticity=ConstantBound(750e6)), 4e-7) == []
    assert input_warnings(Contact(STEEL, smooth(GRID)), 4e-7) == []
    assert input_warnings(measured(ROUGH), 4e-7) == []


def test_a_tilted_scan():
    line, edge = input_warnings(measured(ROUGH + 6e-2 * X), 1e-7)
    assert "off the centre; use roughness.detrend" in edge
    assert line.startswith("scan.npy: the scan is tilted (a plane explains ")
    assert 'set roughness.detrend = "tilt"' in line
    assert len(input_warnings(measured(ROUGH + 6e-2 * X, levelling="tilt"), 1e-7)) == 1


def test_a_curved_scan_counts_the_sphere_twice():
    (line,) = surface_warnings(measured(ROUGH - (X**2 + Y**2) / 1e-3).surface, 250e-6)
    assert re.fullmatch(
        r"scan.npy: the scan is curved like a sphere with a radius of (49\d|50\d).* µm \(which "
        r"explains 9\d% of the variance of its heights\), and this adds to the shape of the "
        r'particles, which R\* = 250 µm contains: set roughness.detrend = "curvature"',
        line,
    )
    (line,) = surface_warnings(measured((X**2 + Y**2) / 1e-3).surface)
    assert "like a hollow with a radius of 500 µm" in line
    assert "only a part of it would touch a flat body" in line


def test_spikes_are_named_with_their_key_and_come_before_the_slope():
    spiky = ROUGH.copy()
    spiky[::16, ::16] += 1e-6
    words = "scan.npy: 16 spikes of up to 1.0"
    assert surface_warnings(measured(spiky).surface)[0].startswith(words)
    assert "roughness.outliers = 8 replaces" in input_warnings(measured(spiky), 4e-7)[0]
    spiky[::16, ::16] += 1e-4
    with pytest.raises(SurfaceError, match=r"16 spikes of up to 101 µm: roughness\.outliers"):
        require_possible(measured(spiky), 4e-7)


def test_impossible_slopes_name_the_unit():
    steep = 1000 * ROUGH
    unscanned = Surface(steep, GRID, {"source": "generated"})
    with pytest.raises(SurfaceError, match=r"slope is 2\d.*above 3 .*the unit of roughness\.rms"):
        require_possible(Contact(STEEL, unscanned, plasticity=ConstantBound(750e6)), 4e-7)
    with pytest.raises(SurfaceError, match=r"the unit of the heights in scan\.npy"):
        require_possible(measured(steep), 4e-7)
    (line,) = surface_warnings(unscanned)
    assert "the unit of roughness.rms" in line


def test_contact_at_the_rim_is_foreseen_where_smooth_bodies_would_not_have_it():
    bump = 8e-7 * np.exp(-(((X + 14e-6) / 1e-6) ** 2) - (Y / 1e-6) ** 2)
    lines = input_warnings(
        Contact(STEEL, Surface(bump, GRID), plasticity=ConstantBound(750e6)),
        1e-7,
    )
    assert len(lines) == 1
    assert "predicted to reach the edge of the grid" in lines[0]
    assert "first at x = -14 um, y = 0 um, off the centre" in lines[0]
    # a ridge that is lower than the centre, but not by enough
    ridge = 3.5e-7 * np.exp(-(((X - 15e-6) / 2e-6) ** 2)) + 0 * Y
    (line,) = input_warnings(
        Contact(STEEL, Surface(ridge, GRID), plasticity=ConstantBound(750e6)),
        4e-7,
    )
    assert "the gap there is 151.7 nm" in line
    (line,) = input_warnings(
        Contact(STEEL, Surface(ridge, GRID), plasticity=ConstantBound(750e6)),
        5e-8,
    )
    assert "has only 7.5 nodes at the spacing" in line


@pytest.mark.parametrize("yield_pressure", [math.inf, 750e6])
@pytest.mark.parametrize(("rms", "work_of_adhesion"), [(0.0, 0.0), (2e-8, 0.0), (0.0, 1.0)])
def test_what_reaches_the_edge_is_foreseen_before(yield_pressure, rms, work_of_adhesion):
    """Contact at the edge is predicted on every grid smaller than the one found by trial."""
    for nodes in range(60, 26, -2):
        grid = Grid((nodes, nodes), (0.25e-6, 0.25e-6))
        surface = smooth(grid)
        if rms:
            shape = {"kind": "gaussian", "rms": rms, "correlation_length": 2e-6, "seed": 3}
            surface = generate_surface(grid, **shape)
        contact = Contact(
            STEEL,
            surface,
            plasticity=ConstantBound(yield_pressure),
            adhesion=adhesion_of(work_of_adhesion=work_of_adhesion),
        )
        said = input_warnings(contact, 1e-7)
        predicted = any("predicted to reach" in line for line in said)
        try:
            next(iter(loading_path(contact, [1e-7])))
        except DomainError:
            assert predicted
            return
        if nodes == 60:
            assert not predicted
    pytest.fail("no grid was too small")


def test_steep_surfaces():
    (line,) = input_warnings(Contact(STEEL, Surface(60 * ROUGH, GRID)), 4e-7)[-1:]
    assert "the rms slope of the surface is " in line


@pytest.mark.parametrize(("yield_pressure", "said"), [(750e3, "6.7e-06"), (750e9, "6.7")])
def test_a_yield_pressure_that_no_such_body_has(yield_pressure, said):
    lines = input_warnings(
        Contact(STEEL, smooth(GRID), plasticity=ConstantBound(yield_pressure)),
        1e-7,
    )
    assert len(lines) == 1
    assert f"the yield pressure is {said} of the contact modulus" in lines[0]


def test_a_grid_coarser_than_the_scan():
    _, line = input_warnings(measured(ROUGH, pixel_x_m=0.5e-6, pixel_y_m=0.2e-6), 1e-7)
    assert "spacing 0.5 um is coarser than the scan's pixel 0.2 um along y" in line
    assert "shorter than 1 um are left out" in line
    lines = input_warnings(measured(ROUGH, pixel_x_m=0.7e-6, pixel_y_m=0.7e-6), 1e-7)
    assert not any("coarser" in line for line in lines)


def test_oblong_pixels_may_be_a_scan_that_lost_lines():
    pixels = {"pixel_x_m": 5e-7, "pixel_y_m": 5.1e-7}
    finer, line = input_warnings(measured(ROUGH, **pixels), 4e-7)
    assert finer.startswith("the grid spacing 0.5 um is finer than the scan's pixel 0.51 um")
    assert line.startswith("scan.npy: the pixels are 0.5 x 0.51 um, not square: if scan lines are")
    parts = {f"part_2_{key}": value for key, value in {**pixels, "file": "b.npy"}.items()}
    (line,) = input_warnings(measured(ROUGH, **parts), 4e-7)
    assert line.startswith("b.npy: the pixels are")
    lines = input_warnings(measured(ROUGH, pixel_x_m=5e-7, pixel_y_m=5.02e-7), 4e-7)
    assert not any("not square" in line for line in lines)


def test_a_particle_smaller_than_its_roughness_is_refused():
    small = Pair(Body(1e-7, 210e9, 0.25), Body(math.inf, 210e9, 0.25))
    with pytest.raises(CaseError, match=r"^radius: the particle of 0.1 um is smaller than its"):
        require_possible(Contact(small, Surface(10 * ROUGH, GRID)), 1e-9)
    require_possible(Contact(small, Surface(0.1 * ROUGH, GRID)), 1e-9)


def test_a_contact_beyond_the_particle_is_refused():
    contact = Contact(STEEL, smooth(GRID))
    require_possible(contact, 240e-6)
    with pytest.raises(CaseError, match=r"reach 255 um from the centre .* beyond R\* = 250 um"):
        require_possible(contact, 260e-6)


def narrow(pair=STEEL, **provenance):
    """A flat surface of 64 x 100 nodes of 0.25 x 0.2 um: 16 um wide."""
    grid = Grid((64, 100), (0.25e-6, 0.2e-6))
    return Contact(pair, Surface(np.zeros(grid.nodes), grid, provenance))


def depth_of(radius, reduced_radius=250e-6):
    """The depth (m) at which the elastic smooth contact has the given radius (m)."""
    return radius**2 / reduced_radius


def test_a_contact_larger_than_the_grid():
    beyond = depth_of(8.01e-6)
    (line,) = input_warnings(narrow(), beyond)
    assert line == (
        f"the contact is predicted to reach 8.01 um from the centre at an indentation of "
        f"{1e9 * beyond:.4g} nm, but the grid ends at 8 um: use more nodes or stop earlier"
    )
    whole = narrow(source="measured", size_x_m=16e-6, size_y_m=20e-6)
    assert "use a larger scan, roughness.extend or stop" in input_warnings(whole, beyond)[0]


def test_a_contact_on_few_nodes():
    (line,) = input_warnings(narrow(), depth_of(1e-6))
    assert "has only 4 nodes at the spacing 0.25 um" in line
    assert f"({NODES_PER_RADIUS} are needed)" in line


def test_a_sphere_too_small_for_a_half_space():
    tiny = Body(20e-6, 210e9, 0.25)
    (line,) = input_warnings(narrow(Pair(tiny, tiny)), depth_of(3e-6, 10e-6))
    assert "0.3 of R*" in line


def test_a_grid_finer_than_the_scan():
    lines = input_warnings(narrow(pixel_x_m=0.5e-6, pixel_y_m=0.5e-6), depth_of(5e-6))
    assert any("finer than the scan's pixel 0.5 um" in line for line in lines)


def test_a_scan_coarser_than_the_contact_is_refused():
    scan = narrow(source="measured", file="scan.txt", pixel_x_m=1.5e-6)
    with pytest.raises(SurfaceError, match=r"scan\.txt: one pixel \(1\.5 um\).*\(1 um at 4 nm\)"):
        require_possible(scan, depth_of(1e-6))
    require_possible(scan, 9 * depth_of(1e-6))


def test_depths_that_are_not_resolved():
    (finding,) = unresolved_patches([1e-9, 5e-9, 20e-9, 40e-9], [1, NODES_PER_PATCH - 1, 3, 90])
    assert finding.text().startswith("3 of 4 depths (up to 20 nm) are not resolved (resolved is")
    assert f"fewer than {NODES_PER_PATCH} nodes" in finding.text()
    (finding,) = unresolved_adhesion(
        [1e-9, 2e-9, 3e-9], [4e-9, 4e-9, 8e-9], [5e-9, 3e-9, 7e-9], 8e-9
    )
    assert finding.text().startswith("adhesion is not resolved at 2 of 3 depths (2 nm to 3 nm;")
    assert finding.text().endswith("needs 3 nm or less; set grid.refine = 4")
    (finding,) = unresolved_adhesion([1e-9], [4e-9], [0.01e-9], 8e-9)
    assert "roughness.shortest" in finding.text()


def test_a_notice_of_the_surface_is_repeated():
    contact = narrow(notice="half of it is made up")
    assert input_warnings(contact, depth_of(5e-6)) == ["half of it is made up"]


COARSE = Grid((32, 32), (1e-6, 1e-6))


def refusal(contact, indentation):
    with pytest.raises(DomainError) as refused, naming_keys():
        next(loading_path(contact, [indentation]))
    words = str(refused.value)
    assert re.match(r"the contact reaches the edge of the .* um grid at an indentation of", words)
    return words


def scan(height, **provenance):
    provenance = {"source": "measured", "levelling": "none", **provenance}
    return Contact(STEEL, Surface(height, COARSE, provenance))


def test_the_edge_is_reached_on_a_grid_that_can_grow():
    words = refusal(Contact(STEEL, smooth(COARSE), plasticity=ConstantBound(750e6)), 2e-6)
    assert re.search(
        r"; use a grid of about [\d.]+ um \(more grid\.nodes or a larger grid\.sp", words
    )
    height = np.zeros(COARSE.nodes)
    height[0, 3] = 5e-6
    words = refusal(Contact(STEEL, Surface(height, COARSE)), 1e-9)
    assert "first at x = -16 um, y = -13 um, off the centre; use a grid" in words


@pytest.mark.parametrize(
    ("table", "stop"),
    [
        ('[indentation]\nvalues = ["0.2 um", "2 um"]\n', "stop at a smaller indentation"),
        ('[load]\nvalues = ["0.06 N", "1 N"]\n', "stop at a smaller load"),
        ('[impact]\nvelocity = ["0.1 m/s", "1 m/s"]\n', "stop at a lower impact velocity"),
    ],
)
def test_the_grid_advised_contains_the_deepest_contact_of_the_case(
    case_text, tmp_path, table, stop
):
    begin, end = case_text.index("[grid]"), case_text.index("[unloading]")

    def errors(edge):
        grid = f'[grid]\nnodes = 48\nspacing = "{edge / 48:.4f} um"\n'
        case = parse_case(case_text[:begin] + grid + table + case_text[end:])
        errors = []
        loads = loads_of(case, tmp_path, case.contact(tmp_path))
        done = list(loaded(loads, lambda error: not errors.append(str(error))))
        return [*errors, *[""] * len(done)]

    words = errors(9.6)[0]
    assert words.endswith(stop)
    size = float(re.search(r"use a grid of about ([\d.]+) um ", words)[1])
    assert errors(1.01 * size) == ["", ""]


def test_a_tilted_scan_is_to_be_levelled_first():
    tilted = np.repeat(1e-6 * np.linspace(0, 5, 32)[:, None], 32, axis=1)
    words = refusal(scan(tilted), 2e-7)
    assert "off the centre; use roughness.detrend = " in words
    assert 'use roughness.detrend = "tilt" or "curvature", a larger scan' in words
    assert "nodes" not in words
    assert 'use roughness.detrend = "curvature", a la' in refusal(
        scan(tilted, levelling="tilt"), 2e-7
    )
    assert "; use a larger scan" in refusal(scan(tilted, levelling="curvature"), 2e-7)


def test_more_of_a_scan_is_advised_only_where_there_is_more():
    part = scan(np.zeros(COARSE.nodes), size_x_m=90e-6, size_y_m=90e-6)
    assert "a grid of about 53.7 um (the scan has 90 x 90)" in refusal(part, 1e-6)
    assert "a larger scan" in refusal(part, 4e-6)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (DomainError("5 N is too much", argument="force"), "load: 5 N is too much"),
        (NotConvergedError("1 m/s was not met", argument="velocity"), "impact: 1 m/s was not met"),
        (NotConvergedError("the solve at 3 nm: stopped"), "the solve at 3 nm: stopped"),
    ],
)
def test_arguments_of_solvers_become_keys(error, words):
    with pytest.raises(type(error)) as caught, naming_keys():
        raise error
    assert str(caught.value) == words
