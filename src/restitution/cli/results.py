"""`restitution report` and `restitution compare`: stored results."""

from pathlib import Path

from rich.markup import escape
from rich.table import Column, Table

from restitution.cli.console import answers, say, say_written
from restitution.laws.law import velocity_of
from restitution.pages.report import write_report
from restitution.results.compare import compare as compared
from restitution.results.writer import require_new_file, write_table


def report(results: Path, velocity: str | None) -> None:
    say_written(write_report(results, None if velocity is None else velocity_of(velocity)))


def compare(a: Path, b: Path, out: Path | None) -> None:
    comparison = compared(a, b)
    require_new_file(out)
    if out is not None:
        write_table(out, comparison.rows)
    if comparison.inputs:
        heads = (Column(name, overflow="fold") for name in ("input", "A", "B"))
        inputs = Table(*heads, box=None, header_style="bold")
        for differing in comparison.inputs:
            inputs.add_row(*(escape(cell) for cell in differing))
        answers.print(inputs)
        answers.print()
    swept = [
        key
        for key in (comparison.rows[0] if comparison.rows else {})
        if "." in key or key == "title"
    ]
    names = ("indentation (nm)", "COR A", "COR B", "difference", "error", "force B/A", "")
    numbers = (Column(name, justify="right") for name in names)
    table = Table(*map(escape, swept), *numbers, box=None, header_style="bold")
    for row in comparison.rows:
        marks = ("" if row["significant"] else "within error") if row["resolved"] else "unresolved"
        table.add_row(
            *(escape(row[key]) for key in swept),
            f"{1e9 * row['max_indentation_m']:.4g}",
            f"{row['restitution_a']:.4f}",
            f"{row['restitution_b']:.4f}",
            f"{row['difference']:+.4f}",
            f"{row['error']:.4f}",
            f"{row['force_ratio']:.4f}",
            marks,
        )
    answers.print(table)
    if comparison.rows:
        worst = max(comparison.rows, key=lambda row: abs(row["difference"]))
        answers.print(f"largest difference of COR {worst['difference']:+.4f}")
    else:
        answers.print("The results have no depth in common.")
    for note in comparison.notes:
        say(f"Note: {note}")
