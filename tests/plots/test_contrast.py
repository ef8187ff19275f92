"""Colours of figures on light and dark pages: WCAG 2.2, 1.4.11 requires a contrast of 3:1."""

import re
from pathlib import Path

import numpy as np
import pytest

import restitution
from restitution.plots.figure import GREY, PALETTE, Axis, Band, Chart, Figure
from restitution.plots.interactive import draw
from restitution.plots.law import LAW_LINES

PACKAGE = Path(restitution.__file__).parent
PAGES = ("pages/templates/page.html", "app/static/app.css")
PAPERS = {
    (page, paper)
    for page in PAGES
    for paper in re.findall(r"--paper: (#\w{6})", (PACKAGE / page).read_text())
}


def luminance(colour):
    """Relative luminance, WCAG 2.2."""
    parts = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def contrast(one, other):
    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


def test_the_contrast_of_black_and_white_is_21():
    assert round(contrast("#000000", "#ffffff"), 6) == 21
    assert contrast("#777777", "#ffffff") < 4.5 < contrast("#767676", "#ffffff")


def test_pages_have_a_light_and_a_dark_paper():
    for page in PAGES:
        light, dark = sorted((paper for of, paper in PAPERS if of == page), key=luminance)[::-1][:2]
        assert luminance(dark) < 0.1 < 0.9 < luminance(light)


@pytest.mark.parametrize("colour", [*PALETTE, GREY])
def test_curves_stand_out_on_every_page(colour):
    assert min(contrast(colour, paper) for _, paper in PAPERS) >= 3


@pytest.mark.parametrize("name", LAW_LINES)
def test_lines_of_laws_stand_out_on_white(name):
    assert contrast(LAW_LINES[name][0], "#ffffff") >= 3


def test_bands_have_edges_in_the_colour_of_a_curve():
    X = np.array([1.0, 2.0])
    chart = Chart(Axis("x"), Axis("y"), [Band(X, X, 2 * X, "band", PALETTE[1], (1, 2))])
    low, high = draw(chart, Figure("", [chart])).data
    for edge in (low, high):
        assert (edge.line.color, edge.line.width) == (PALETTE[1], 1)
        assert edge.line.dash == "1px,2px"
