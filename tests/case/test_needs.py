"""Estimates of memory, and cases that are rejected because of them."""

import resource
import subprocess
import sys

import numpy as np
import pytest

from restitution.case import needs
from restitution.case.case_file import parse_case
from restitution.errors import CaseError
from restitution.numerics import memory
from restitution.numerics.grid import Grid

# VmHWM is the peak of this process alone; ru_maxrss starts at the size of its parent process.
PEAK = """
import sys
from restitution.cli import main
sys.argv = ["restitution", "run", sys.argv[1], "-o", sys.argv[2]]
try:
    main()
finally:
    status = open("/proc/self/status").read()
    print("peak", status.split("VmHWM:")[1].split()[0])
"""


@pytest.mark.programs
@pytest.mark.skipif(sys.platform != "linux", reason="sizes are those of Linux")
@pytest.mark.parametrize("yields", ['yield_pressure = "750 MPa"', 'yield_strength = "300 MPa"'])
@pytest.mark.parametrize("nodes", [128, 900])
def test_a_run_takes_what_was_estimated(case_text, tmp_path, nodes, yields):
    spacing = 43.2 / nodes
    text = case_text.replace("[72, 64]", str(nodes)).replace("steps = 4", "steps = 2")
    text = text.replace('["0.5 um", "0.6 um"]', f'"{spacing} um"')
    text = text.replace('yield_pressure = "750 MPa"', yields)
    (tmp_path / "case.toml").write_text(text)
    done = subprocess.run(
        [sys.executable, "-c", PEAK, tmp_path / "case.toml", tmp_path / "out"],
        capture_output=True,
        text=True,
        check=False,
    )
    peak = 1024 * int(done.stdout.split("peak ")[-1])
    estimate = parse_case(text).run_bytes(Grid((nodes, nodes), (1e-6, 1e-6)))
    assert 0.9 * peak < estimate < 1.5 * peak, done.stderr


def test_what_takes_more_costs_more(case_text):
    grid = Grid((1000, 1000), (1e-6, 1e-6))
    sizes = [
        parse_case(case_text.replace('yield_pressure = "750 MPa"', yields)).run_bytes(grid)
        for yields in (
            'yield_pressure = "elastic"',
            'yield_pressure = "750 MPa"',
            'yield_pressure = "750 MPa"\nwork_of_adhesion = "1 J/m^2"',
            'yield_pressure = "750 MPa"\nplasticity = "truncated"',
        )
    ]
    assert sizes == sorted(sizes)
    assert len(set(sizes)) == 4


@pytest.mark.parametrize("extend", ['extend = "twin"\nseed = 1', 'extend = "mirror"'])
@pytest.mark.parametrize("verb", ["check", "surface", "run", "converge"])
def test_every_verb_refuses_what_does_not_fit(
    refused, case_text, tmp_path, verb, extend, monkeypatch
):
    np.save(tmp_path / "scan.npy", 1e-8 * np.random.default_rng(1).standard_normal((40, 40)))
    begin, end = case_text.index("[roughness]"), case_text.index("[indentation]")
    rough = f'[roughness]\nkind = "measured"\nfile = "scan.npy"\nsize = "4 um"\n{extend}\n'
    grid = '[grid]\nnodes = 2500\nspacing = "0.2 um"\n'
    (tmp_path / "case.toml").write_text(case_text[:begin] + rough + grid + case_text[end:])
    monkeypatch.setattr(memory, "available", lambda: 0.4e9)
    out = () if verb == "check" else ("-o", tmp_path / "out")
    grids = ("--grids", "2") if verb == "converge" else ()
    message = refused(verb, tmp_path / "case.toml", *out, *grids)
    assert "nodes take about" in message
    assert "of memory, but only 400 MB is available; use fewer nodes" in message


def test_generated_surfaces_are_refused_before_they_are_made(case_text, tmp_path, monkeypatch):
    case = parse_case(case_text.replace("[72, 64]", "8000"))
    monkeypatch.setattr(memory, "available", lambda: 2e9)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for make in (case.surface, case.contact):
        with pytest.raises(CaseError, match=r"8000 x 8000 nodes take about .* GB of memory"):
            make(tmp_path)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < before + 50_000


def test_a_part_of_a_large_scan_takes_little():
    grid, scan = Grid((40, 40), (1e-6, 1e-6)), Grid((256, 256), (4e-8, 4e-8))
    program = needs._PROCESS
    assert needs.measured_bytes(grid, scan, twin=False) < program + 0.05e9
    assert needs.measured_bytes(grid, scan, twin=True) < program + 0.25e9
    huge = Grid((40, 40), (40e-6, 40e-6))  # 40 000 x 40 000 pixels, which are never made
    assert needs.measured_bytes(huge, scan, twin=True) < program + 0.25e9
