"""The pictures of the page: contrast, ticks, legend, bands and jumps."""

import re

import pytest

from app_page import computed, expect, rest

# The traces of a plot as it is drawn.
TRACES = "(id) => document.getElementById(id).data.map(({ x, y, ...t }) => t)"
# The contrast of two colours as WCAG 2.1 defines it; the page's paper is the second.
CONTRAST = """(colour) => {
  const pen = document.createElement("canvas").getContext("2d");
  const light = (words) => {
    pen.fillStyle = words; pen.fillRect(0, 0, 1, 1);
    const linear = (c) => (c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
    const [r, g, b] = [...pen.getImageData(0, 0, 1, 1).data].map(linear);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const [a, b] = [colour, getComputedStyle(document.body).backgroundColor].map(light);
  return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
}"""
LEAST = 3.0  # contrast of graphical objects, WCAG 2.1 AA, 1.4.11


def colours(page, plot):
    """The colours of lines, markers and edges of bands of a plot."""
    for trace in page.evaluate(TRACES, plot):
        line = trace.get("line", {})
        if "lines" in trace.get("mode", "") and line.get("width", 1) > 0:
            yield line["color"]
        if "markers" in trace.get("mode", ""):
            yield trace["marker"]["color"]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_curves_and_bands_have_enough_contrast(app, open_page, scheme):
    page = open_page(app.address, color_scheme=scheme)
    rest(page)
    page.evaluate("for (let k = 0; k < 5; k++) document.getElementById('pin').click()")
    expect(page.locator("#cor .legendtext", has_text="pin 5")).to_have_count(1)
    drawn = {*colours(page, "cor"), *colours(page, "force")}
    assert len(drawn) > 7
    low = {one: page.evaluate(CONTRAST, one) for one in drawn}
    assert {one: ratio for one, ratio in low.items() if ratio < LEAST} == {}


def test_the_band_of_the_model_is_not_that_of_the_total_error(page):
    rest(page)
    traces = page.evaluate(TRACES, "cor")
    (band,) = [trace for trace in traces if trace.get("fill") == "tonexty"]
    (points,) = [trace for trace in traces if trace.get("error_y")]
    assert band["line"]["color"] != points["marker"]["color"]
    assert band["line"]["dash"] == "dot"


@pytest.mark.parametrize("view", ["velocity", "indentation"])
def test_ticks_of_logarithmic_axes_have_prefixes(page, view):
    computed(page)
    page.get_by_role("radio", name=f"against {view}").check()
    unit = "m/s" if view == "velocity" else "m"
    expect(page.locator("#cor .xtitle")).to_have_text(re.compile(r"^[^()]*$"))
    texts = page.locator("#cor .xtick text").all_text_contents()
    assert len(texts) >= 2
    assert all(re.fullmatch(rf"\d+ [nµm]?{unit}", text) for text in texts), texts


def test_forces_are_drawn_in_a_unit_that_suits_them(page):
    computed(page)
    title = page.locator("#force .ytitle").text_content()
    largest = max(
        float(row.locator("td").nth(2).get_attribute("data-value"))
        for row in page.locator("#numbers tbody tr").all()
    )
    scale = {"nN": 1e-9, "µN": 1e-6, "mN": 1e-3, "N": 1.0}[re.search(r"\((.*)\)", title)[1]]
    assert 1 <= largest / scale < 1000
    ticks = page.locator("#force .ytick text").all_text_contents()
    assert all(re.fullmatch(r"−?[\d.]+", tick) for tick in ticks), ticks


@pytest.mark.parametrize("width", [390, 820, 1440])
def test_a_legend_explains_the_lines_on_every_width(app, open_page, width):
    page = open_page(app.address, viewport={"width": width, "height": 900})
    computed(page)
    own = page.locator("#cor-legend li" if width < 600 else "#cor .legendtext")
    expect(own.filter(has_text="this contact")).to_have_count(1)
    expect(own.filter(has_text="error of the model").first).to_be_visible()


def test_only_useful_buttons_are_on_a_plot(page):
    computed(page)
    names = [
        button.get_attribute("data-title") for button in page.locator("#cor .modebar-btn").all()
    ]
    assert names == ["Download plot as a PNG", "Zoom", "Pan", "Reset axes"]


def test_a_curve_that_leaves_zero_jumps(page):
    """The curve of rows of which some stick, in both views."""
    computed(page)
    drawn = page.evaluate(
        """async () => {
          const { state } = await import("./state.js");
          const { drawCurves } = await import("./curves.js");
          const rows = state.curve.rows.map((row, k) => ({ ...row, restitution: k < 3 ? 0 : 0.8 }));
          const data = state.curve.figures.indentation.data.map((trace) =>
            (trace.mode === "lines+markers"
              ? { ...trace, y: rows.map((row) => row.restitution) } : trace));
          state.curve.rows = rows;
          state.curve.figures.indentation.data = data;
          document.querySelector("input[value=indentation]").checked = true;
          drawCurves();
          const line = document.getElementById("cor").data.find(
            ({ mode, x, y }) => mode === "lines" && Array.isArray(x) && y.includes(0.8));
          return { x: [...line.x], y: [...line.y] };
        }"""
    )
    first = drawn["y"].index(0.8)
    assert drawn["y"][first - 1] == 0
    assert drawn["x"][first - 1] == drawn["x"][first]


@pytest.mark.parametrize("width", [700, 820, 1440])
def test_the_legend_leaves_the_title_of_the_axis_free(app, open_page, width):
    page = open_page(app.address, viewport={"width": width, "height": 900})
    rest(page)
    title, legend = (
        page.locator(f"#cor {part}").bounding_box() for part in (".xtitle", ".legend .bg")
    )
    assert legend["y"] >= title["y"] + title["height"]
