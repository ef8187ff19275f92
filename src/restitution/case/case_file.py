"""Read a case file into a `Case`; error messages name the key and the remedy."""

from __future__ import annotations

import re
import stat
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from restitution.case.case import Case
from restitution.case.rulebook import rules, tables_in
from restitution.case.schema import MOST_STEPS, Table
from restitution.errors import CaseError, SurfaceError, did_you_mean, shown
from restitution.surfaces.generate import RoughnessKind

_LARGEST = 2**22  # largest size of a case file (bytes)
_DEEPEST = 32  # largest depth of nested tables and lists, and largest number of dots in a key
_NAMED = 3  # largest number of wrong keys that a message names in addition to the first one
_KINDS = (*get_args(RoughnessKind), "measured", "joined")


def read_case(path: Path) -> tuple[Case, str]:
    """Read and check a case file; return the case and its text, or raise `CaseError`."""
    text = read_text(path)
    with naming(path):
        return parse_case(text), text


def read_text(path: Path) -> str:
    """Read the text of a case file, or raise `CaseError`."""
    try:
        kind = path.stat()
        if not (stat.S_ISREG(kind.st_mode) or stat.S_ISDIR(kind.st_mode)):
            raise CaseError(
                f"{path}: is not a regular file, but a device, pipe or socket; give a case file"
            )
        if kind.st_size > _LARGEST:
            raise CaseError(
                f"{path}: has {kind.st_size} bytes, but a case file may have at most {_LARGEST}; "
                "check that this is the right file"
            )
        return path.read_text(encoding="utf-8-sig")  # editors on Windows write a byte order mark
    except UnicodeDecodeError:
        raise CaseError(f"{path}: is not a text file; a case file is TOML in UTF-8") from None
    except OSError as error:
        raise CaseError(f"{path}: cannot be read ({error.strerror}); give a case file") from None


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put the name of the case file in front of error messages."""
    try:
        yield
    except (CaseError, SurfaceError) as error:
        raise type(error)(f"{path}: {error}") from error


def parse_toml(text: str) -> dict[str, Any]:
    """Parse a TOML text. Raises `CaseError`."""
    _check_dots(text)
    try:
        content = tomllib.loads(text)
    except RecursionError:
        raise _too_deep() from None
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"not valid TOML: {error}{_likely_cause(error, text)}") from None
    except ValueError:  # Python refuses to read an integer of more than 4300 digits
        raise CaseError("contains a number with thousands of digits; correct it") from None
    _check_depth(content)
    return content


def _is_table_of_numbers(text: str) -> bool:
    first = text.lstrip("\ufeff \t\r\n").partition("\n")[0]
    return "=" not in first and "[" not in first and any(sign in first for sign in ",;\t")


def _likely_cause(error: tomllib.TOMLDecodeError, text: str) -> str:
    """The likely cause of a TOML error and its remedy, or ""."""
    if twice := re.match(r"Cannot declare \('(\w+)',\) twice", str(error)):
        return f"; for several tables, begin each of them with [[{twice[1]}]]"
    place = re.search(r"at line (\d+), column", str(error))
    lines = text.splitlines() or [""]  # without a place, the error is at the end of the text
    line = lines[min(int(place[1]), len(lines)) - 1] if place else lines[-1]
    key, equals, value = line.partition("=")
    key, value = key.strip(), value.strip()
    if str(error).startswith("Cannot overwrite a value"):
        return f"; {shown(key)} is given twice: remove one of them"
    if _is_table_of_numbers(text):
        return "; this is a table of values, not a case file: give the case file"
    if equals and str(error).startswith(("Invalid value", "Expected newline")) and value:
        return (
            f'; write texts and quantities in quotes: {shown(key)[1:-1]} = "{shown(value)[1:-1]}"'
        )
    return ""


def _too_deep() -> CaseError:
    return CaseError("not valid TOML: nested too deeply; correct the brackets or the dotted keys")


def _check_dots(text: str) -> None:
    """Reject dotted keys with very many parts, which `tomllib` takes minutes to parse."""
    words = re.split(r"[^\w.\-\"']+", text)
    if any(word.count(".") > _DEEPEST and ".." not in word.strip(".") for word in words):
        raise _too_deep()


def _check_depth(content: dict[str, Any]) -> None:
    """Reject tables nested so deeply that printing them would fail."""
    level: list[Any] = [content]
    for _ in range(_DEEPEST):
        inner = [v.values() if isinstance(v, dict) else v for v in level]
        level = [v for values in inner for v in values if isinstance(v, (dict, list))]
        if not level:
            return
    raise _too_deep()


def parse_case(text: str) -> Case:
    """Check the text of a case file. Raises a `CaseError` that names the key."""
    content = parse_toml(text)
    try:
        return Case.model_validate(content)
    except ValidationError as error:
        raise CaseError(_other_kind(content) or in_words(error)) from None


def _other_kind(content: dict[str, Any]) -> str:
    """The command for `content`, if it is a mixture or study; otherwise ""."""
    if "materials" in content and "first" not in content:
        return "this is a mixture: use `restitution mixture FILE`"
    if "sweep" in content:
        return "this is a study: use `restitution study FILE`"
    return ""


def problems_of(content: dict[str, Any]) -> dict[str, str]:
    """A message for each wrong key of the parsed tables of a case file; "" is the whole file."""
    try:
        Case.model_validate(content)
    except ValidationError as error:
        problems = reversed(error.errors(include_url=False))
        texts = ((problem, *_in_words(problem, Case)) for problem in problems)
        return {key or _key_of(problem): words for problem, key, words in texts}
    except CaseError as error:
        return {"": str(error)}
    return {}


def in_words(error: ValidationError, root: type[Table] = Case, before: str = "") -> str:
    """Describe the problems of a file in one line: the first problem, then the other wrong keys.

    `root` is the class of the table that was checked, `before` the path of this table in the file.
    """
    # Report unknown keys first, because a misspelt key is the usual reason for a missing key.
    problems = error.errors(include_url=False)
    problems.sort(key=lambda problem: problem["type"] != "extra_forbidden")
    where = f"{before}." if before else ""
    key, words = _in_words(problems[0], root)
    return where + (f"{key}: {words}" if key else words) + _others(problems)


def _others(problems: list[Any]) -> str:
    names = list(dict.fromkeys(_key_of(problem) for problem in problems))[1:]
    if not names:
        return ""
    more = [f"{len(names) - _NAMED} more"] if len(names) > _NAMED else []
    return f" (also wrong: {', '.join(names[:_NAMED] + more)})"


# For each type of pydantic error, the expected value in words.
_WORDS = {
    "model_type": "a table",
    "model_attributes_type": "a table",
    "dict_type": "a table",
    "list_type": "a list",
    "too_short": "a list with at least one value",
    "too_long": f"a list with at most {MOST_STEPS} values",
    "string_type": "a text",
    "string_too_short": "a text that is not empty",
    "bool_type": "true or false",
    "float_type": "a number",
    "int_type": "a whole number",
    "int_parsing_size": "a smaller number",
}


def _keys(problem: Any) -> list[str]:
    # The path of a pydantic error also contains the kind of a roughness ("gaussian") and indices of
    # lists. Leave them out, because they are not keys of the file.
    return [str(k) for k in problem["loc"] if isinstance(k, str) and k not in _KINDS]


def _key_of(problem: Any) -> str:
    """Dotted key of a pydantic error; "roughness[2]" is the second table [[roughness]]."""
    names = [shown(key)[1:-1] for key in _keys(problem)]
    number = problem["loc"][1] if names[:1] == ["roughness"] and len(problem["loc"]) > 1 else 0
    if isinstance(number, int) and number > 0:
        names[0] = f"roughness[{number + 1}]"
    return ".".join(names)


def _in_words(problem: Any, root: type[Table]) -> tuple[str, str]:
    """The key of a pydantic error, and the problem and its remedy in one line."""
    keys, key = _keys(problem), _key_of(problem)
    kind, context = problem["type"], problem.get("ctx", {})
    if kind == "extra_forbidden":
        known = _keys_of(keys[:-1], problem["loc"], root)
        hint = f"known keys: {', '.join(known)}" if known else "remove it"
        if len(keys) > 1 and keys[-1] in root.model_fields:
            return key, f"unknown key; write {keys[-1]} above the first [table] of the file"
        if keys[-1] == "diameter" and "radius" in known:
            return key, "unknown key; give radius = half the diameter"
        return key, f"unknown key; {did_you_mean(keys[-1], known) or hint}"
    if kind == "missing":
        return "", (f"the table [{key}]" if len(keys) == 1 else f'the key "{key}"') + " is missing"
    if kind == "union_tag_not_found":
        kinds = ", ".join(f'"{kind}"' for kind in _KINDS)
        return "", f"{key}.kind is missing; write one of {kinds}"
    if kind == "union_tag_invalid":
        tag = f"{shown(context['tag'])} is not one of {context['expected_tags']}"
        return f"{key}.kind", tag
    if kind == "value_error":
        return key, str(context["error"])
    should_be = _WORDS.get(kind, problem["msg"].removeprefix("Input should be "))
    return key, f"{shown(problem['input'])} should be {should_be}"


def _keys_of(path: list[str], loc: tuple[Any, ...], root: type[BaseModel]) -> list[str]:
    """The valid keys of the table at `path`, as written in the file."""
    for key in path:
        fields = {rule.name: rule.field for rule in rules(root)}
        tables = tables_in(fields[key]) if key in fields else []
        if not tables:
            return []
        # The path of a pydantic error also contains the kind of a table of several kinds.
        kinds = (next(rules(table)).words for table in tables)
        of_kind = [table for table, words in zip(tables, kinds, strict=True) if {*words} & {*loc}]
        root = (of_kind or tables)[0]
    return [rule.name for rule in rules(root)]
