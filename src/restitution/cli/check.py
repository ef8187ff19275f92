"""`restitution check`: validate a case or study and print derived quantities; solve nothing."""

from __future__ import annotations

from pathlib import Path

from rich.table import Column, Table

from restitution.case.below_grid import notice_of
from restitution.case.case import Case
from restitution.case.case_file import naming, parse_case, parse_toml, read_text
from restitution.case.derived import deepest_indentation, derived_quantities
from restitution.case.omissions import default_yield
from restitution.cli.console import command, errors, print_numbers, say, say_next, warn
from restitution.contact.contact import Contact
from restitution.contact.patch.law import law_of_patches
from restitution.numerics.memory import available, in_words
from restitution.runs.losses import loss_information, loss_warnings
from restitution.runs.messages import failure_at_edge, input_warnings, no_range, require_possible
from restitution.runs.refinement import least_refined
from restitution.runs.two_scales import cost_in_words
from restitution.surfaces import describe
from restitution.surfaces.joined.advice import next_measurement
from restitution.sweeps.sweep import parse_study

# For each derived quantity: label, conversion factor from SI, displayed unit.
_LABELS = {
    "reduced_radius_m": ("reduced radius R*", 1e6, "um"),
    "contact_modulus_Pa": ("contact modulus E*", 1e-9, "GPa"),
    "reduced_mass_kg": ("reduced mass m*", 1, "kg"),
    "yield_strength_Pa": ("yield strength Y", 1e-6, "MPa"),
    "yield_pressure_Pa": ("yield pressure p_y", 1e-6, "MPa"),
    "yield_indentation_m": ("yield indentation δ_y, smooth", 1e9, "nm"),
    "yield_force_N": ("yield force F_y, smooth", 1, "N"),
    "yield_velocity_m_per_s": ("yield velocity V_y, smooth", 1, "m/s"),
    "work_of_adhesion_J_per_m2": ("work of adhesion w", 1, "J/m^2"),
    "pull_off_force_smooth_N": ("pull-off force F_c, smooth", 1, "N"),
    "pull_off_radius_m": ("pull-off radius a_c, smooth", 1e6, "um"),
    "nodes_over_pull_off_radius": ("nodes over the pull-off radius, a_c/h", 1, ""),
    "expected_pull_off_error": ("expected error of pull-off on this grid", 100, "%"),
    "tabor_parameter": ("Tabor parameter (large in the JKR limit)", 1, ""),
    "sticking_velocity_m_per_s": ("sticking velocity V_s, smooth elastic", 1, "m/s"),
    "deepest_indentation_m": ("deepest indentation", 1e9, "nm"),
    "predicted_contact_radius_m": ("contact radius there, smooth", 1e6, "um"),
    "domain_half_width_m": ("half width of the grid", 1e6, "um"),
    "nodes_over_contact_radius": ("nodes over the contact radius", 1, ""),
    "rms_slope": ("rms slope h'", 1, ""),
    "reduced_pressure_Pa": ("unit of pressure E* h'", 1e-6, "MPa"),
    "mean_gap_at_first_touch_m": ("mean gap at first touch", 1e9, "nm"),
    "nominal_area_m2": ("nominal area, one period", 1e12, "um^2"),
}


def check(case: Path) -> None:
    given, cases = _read(case)
    warnings: list[str] = []
    with naming(case), errors.status("making the surface"):
        read = least_refined(given, case.parent, warnings.append)
        contact = read.contact(case.parent)
        table = _table(read, contact, auto=given.grid.refine == "auto")
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
        if (notice := notice_of(read, case.parent)) is not None:
            warnings.append(notice)
    if law := law_of_patches(contact):
        say(cost_in_words(law))
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
    for key, (label, scale, unit) in _LABELS.items():
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
