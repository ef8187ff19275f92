"""`restitution check`: validate a case or study and print derived quantities; solve nothing."""

from __future__ import annotations

from pathlib import Path

from rich.table import Column, Table

from restitution.case.below_grid import notice_of, refines_for_patches
from restitution.case.case import Case
from restitution.case.case_file import naming, parse_case, parse_toml, read_text
from restitution.case.derived import deepest_indentation, derived_quantities
from restitution.case.labels import LABELS
from restitution.case.omissions import default_yield
from restitution.cli.console import command, errors, print_numbers, say, say_next, warn
from restitution.contact.contact import Contact
from restitution.contact.patch.law import law_of_patches
from restitution.numerics.memory import available, in_words
from restitution.runs.losses import loss_information, loss_warnings
from restitution.runs.messages import failure_at_edge, input_warnings, no_range, require_possible
from restitution.runs.refinement import least_refined
from restitution.runs.two_scales import REFINED, cost_in_words
from restitution.surfaces import describe
from restitution.surfaces.joined.advice import next_measurement
from restitution.sweeps.sweep import parse_study


def check(case: Path) -> None:
    given, cases = _read(case)
    warnings: list[str] = []
    with naming(case), errors.status("making the surface"):
        read = least_refined(given, case.parent, warnings.append)
        contact = read.contact(case.parent)
        refined = refines_for_patches(read, case.parent)
        table = _table(read, contact, auto=refined or given.grid.refine == "auto")
    print_numbers(table)
    if information := default_yield(read.yielding().source):
        say(information)
    if information := loss_information(read):
        say(information)
    deepest = deepest_indentation(read)
    require_possible(contact, deepest)
    with errors.status("checking the surface"):
        warnings += input_warnings(contact, deepest, read.prescribed)
        warnings += loss_warnings(read)
        if read.interface.adhesion is None and contact.adhesive:
            warnings += no_range(contact)
        if not refined and (notice := notice_of(read, case.parent)) is not None:
            warnings.append(notice)
    if law := law_of_patches(contact):
        say(cost_in_words(law))
    if refined:
        say(REFINED)
    for number, part in enumerate(read.roughness, 1):
        if part.kind == "joined":
            before = f"part_{number}_" if len(read.roughness) > 1 else ""
            joined, told = part.spectrum(case.parent), contact.surface.provenance
            carried = 2 * max(contact.grid.spacing)
            shortest = joined.shortest if "split_m" in told else carried
            further = next_measurement(joined, shortest, 2 * max(contact.grid.size))
            say(f"The surface is {told[before + 'information']}.")
            say(f"Next measurement: {further}.")
    for warning in warnings:
        warn(warning)
    ending = ", with warnings." if warnings else "."
    if cases:
        say(f"The study of {cases} cases is valid{ending} The table describes its first case.")
    else:
        say(f"The case is valid{ending}")
    if failure := failure_at_edge(contact, deepest, read.prescribed):
        say(failure)
    else:
        say_next(command("study" if cases else "run", case, "-o", "OUT"))


def _read(path: Path) -> tuple[Case, int]:
    """Return the case in `path` and 0, or the first case of a study and its number of cases."""
    text = read_text(path)
    with naming(path):
        if "sweep" not in parse_toml(text):
            return parse_case(text), 0
        study = parse_study(text)
        return parse_case(study.cases[0].text), len(study.cases)


def _table(case: Case, contact: Contact, *, auto: bool) -> Table:
    table = Table("", Column(justify="right"), "", box=None, show_header=False)
    nx, ny = contact.grid.nodes
    hx, hy = contact.grid.spacing
    more = ', or more (refine = "auto")' if auto else ""
    table.add_row("grid", f"{nx} x {ny}", f"nodes of {1e6 * hx:.6g} um x {1e6 * hy:.6g} um{more}")
    provenance = contact.surface.provenance
    kind = provenance.get("kind") or provenance["source"]
    rms = describe(contact.surface)["Sq_m"] or 0.0
    table.add_row("surface", f"{1e6 * rms:.4g}", f"um Sq, {kind}")
    if case.realisations > 1:
        table.add_row("realisations", str(case.realisations), "surfaces; the first is described")
    quantities = derived_quantities(case, contact)
    for key, (label, scale, unit) in LABELS.items():
        if key not in quantities or (key == "yield_strength_Pa" and quantities[key] is None):
            continue
        value = quantities[key]
        if key == "deepest_indentation_m" and case.indentation is None:
            label += ", estimated"
        table.add_row(label, "-" if value is None else f"{scale * value:.5g}", unit)
    if maps := case.maps_bytes(contact.grid):
        depths = len(case.depths())
        table.add_row("maps of all depths, at most", in_words(maps), f"for {depths} depths")
    needed = in_words(case.run_bytes(contact.grid))
    table.add_row("memory of a run, at most", needed, f"of {in_words(available())}{more}")
    return table
