"""`restitution new`: a commented case or study file to start from."""

from importlib.resources import files
from pathlib import Path
from string import Template

from restitution.cli.console import command, errors, say_next, say_written
from restitution.errors import CaseError
from restitution.results.writer import require_new_file, writing

# The values of a powder that `--set` replaces.
_POWDER = {
    "material": "silica",
    "radius": "5 um",
    "rms": "10 nm",
    "correlation_length": "0.3 um",
    "work_of_adhesion": "0.05 J/m^2",
}


def new(
    *, dem: bool, scan: bool, study: bool, powder: bool, values: list[str] | None, out: Path | None
) -> None:
    kinds = {"dem": dem, "scan": scan, "study": study, "powder": powder}
    chosen = [kind for kind, wanted in kinds.items() if wanted]
    if len(chosen) > 1:
        raise CaseError(f"--{', --'.join(chosen)}: choose one of them")
    kind = chosen[0] if chosen else "case"
    file = out or Path("study.toml" if study else "case.toml")
    require_new_file(file)
    text = (files("restitution.cli") / "templates" / f"{kind}.toml").read_text("utf-8")
    if values and not powder:
        raise CaseError("--set: belongs to --powder; edit the written file instead")
    if powder:
        text = _powder(text, values or [])
    with writing(file.parent):
        file.write_text(text, encoding="utf-8")
    say_written(file)
    say_next(command("check", file))


def _powder(template: str, given: list[str]) -> str:
    from restitution.runs.powder import powder_grid  # loads the solver

    values = dict(_POWDER)
    for item in given:
        key, equals, value = (part.strip() for part in item.partition("="))
        if key not in values or not equals or not value:
            raise CaseError(
                f'--set: "{item}" should be KEY=VALUE with one of {", ".join(_POWDER)}, for '
                'example radius="2 um"'
            )
        values[key] = value
    values["title"] = f"{values['material']}, {values['radius']}, Rq {values['rms']}"
    with errors.status("choosing a grid that resolves the adhesion"):
        return Template(template).substitute(values, **powder_grid(template, values))
