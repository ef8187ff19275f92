import numpy as np
import pytest

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.plots.surface import surface_map
from restitution.surfaces import Surface, composite, describe, generate_surface
from tolerance import approx

GRID = Grid((128, 128), (0.25e-6, 0.25e-6))


def rough(seed, rms=1e-7):
    return generate_surface(GRID, kind="gaussian", rms=rms, correlation_length=2e-6, seed=seed)


def test_the_gap_is_that_of_both_and_mean_squares_add():
    both = composite([rough(1), rough(2, 0.5e-7)])
    assert np.array_equal(both.height, rough(1).height + rough(2, 0.5e-7).height)
    assert describe(both)["Sq_m"] == approx(np.hypot(1e-7, 0.5e-7), rel=0.03)
    assert both.provenance["source"] == "composite"
    assert both.provenance["part_1_seed"] == 1
    assert both.provenance["part_2_rms_m"] == 0.5e-7
    assert both.provenance["periodicity"].startswith("periodic")


def test_what_the_program_asks_for_is_that_of_the_parts():
    first = Surface(np.zeros(GRID.nodes), GRID, {"file": "a.npy", "pixel_x_m": 2e-7, "notice": "A"})
    second = Surface(np.zeros(GRID.nodes), GRID, {"file": "b.npy", "pixel_x_m": 3e-7})
    both = composite([first, rough(1), second]).provenance
    assert both["file"] == "a.npy, b.npy"
    assert both["pixel_x_m"] == 3e-7
    assert both["notice"] == "A"
    assert "periodicity" not in both


def test_one_is_itself_and_none_or_two_grids_are_refused():
    one = rough(1)
    assert composite([one]) is one
    with pytest.raises(SurfaceError, match=r"^surfaces: the sequence is empty"):
        composite([])
    other = Surface(np.zeros((4, 4)), Grid((4, 4), (1.0, 1.0)))
    with pytest.raises(SurfaceError, match="different grids"):
        composite([one, other])


def test_what_the_grid_does_not_carry_of_the_parts():
    height = np.zeros(GRID.nodes)
    parts = [
        {"removed_slope": 0.2, "removed_rms_m": 3e-9, "shortest_carried_m": 1e-6},
        {"kind": "gaussian"},
        {"removed_slope": 0.1, "removed_rms_m": 4e-9, "shortest_carried_m": 2e-6},
    ]
    told = composite([Surface(height, GRID, part) for part in parts]).provenance
    assert told["removed_slope"] == 0.2
    assert told["removed_rms_m"] == approx(5e-9, abs=0)
    assert told["shortest_carried_m"] == 2e-6
    assert "removed_slope" not in composite([Surface(height, GRID)] * 2).provenance


def test_maps_of_a_sum_with_a_scan_are_drawn_as_those_of_the_scan():
    scan = Surface(np.zeros(GRID.nodes), GRID, {"y_axis": "down"})
    for parts in ([scan, scan], [rough(1), scan]):
        both = composite(parts)
        assert both.provenance["y_axis"] == "down"
        assert surface_map(both).panels[0].downwards
    assert "y_axis" not in composite([rough(1), rough(2)]).provenance
