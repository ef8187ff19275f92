"""`restitution surface`: describe the generated or measured surface of a case."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import xarray as xr
from rich.table import Column, Table

from restitution.case import needs
from restitution.case.case_file import naming, read_case
from restitution.cli.console import command, errors, print_numbers, say, say_next, say_written, warn
from restitution.cli.parameters import FigureFormat
from restitution.display import counted, quantity
from restitution.pages.page import Cell
from restitution.pages.scans import of_scans
from restitution.pages.surface import PARAMETERS, scaled_parameter, write_surface_page
from restitution.plots.joined import joined_figure
from restitution.plots.static import write_figure, write_figures
from restitution.plots.surface import surface_map
from restitution.results.interruption import hold_signals
from restitution.results.locking import locked
from restitution.results.writer import ResultsFolder, write_checksums, write_json, write_netcdf
from restitution.runs.messages import surface_warnings
from restitution.surfaces import describe
from restitution.surfaces.texture import texture


def surface(case: Path, out: Path, figures: FigureFormat) -> None:
    read, text = read_case(case)
    with naming(case), errors.status("making the surface"):
        made = read.surface(case.parent)
        joined = [
            part.spectrum(case.parent).told() for part in read.roughness if part.kind == "joined"
        ]
        needs.require(needs.described_bytes(made.grid), made.grid)
    with locked(out):
        ResultsFolder(out)
        with errors.status("describing the surface"):
            statistics = describe(made) | texture(made)
            warnings = surface_warnings(made, math.inf if read.periodic else read.pair().radius)
        hx, hy = made.grid.spacing
        provenance = {**made.provenance, "spacing_x_m": hx, "spacing_y_m": hy}
        labels = {"units": "m", "long_name": "composite roughness"}
        dataset = xr.Dataset(
            {"height": (("x", "y"), made.height, labels)},
            {"x": ("x", made.grid.x, {"units": "m"}), "y": ("y", made.grid.y, {"units": "m"})},
            {"title": read.title, "case": text, **provenance},
        )
        with errors.status("writing the results"):
            with hold_signals():
                write_netcdf(out / "surface.nc", dataset)
                content: dict[str, Any] = {
                    **statistics,
                    "warnings": warnings,
                    "provenance": provenance,
                }
                content |= {"joined_spectra": joined} if joined else {}
                write_json(out / "statistics.json", content)
                write_checksums(out, ["statistics.json", "surface.nc"])
            picture = write_figure(out / "surface", surface_map(made, read.title), figures.value)
            drawn = [
                (f"joined-spectrum{f'-{number}' if number > 1 else ''}", joined_figure(told, made))
                for number, told in enumerate(joined, 1)
            ]
            pictures = [picture, *write_figures(out, drawn, figures.value)]
            write_surface_page(out)

    table = Table("", Column(justify="right"), "", box=None, show_header=False)
    for key, (name, _, unit, *_) in PARAMETERS.items():
        value = scaled_parameter(key, statistics)
        shown = "-" if value is None else f"{value:.4g} {unit}"
        if value is not None and unit in ("nm", "µm"):
            shown = quantity(statistics[key], "m")  # the range of lengths is wide
        table.add_row(name, *shown.split(" ", 1))
    print_numbers(table)
    for parts in of_scans(provenance):
        print_numbers(_scans(parts.rows))
    for key, told in provenance.items():
        if key.endswith("information"):
            say(f"The surface is {told}.")
    for line in _about_scans(provenance):
        say(line)
    for warning in warnings:
        warn(warning)
    names = [file.name for file in pictures]
    say_written(out, ["surface.nc", "statistics.json", *names, "surface.html"])
    say_next(command("run", case, "-o", "OUT"))


def _scans(rows: Sequence[Sequence[Cell]]) -> Table:
    table = Table("scan", "waves", "", "ends at", Column("Rq", justify="right"), box=None)
    for name, _, _, _, shortest, longest, ends, rms, _ in rows:
        table.add_row(*map(str, (name, shortest, f"to {longest}", ends, rms)))
    return table


def _about_scans(provenance: dict[str, str | float]) -> Iterator[str]:
    """Yield what reading and cleaning found in each scan: channel, outliers and curvature."""
    for key, file in provenance.items():
        before = key.removesuffix("file")  # "", or "part_1_" in a composite surface
        if before == key:
            continue
        if others := provenance.get(f"{before}other_height_channels"):
            number, name = (provenance[f"{before}{key}"] for key in ("channel", "channel_name"))
            yield (
                f"{file}: the heights are those of channel {number} ('{name}'); roughness.channel "
                f"selects another height channel: {others}"
            )
        if count := provenance.get(f"{before}outliers"):
            yield f"{file}: {counted(int(count), 'outlier')} replaced"
        if radius := provenance.get(f"{before}subtracted_radius_m"):
            yield _curvature(str(file), float(radius))


def _curvature(file: str, radius: float) -> str:
    form = "hollow" if radius < 0 else "sphere"
    return (
        f"{file}: the subtracted paraboloid is as curved as a {form} with a radius of "
        f"{quantity(abs(radius), 'm')}. If this is not the radius of the scanned particle, check "
        "the units of the scan, or whether the instrument has flattened it."
    )
