"""`restitution materials`: the library of materials."""

from __future__ import annotations

from itertools import combinations_with_replacement

from rich.markup import escape
from rich.table import Column, Table

from restitution.case.materials import Material, adhesive, material, work_of_adhesion
from restitution.case.materials import materials as library
from restitution.cli.console import (
    answers,
    command,
    print_numbers,
    say,
    say_next,
    table_of_numbers,
)

# For each key of the library: name, symbol, conversion factor from SI, displayed unit.
_QUANTITIES = {
    "youngs_modulus": ("Young's modulus", "E", 1e-9, "GPa"),
    "poissons_ratio": ("Poisson's ratio", "ν", 1.0, ""),
    "density": ("density", "ρ", 1.0, "kg/m^3"),
    "yield_strength": ("yield strength (tensile)", "Y", 1e-6, "MPa"),
    "hardness": ("hardness (mean pressure)", "H", 1e-9, "GPa"),
    "surface_energy": ("surface energy", "γ", 1e3, "mJ/m^2"),
    "size_effect": ("size effect", "h*", 1e6, "um"),
}
_UNLISTED = {"surface_energy", "size_effect"}  # known of few materials


_WIDEST = 1000  # width (characters) in which every table fits


def materials(name: str | None, *, adhesion: bool, json: bool) -> None:
    if adhesion:
        _show_pairs(name, json)
        return
    shown = library() if name is None else {(known := material(name)).key: known}
    if json:
        answers.print_json(data={key: entry.model_dump() for key, entry in shown.items()})
    elif name is None:
        table = _list(shown)
        natural = answers.measure(table, options=answers.options.update(width=_WIDEST)).maximum
        if natural > answers.width:  # each material fits into one line without its long name
            table = _list(shown, names=False)
        print_numbers(table)
        say_next(command("materials", "NAME") + " (spread and sources)")
    else:
        say(f"{known.key}: {known.name}")
        say(f"also called: {', '.join(known.aliases)}")
        answers.print(_values(known))
        say(f"Note: {known.note}")


def _show_pairs(name: str | None, json: bool) -> None:
    chosen = None if name is None else material(name).key
    if chosen:
        work_of_adhesion(chosen, chosen)  # refuse a material without a surface energy
    pairs = {
        pair: work_of_adhesion(*pair)
        for pair in combinations_with_replacement(adhesive(), 2)
        if chosen is None or chosen in pair
    }
    if json:
        answers.print_json(data={" ".join(pair): w.model_dump() for pair, w in pairs.items()})
        return
    table = table_of_numbers(
        Column("first", no_wrap=True), Column("second", no_wrap=True), "w (mJ/m^2)", "spread"
    )
    for pair, w in pairs.items():
        spread = f"{1e3 * w.low:.3g} to {1e3 * w.high:.3g}"
        table.add_row(*pair, f"{1e3 * w.value:.3g}", spread)
    answers.print(table)
    say(
        "w = 2 sqrt(gamma_1 gamma_2) of smooth, uncharged surfaces in dry air; water, dust and "
        "roughness change it. Surface energies and sources: restitution materials NAME"
    )


def _list(shown: dict[str, Material], *, names: bool = True) -> Table:
    listed = {key: row for key, row in _QUANTITIES.items() if key not in _UNLISTED}
    heads = [f"{symbol} ({unit})" if unit else symbol for _, symbol, _, unit in listed.values()]
    material = [Column("material", no_wrap=True)] if names else []
    table = table_of_numbers(Column("name", no_wrap=True), *heads, *material)
    for key, entry in shown.items():
        known = ((getattr(entry, name), scale) for name, (_, _, scale, _) in listed.items())
        cells = ("-" if of is None else f"{scale * of.value:.5g}" for of, scale in known)
        table.add_row(key, *cells, *([entry.name] if names else []))
    return table


def _values(material: Material) -> Table:
    table = table_of_numbers(
        Column("quantity", no_wrap=True, overflow="fold"),
        Column("value", justify="right", no_wrap=True, overflow="fold"),
        Column("spread", justify="right", no_wrap=True, overflow="fold"),
        Column("unit", no_wrap=True, overflow="fold"),
        Column("source", overflow="fold"),
    )
    for key, (label, _, scale, unit) in _QUANTITIES.items():
        if (known := getattr(material, key)) is not None:
            spread = f"{scale * known.low:.5g} to {scale * known.high:.5g}"
            source = known.source if known.verified else f"not verified: {known.source}"
            if conditions := getattr(known, "conditions", ""):
                source += f" ({conditions})"
            table.add_row(label, f"{scale * known.value:.5g}", spread, unit, escape(source))
    return table
