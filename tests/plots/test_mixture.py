"""The figure of a mixture: every line has an entry in the legend, and headings stand once."""

from dataclasses import replace

import pytest

from restitution.plots.law import mixture_figure


@pytest.fixture
def sizes(law):
    """Laws of a sphere on walls, with different radii."""
    ball, wall = law().first, replace(law().first, name="wall", radius=None)

    def make(count):
        return [law(replace(ball, radius=1e-5 * 1.2**k), wall) for k in range(count)]

    return make


@pytest.mark.parametrize("count", [1, 6, 12, 40])
def test_every_line_has_a_legend_entry_and_a_name(sizes, count):
    (chart,) = mixture_figure("", sizes(count)).panels
    lines = chart.series
    assert len(lines) == count
    assert all(line.label and line.name.startswith("R* = ") for line in lines)
    own = [line for line in lines if line.label == line.name]
    assert len({(line.color, line.dash) for line in own}) == len(own)
    assert len(own) == count if count <= 12 else len(own) <= 12


def test_a_single_family_repeats_no_heading(sizes, law):
    (chart,) = mixture_figure("", sizes(3)).panels
    assert chart.title == ""
    charts = mixture_figure("", [*sizes(3), law()]).panels
    assert [chart.title for chart in charts] == ["glass on wall", "glass on glass"]


def test_charts_of_a_mixture_have_one_axis_of_restitution(sizes, law):
    charts = mixture_figure("", [*sizes(3), law()]).panels
    assert charts[0].y == charts[1].y
    (alone,) = mixture_figure("", sizes(3), [*sizes(3), law()]).panels
    assert alone.y == charts[0].y
