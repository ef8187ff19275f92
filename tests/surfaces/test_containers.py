"""Containers of contact.engineering, folders and line scans as parts of a joined spectrum."""

import zipfile

import numpy as np
import pytest

from restitution.errors import SurfaceError
from restitution.surfaces.joined.join import join
from restitution.surfaces.joined.read import HowToRead, matching, read_spectra
from restitution.surfaces.reading.containers import contents, is_container
from restitution.surfaces.reading.line_scans import read_line
from tolerance import approx
from virtual_instruments import KnownSurface

KNOWN = KnownSurface()


def matrix(surface, unit=1e9):
    """The heights as text, a scan line of constant y on each line."""
    return "\n".join(" ".join(f"{unit * z:.6g}" for z in line) for line in surface.height.T)


def columns(line, unit=1e6):
    x = np.arange(line.grid.nodes[0]) * line.grid.spacing[0]
    return "\n".join(
        f"{unit * a:.9g}\t{unit * b:.9g}" for a, b in zip(x, line.height[:, 0], strict=True)
    )


def meta(*scans):
    told = "\n".join(f"  - {entry}" for entry in scans)
    return f"versions: {{topobank: 1.0}}\nsurfaces:\n- name: wall\n  topographies:\n{told}\n"


OPTICAL = (
    '{name: optical, datafile: {original: "1.txt"}, size: !!python/tuple [300.0, 300.0], '
    "unit: µm, height_scale: 1.0e-3, is_periodic: false, instrument: {parameters: {resolution: "
    "{value: 8, unit: µm}}}}"
)
AFM = (
    '{name: afm, datafile: {original: "2.txt"}, size: [30000.0, 30000.0], unit: nm, instrument: '
    "{parameters: {tip_radius: {value: 10, unit: nm}}}}"
)
STYLUS = '{name: stylus, datafile: {original: "3.txt"}, size: [200.0], unit: µm}'


@pytest.fixture(scope="module")
def members():
    return {
        "1.txt": matrix(KNOWN.scan(300e-6, 96, 1)),
        "2.txt": matrix(KNOWN.scan(30e-6, 96, 2)),
        "3.txt": columns(KNOWN.line(200e-6, 2000, 3)),
    }


@pytest.fixture
def container(tmp_path, members):
    pytest.importorskip("yaml")

    def call(told, files=members):
        path = tmp_path / "wall.zip"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("meta.yml", told)
            for name, text in files.items():
                archive.writestr(name, text)
        return path

    return call


def test_a_container_has_sizes_units_scales_and_resolutions(container):
    """The heights of the first are in nm: 10⁻³ of the unit of its size."""
    path = container(meta(OPTICAL, AFM, STYLUS))
    optical, afm, stylus = read_spectra(path, HowToRead())
    assert [scan.name for scan in (optical, afm, stylus)] == ["optical", "afm", "stylus"]
    assert (optical.edge, afm.edge) == approx((300e-6, 30e-6))
    assert (optical.shortest, optical.why) == (approx(8e-6), "stated resolution")
    for scan in (optical, afm):
        assert 60e-9 < np.sqrt(scan.variance) < 160e-9
    assert stylus.line
    assert stylus.edge == approx(200e-6, rel=1e-3)
    joined = join([optical, afm, stylus])
    q = 2 * np.pi / 5e-6
    assert joined.at(np.array([q]))[0] == approx(KNOWN.density(q), rel=0.35)


def test_an_unpacked_container_is_a_folder(container, tmp_path):
    path = container(meta(AFM))
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path / "open")
    assert is_container(tmp_path / "open")
    (scan,) = read_spectra(tmp_path / "open", HowToRead())
    assert scan.edge == approx(30e-6)
    assert (tmp_path / "open" / "2.txt").exists()


def test_scans_of_a_container_are_chosen_by_name(container):
    path = container(meta(OPTICAL, AFM))
    assert [scan.name for scan in read_spectra(path, HowToRead(only="a*"))] == ["afm"]
    with pytest.raises(SurfaceError, match=r"only: 'x' matches no scan of .*: optical, afm"):
        list(read_spectra(path, HowToRead(only="x")))


def test_one_of_several_surfaces_is_chosen(container):
    other = meta(OPTICAL).partition("surfaces:\n")[2]
    path = container(meta(AFM) + other)
    with pytest.raises(SurfaceError, match=r"surface: .* holds 2 surfaces; choose one: 0 "):
        contents(path)
    assert [scan.name for scan in contents(path, 1)] == ["optical"]
    with pytest.raises(SurfaceError, match="has no surface 2; it holds 2"):
        contents(path, 2)


def damaged(path):
    """Change a byte of the data of the last member."""
    raw = bytearray(path.read_bytes())
    raw[raw.rindex(b"PK\x01\x02", 0, raw.index(b"PK\x01\x02") + 4) - 40] ^= 0xFF
    path.write_bytes(raw)


def test_a_damaged_member_is_named(container, members):
    path = container(meta(AFM), {"2.txt": members["2.txt"]})
    damaged(path)
    with pytest.raises(SurfaceError, match=r"wall\.zip: its member .2\.txt. is damaged .*export"):
        list(read_spectra(path, HowToRead()))


def test_a_member_without_heights_is_named(container):
    path = container(meta(AFM), {"2.txt": "no heights at all\n"})
    with pytest.raises(SurfaceError, match=r"wall\.zip: ") as refused:
        list(read_spectra(path, HowToRead()))
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("told", "words"),
    [
        (meta(AFM.replace("2.txt", "9.txt")), 'lacks its member "9.txt"'),
        (meta(AFM.replace("unit: nm, ", "unit: V, ")), '"afm" is in "V", which is not a unit'),
        (meta(AFM.replace("datafile: {original: ", "files: {a: ")), "has no data file"),
        ("surfaces: 3", "its meta.yml is damaged"),
        ("a: [", "its meta.yml is damaged"),
    ],
)
def test_a_damaged_container_is_one_clear_line(container, told, words):
    with pytest.raises(SurfaceError) as refused:
        list(read_spectra(container(told), HowToRead()))
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_container_that_surface_topography_wrote(tmp_path):
    surface_topography = pytest.importorskip("SurfaceTopography")
    from SurfaceTopography.Container.IO.CE import write_containers
    from SurfaceTopography.Container.SurfaceContainer import InMemorySurfaceContainer

    known = KNOWN.scan(30e-6, 64, 2)
    topography = surface_topography.Topography(
        1e9 * known.height, physical_sizes=(30e3, 30e3), unit="nm"
    )
    path = tmp_path / "made.zip"
    write_containers([InMemorySurfaceContainer([topography])], path)
    (scan,) = read_spectra(path, HowToRead(detrend="center"))
    assert scan.edge == approx(30e-6)
    assert scan.surface.height == approx(known.height - known.height.mean(), rel=1e-6, abs=1e-15)


def test_a_file_with_its_own_scale_is_not_scaled_twice(tmp_path, members):
    """Topobank repeats the scale of such files in `meta.yml`."""
    pytest.importorskip("yaml")
    text = f"# Width: 30 µm\n# Height: 30 µm\n# Value units: nm\n{members['2.txt']}"
    path = tmp_path / "wall.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("meta.yml", meta(AFM.replace("unit: nm", "unit: nm, height_scale: 0.11")))
        archive.writestr("2.txt", text)
    (scan,) = read_spectra(path, HowToRead())
    assert 60e-9 < np.sqrt(scan.variance) < 160e-9


def test_patterns_and_folders_name_files(tmp_path):
    for name in ("b.txt", "a.txt", "notes.md", ".hidden"):
        (tmp_path / name).write_text("1\n")
    assert [path.name for path in matching(tmp_path, "*.txt")] == ["a.txt", "b.txt"]
    assert [path.name for path in matching(tmp_path.parent, tmp_path.name)] == ["a.txt", "b.txt"]
    with pytest.raises(SurfaceError, match=r"\*\.spm: there is no such file"):
        matching(tmp_path, "*.spm")


class TestLineScans:
    def read(self, tmp_path, text, **how):
        (tmp_path / "line.txt").write_text(text)
        return read_line(tmp_path / "line.txt", **how)

    def test_positions_and_heights_are_in_one_unit(self, tmp_path):
        line = KNOWN.line(200e-6, 400, 3)
        read = self.read(tmp_path, "x z\n" + columns(line), unit="um")
        assert read.grid.nodes == (400, 1)
        assert read.grid.spacing[0] == approx(0.5e-6)
        assert read.height == approx(line.height, rel=1e-5, abs=1e-14)

    def test_a_length_replaces_positions(self, tmp_path):
        read = self.read(tmp_path, "\n".join(map(str, range(40))), unit="nm", size=20e-6)
        assert read.grid.size[0] == approx(20e-6)
        assert np.ptp(read.height) == approx(39e-9)

    def test_uneven_points_are_interpolated(self, tmp_path):
        x = np.cumsum(np.random.default_rng(1).uniform(0.5, 1.5, 60))
        read = self.read(tmp_path, "\n".join(f"{a} {2 * a}" for a in x), unit="um")
        assert np.diff(read.height[:, 0]) == approx(2 * read.grid.spacing[0])
        assert read.provenance["largest_step_m"] == approx(1e-6 * np.diff(x).max())

    def test_missing_points_are_interpolated(self, tmp_path):
        rows = [f"{k} {'nan' if k in (7, 8) else 3 * k}" for k in range(40)]
        read = self.read(tmp_path, "\n".join(rows), unit="um")
        assert read.provenance["undefined_pixels"] == 2
        assert read.height[8, 0] == approx(24e-6, rel=0.03)

    @pytest.mark.parametrize(
        ("text", "how", "words"),
        [
            ("1 2\n" * 30, {}, "height_unit: .* does not state its unit"),
            ("1 2\n" * 30, {"unit": "um"}, "positions do not increase"),
            ("1 2\n" * 3, {"unit": "um"}, "has 3 points, but a line scan needs 16"),
            ("1\n" * 30, {"unit": "um"}, "size: .* heights without positions"),
            ("1 2\n3 x\n", {"unit": "um"}, 'line 2, "3 x", is not a point'),
            ("1 2\n3 4 5\n", {"unit": "um"}, "line 2 has 3 values"),
        ],
    )
    def test_what_is_no_line_scan_is_refused(self, tmp_path, text, how, words):
        with pytest.raises(SurfaceError, match=words):
            self.read(tmp_path, text, **how)

    def test_a_gap_in_positions_is_refused(self, tmp_path):
        x = [*range(30), *range(2000, 2030)]
        with pytest.raises(SurfaceError, match="no points from"):
            self.read(tmp_path, "\n".join(f"{a} {a % 3}" for a in x), unit="um")


def test_a_line_whose_positions_have_another_unit_is_refused(tmp_path):
    """Positions in µm and heights in nm, but one unit for both."""
    x, z = np.linspace(0, 15, 200), 150 * np.sin(np.linspace(0, 30, 200))
    np.savetxt(tmp_path / "line.txt", np.c_[x, z])
    with pytest.raises(SurfaceError, match=r"line\.txt: its heights span .* different units"):
        read_line(tmp_path / "line.txt", unit="nm")
    line = read_line(tmp_path / "line.txt", unit="nm", size=15e-6)
    assert np.ptp(line.height) == approx(300e-9, rel=0.01)
