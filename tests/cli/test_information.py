"""What a case may leave out without harm is information, not a warning."""

import json


def test_a_yield_strength_of_the_library_is_information_and_no_warning(cli, tmp_path):
    case = tmp_path / "case.toml"
    case.write_text(
        'total_error = false\nfirst = { material = "steel", radius = "200 um" }\n'
        'interface = { work_of_adhesion = "0 J/m^2" }\n'
        'grid = { nodes = 32, spacing = "0.5 um" }\nindentation = { values = ["50 nm"] }\n'
        "unloading = { curves = 0 }\n"
    )
    line = (
        "The contact yields according to Y of first (steel), 3300 MPa (H/2.4, from rebound tests); "
        "interface.yield_strength"
    )
    status, said, warned = cli("check", case)
    assert status == 0
    assert line in said
    assert "yield" not in warned
    status, _, told = cli("run", case, "-o", tmp_path / "out")
    assert status == 0
    assert f"\n{line}" in told
    assert not [text for text in told.splitlines() if "Warning" in text and "yield" in text]
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert not [text for text in summary["warnings"] if "yield" in text]
    assert cli("report", tmp_path / "out")[0] == 0
    page = (tmp_path / "out" / "report.html").read_text()
    assert f'<p class="soft">{line}' in page
