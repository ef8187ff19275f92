"""Case files with several scans of one surface."""

import os
from pathlib import Path

import numpy as np
import pytest

from restitution.case.case_file import parse_case
from restitution.errors import CaseError, SurfaceError
from restitution.surfaces.joined.advice import next_measurement
from restitution.surfaces.split import SplitSurface
from tolerance import approx
from virtual_instruments import KnownSurface

KNOWN = KnownSurface()
TOPOGRAPHIES = Path(__file__).parents[2] / "../shared/topographies"
EDGES = {"optical": 300e-6, "afm": 30e-6, "fine": 3e-6}
TABLES = "".join(
    f'[[roughness.scan]]\nfile = "{name}.npy"\nsize = "{1e6 * edge:g} um"\n'
    for name, edge in EDGES.items()
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("scans")
    for seed, (name, edge) in enumerate(EDGES.items()):
        np.save(path / f"{name}.npy", KNOWN.scan(edge, 128, seed).height)
    return path


def case(keys="", tables=TABLES, nodes=64, spacing="0.25 um", more=""):
    return parse_case(
        'first = { material = "steel", radius = "250 um" }\n'
        '[interface]\nwork_of_adhesion = "0 J/m^2"\nyield_pressure = "2.8 Y"\n'
        f'[grid]\nnodes = {nodes}\nspacing = "{spacing}"\n[impact]\nvelocity = ["1 m/s"]\n'
        f'{more}[roughness]\nkind = "joined"\n{keys}{tables}'
    )


def test_a_case_makes_twins_of_its_seeds(folder):
    read = case("seed = 3\n")
    made = read.surface(folder)
    assert made.provenance["kind"] == "twin of 3 scans"
    assert made.provenance["scan_2_name"] == "afm.npy"
    assert np.array_equal(made.height, read.surface(folder).height)
    other = read.variant(1).surface(folder)
    assert abs(np.corrcoef(other.height.ravel(), made.height.ravel())[0, 1]) < 0.5


def test_deviations_raise_the_spectrum(folder):
    plain, raised = (case(f"seed = 3\ndeviations = {number}\n") for number in (0.0, 2.0))
    assert raised.surface(folder).height.std() > 1.02 * plain.surface(folder).height.std()


def test_waves_below_the_grid_go_into_patches(folder):
    read = case('seed = 3\nbelow_grid = "patch"\nsplit = "1 um"\n')
    made = read.surface(folder)
    assert isinstance(made, SplitSurface)
    spectrum = read.roughness[0].spectrum(folder)
    patch = made.patches[0].grid
    assert patch.spacing[0] == approx(0.5 * spectrum.shortest)
    assert made.provenance["patch_slope"] == approx(
        spectrum.slope(spectrum.shortest, 1e-6), rel=0.2
    )


def test_patterns_and_tables_name_each_file_once(folder):
    """The table of a file takes precedence over a pattern that names it, too."""
    read = case('seed = 3\nscans = ["*.npy"]\n').roughness[0]
    assert sorted(path.name for path, _ in read.files(folder)) == [
        "afm.npy",
        "fine.npy",
        "optical.npy",
    ]
    assert all(table.size for _, table in read.files(folder))


@pytest.mark.parametrize(
    ("keys", "tables", "words"),
    [
        ("", TABLES, 'the key "roughness.seed" is missing'),
        ("seed = 1\n", "", r'roughness: give scans = \["\*.di"\], or tables'),
        ("seed = 1\ntip = 3\n", TABLES, "roughness.tip: unknown key"),
        ("seed = 1\n", TABLES + 'tip_radus = "3 nm"\n', 'roughness.scan.tip_radus: .*"tip_radius"'),
        ("seed = 1\n", TABLES + "resolution = 3\n", "roughness.scan.resolution: "),
    ],
)
def test_wrong_keys_are_named(keys, tables, words):
    with pytest.raises(CaseError, match=words):
        case(keys, tables)


def test_a_joined_surface_needs_a_grid():
    with pytest.raises(CaseError, match="grid"):
        parse_case(
            'first = { material = "steel", radius = "250 um" }\n[impact]\nvelocity = ["1 m/s"]\n'
            f'[roughness]\nkind = "joined"\nseed = 1\n{TABLES}'
        )


def refusal(read, folder):
    with pytest.raises(SurfaceError) as refused:
        read.surface(folder)
    assert "\n" not in str(refused.value)
    return str(refused.value)


def test_scans_without_overlap_name_the_key(folder):
    words = refusal(
        case(
            "seed = 1\n",
            "".join(TABLES.partition('[[roughness.scan]]\nfile = "afm')[:1])
            + TABLES[TABLES.rindex("[[roughness.scan]]") :],
        ),
        folder,
    )
    assert words.startswith("roughness.bridge: optical.npy and fine.npy: do not overlap")


def test_heights_in_another_unit_contradict(folder):
    tables = TABLES.replace('size = "30 um"', 'size = "30 um"\nheight_unit = "mm"')
    words = refusal(case("seed = 1\n", tables), folder)
    assert "contradict each other" in words
    assert "correct the unit of the heights" in words


def test_a_scan_without_its_size_names_the_key(folder):
    words = refusal(case('seed = 1\nscans = ["afm.npy"]\n', ""), folder)
    assert "does not contain the size of the scan" in words
    missing = refusal(case('seed = 1\nscans = ["no.npy"]\n', ""), folder)
    assert "no.npy: there is no such file" in missing


def test_the_tip_and_the_resolution_cut_off_waves(folder):
    def shortest(line):
        tables = f"{TABLES}{line}\n"
        return case("seed = 1\n", tables).roughness[0].spectrum(folder).shortest

    assert shortest('resolution = "200 nm"') == approx(200e-9)
    assert shortest('tip_radius = "1 nm"') == approx(2 * 3e-6 / 128)
    assert shortest('tip_radius = "200 nm"') > 60e-9


def test_the_next_measurement_fills_a_gap(folder):
    tables = TABLES.replace(
        TABLES[TABLES.index('[[roughness.scan]]\nfile = "afm') : TABLES.rindex("[[r")], ""
    )
    spectrum = case("seed = 1\nbridge = true\n", tables).roughness[0].spectrum(folder)
    ((low, high),) = spectrum.gaps
    further = next_measurement(spectrum, 1e-6, 6e-6)
    assert further.shortest < high
    assert further.longest > low
    assert "microscope" in str(further)


def test_the_next_measurement_shows_shorter_waves_if_the_contact_uses_all(folder):
    spectrum = case("seed = 1\n").roughness[0].spectrum(folder)
    further = next_measurement(spectrum, spectrum.shortest, 30e-6)
    assert further.longest == approx(spectrum.shortest)
    longer = next_measurement(spectrum, 10e-6, 1e-2)
    assert longer.longest > 1e-4


@pytest.mark.skipif(not TOPOGRAPHIES.is_dir(), reason="no ../shared/topographies")
def test_real_scans_of_different_surfaces_contradict():
    pytest.importorskip("SurfaceTopography")
    tables = (
        '[[roughness.scan]]\nfile = "mi-1.mi"\n[[roughness.scan]]\nfile = "matrix-3.txt"\n'
        'size = "10 um"\n'
    )
    words = refusal(case("seed = 1\n", tables), TOPOGRAPHIES)
    assert "mi-1.mi and matrix-3.txt: contradict each other" in words


CONTAINERS = Path(os.environ.get("SURFACE_TOPOGRAPHY_EXAMPLES", "absent"))


@pytest.mark.skipif(
    not (CONTAINERS / "container-2.zip").is_file(),
    reason="SURFACE_TOPOGRAPHY_EXAMPLES does not name test/file_format_examples of "
    "SurfaceTopography",
)
def test_a_real_container_of_an_afm_a_stylus_and_an_electron_microscope():
    """Its scans leave waves from 0.1 to 0.2 µm out; the AFM states its own scale of heights."""
    pytest.importorskip("SurfaceTopography")
    keys = 'seed = 1\nscans = ["container-2.zip"]\n'
    assert "do not overlap" in refusal(case(keys, ""), CONTAINERS)
    read = case(f"{keys}bridge = true\n", "")
    spectrum = read.roughness[0].spectrum(CONTAINERS)
    assert [scan.line for scan in spectrum.scans] == [True, True, False]
    afm = next(scan for scan in spectrum.spectra if not scan.line)
    assert np.sqrt(afm.variance) == approx(3.76e-9, rel=0.01)
    (overlap,) = spectrum.overlaps
    assert 0.5 < overlap.ratio < 2
    assert read.surface(CONTAINERS).height.std() > 1e-9
