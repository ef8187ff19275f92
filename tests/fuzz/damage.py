"""Damages to files of results: each takes a file and a random generator, and changes the file."""

import csv
import io
import json
import shutil


def truncate(path, pick):
    content = path.read_bytes()
    path.write_bytes(content[: pick.randrange(len(content))])


def zero(path, pick):
    content = bytearray(path.read_bytes())
    start = pick.randrange(len(content))
    length = min(len(content) - start, pick.choice((1, 8, 64, 512, 4096)))
    content[start : start + length] = bytes(length)
    path.write_bytes(content)


def flip(path, pick):
    content = bytearray(path.read_bytes())
    for _ in range(pick.choice((1, 1, 5))):
        content[pick.randrange(len(content))] ^= 1 << pick.randrange(8)
    path.write_bytes(content)


def digit(path, pick):
    content = bytearray(path.read_bytes())
    places = [k for k, c in enumerate(content) if chr(c).isdigit()]
    if places:
        content[pick.choice(places)] = ord(pick.choice("0123456789-x"))
    path.write_bytes(content)


def empty(path, _):
    path.write_bytes(b"")


def binary(path, pick):
    path.write_bytes(pick.randbytes(pick.choice((3, 300, 30000))))


def remove(path, _):
    path.unlink()


def folder(path, _):
    path.unlink()
    path.mkdir()


def other(path, pick):
    """The content of another file of the folder."""
    files = [file for file in sorted(path.parent.iterdir()) if file.is_file() and file != path]
    if files:
        shutil.copyfile(pick.choice(files), path)


def _table(path, pick, change):
    rows = list(csv.reader(io.StringIO(path.read_text())))
    if rows:
        change(rows, pick)
    with open(path, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


def _without_column(rows, pick):
    at = pick.randrange(len(rows[0]))
    for row in rows:
        del row[at : at + 1]


def _renamed_column(rows, pick):
    at = pick.randrange(len(rows[0]))
    rows[0][at] = pick.choice((rows[0][at] + "x", "", "restitution", rows[0][at].upper()))


def _swapped_columns(rows, pick):
    i, j = pick.sample(range(len(rows[0])), 2)
    for row in rows[pick.choice((0, 1)) :]:
        row[i], row[j] = row[j], row[i]


def _cell(rows, pick):
    row = pick.choice(rows)
    value = pick.choice(("nan", "", "-7", "1.5", "inf", "1e400", "0x1", "x", "true", "0", '"'))
    row[pick.randrange(len(row))] = value


def _without_row(rows, pick):
    del rows[pick.randrange(len(rows))]


def _twice_a_row(rows, pick):
    rows.insert(pick.randrange(len(rows)), pick.choice(rows))


def column(path, pick):
    kinds = (_without_column, _renamed_column, _swapped_columns, _cell, _without_row, _twice_a_row)
    _table(path, pick, pick.choice(kinds))


def _places(content):
    """Every (container, key) of a JSON text."""
    items = content.items() if isinstance(content, dict) else enumerate(content)
    for key, value in items:
        yield content, key
        if isinstance(value, (dict, list)):
            yield from _places(value)


def key(path, pick):
    content = json.loads(path.read_text())
    holder, name = pick.choice(list(_places(content)))
    kind = pick.choice(("remove", "rename", "value", "value"))
    if kind == "value":
        values = (None, "", "x", -7, 1.5, 1e300, [], {}, True, float("nan"), "\ud800", [[1]])
        holder[name] = pick.choice(values)
    elif kind == "remove" or isinstance(holder, list):
        del holder[name]
    else:
        holder[f"{name}x"] = holder.pop(name)
    path.write_text(json.dumps(content))


ANY = (truncate, zero, flip, digit, empty, binary, remove, folder, other)


def kinds(path):
    """What may happen to a file; half of it what only happens to files of its kind."""
    special = {".csv": (column,), ".json": (key,)}.get(path.suffix, ())
    return ANY + special * len(ANY)
