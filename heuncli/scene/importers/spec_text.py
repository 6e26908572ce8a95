"""A described machine as the text of a spec, written as one writes by hand: comments, units, one entry a line.

Foreign text stands in comments and in the title alone, on one line and escaped as a terminal would need it: nothing of
it becomes YAML. Numbers have the fewest digits that mean them, which are the file's where they are the file's.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence

from heuncli.base.foreign_text import shown
from heuncli.scene.file_format.models import Matrix
from heuncli.scene.file_format.source import plain
from heuncli.scene.importers.described import (
    DescribedBody,
    DescribedEntry,
    DescribedMachine,
    DescribedParameter,
    DescribedPoint,
    Value,
)

WIDEST = 120  # characters of a line that is not broken
LONGEST = 240  # characters of a remark
PLAIN = re.compile(r"(?:-?\d)?[\w.]+(?: [A-Za-z][\w^/*]*)?\Z")  # names, ends, numbers with a unit: no quotes needed
REMARKS = {
    "bodies": "kg, m, kg m^2 about the centre of mass; with every joint at 0 their axes stand along the world's",
    "joints": "directions in the axes of the bodies, which are the world's with every joint at 0",
}


def spec_text(machine: DescribedMachine, name: str) -> str:
    """The spec of a machine, for a file of that name: its first line is the command that runs it."""
    return "\n".join(_lines(machine, name)).rstrip("\n") + "\n"


def _lines(machine: DescribedMachine, name: str) -> Iterator[str]:
    yield f"# heun run {_word(name)}"
    yield "#"
    yield from map(_comment, machine.told)
    yield from map(_comment, _left_out(machine))
    yield _comment(f"Made by heun import from {_file(machine.file)}, {machine.form}, sha256")
    yield _comment(machine.sha256)
    yield "heun: 1 # version of the format; plain numbers are SI"
    yield f"title: {_quoted(_safe(machine.title))}"
    yield ""
    yield from _block(machine, "parameters", (line for one in machine.parameters for line in _parameter(one)))
    yield from _with_remark(f"gravity: {_flow(machine.gravity)}", machine.remarks.get("gravity", ""))
    yield ""
    if machine.ground:
        yield from _block(machine, "ground", _points(machine.ground, 2))
    yield from _block(machine, "bodies", (line for body in machine.bodies for line in _body(body)))
    for name_, entries in (
        ("joints", machine.joints),
        ("drives", machine.drives),
        ("forces", machine.forces),
        ("stops", machine.stops),
        ("couplings", machine.couplings),
    ):
        yield from _block(machine, name_, (line for entry in entries for line in _entry(entry)))
    yield from _block(machine, "analysis", (f"  {key}: {_flow(value)}" for key, value in machine.analysis.items()))


def _left_out(machine: DescribedMachine) -> Iterator[str]:
    """What a warning says once, whoever opens the spec later is to know, too."""
    if machine.left_out:
        yield "Left out:"
    for problem in machine.left_out:
        path = problem.location.path if problem.location is not None else ""
        yield f"- {path}: {problem.message}" if path else f"- {problem.message}"


def _file(name: str) -> str:
    """A file without its folders, which are nobody else's."""
    return "standard input" if name == "-" else name.replace("\\", "/").rpartition("/")[2]


def _block(machine: DescribedMachine, name: str, content: Iterable[str]) -> Iterator[str]:
    """A block and an empty line behind it; nothing where it has no entries."""
    lines = iter(content)
    first = next(lines, None)
    if first is None:
        return
    remark = machine.remarks.get(name, REMARKS.get(name, ""))
    yield from _with_remark(f"{name}:", remark)
    yield first
    yield from lines
    yield ""


def _parameter(parameter: DescribedParameter) -> Iterator[str]:
    yield from _with_remark(f"  {parameter.name}: {_flow(parameter.value)}", parameter.remark)


def _body(body: DescribedBody) -> Iterator[str]:
    yield from _with_remark(f"  {body.name}:", body.remark)
    if body.mass is not None:
        yield from _with_remark(f"    mass: {_flow(body.mass)}", body.notes.get("mass", ""))
    if body.center is not None:
        yield from _with_remark(f"    center: {_flow(body.center)}", body.notes.get("center", ""))
    if body.inertia is not None:
        yield from _inertia(body.inertia, body.notes.get("inertia", ""))
    if body.shapes:
        yield from _with_remark("    shapes:", body.notes.get("shapes", ""))
        for shape in body.shapes:
            yield from _keys("      - ", shape.keys, shape.remark)
    yield from _points(body.points, 4)
    for key, value in body.start.items():
        yield from _with_remark(f"    {key}: {_flow(value)}", body.notes.get(key, ""))


def _inertia(inertia: Matrix, remark: str) -> Iterator[str]:
    """The moments alone where the axes are principal, else the tensor in rows."""
    moments = tuple(inertia[i][i] for i in range(3))
    if all(inertia[i][j] == 0.0 for i in range(3) for j in range(3) if i != j):
        yield from _with_remark(f"    inertia: {_flow(moments)}", remark)
        return
    yield from _with_remark("    inertia:", remark)
    yield from (f"      - {_flow(row)}" for row in inertia)


def _points(points: Sequence[DescribedPoint], indent: int) -> Iterator[str]:
    """On one line where they fit and none has a remark, else one a line."""
    if not points:
        return
    pad = " " * indent
    if not any(point.remark for point in points):
        line = f"{pad}points: {_flow({point.name: point.place for point in points})}"
        if len(line) <= WIDEST:
            yield line
            return
    yield f"{pad}points:"
    for point in points:
        yield from _with_remark(f"{pad}  {point.name}: {_flow(point.place)}", point.remark)


def _entry(entry: DescribedEntry) -> Iterator[str]:
    yield from _keys(f"  {entry.name}: ", entry.keys, entry.remark)


def _keys(head: str, keys: Mapping[str, Value], remark: str) -> Iterator[str]:
    """An entry on one line, else a line a key."""
    line = f"{head}{_flow(keys)}"
    if len(line) <= WIDEST:
        yield from _with_remark(line, remark)
        return
    inner = " " * (len(head) if head.endswith("- ") else len(head) - len(head.lstrip()) + 2)
    lines = [f"{inner}{key}: {_flow(value)}" for key, value in keys.items()]
    if head.endswith("- "):
        lines[0] = head + lines[0].lstrip()
        if remark:
            yield " " * (len(head) - 2) + _comment(remark)
    else:
        yield from _with_remark(head.rstrip(), remark)
    yield from lines


def _with_remark(line: str, remark: str) -> Iterator[str]:
    """A line with its remark behind it, or above it where both together are too long."""
    if not remark:
        yield line
        return
    comment = _comment(remark)
    if len(line) + 1 + len(comment) <= WIDEST:
        yield f"{line} {comment}"
    else:
        yield " " * (len(line) - len(line.lstrip())) + comment
        yield line


def _comment(remark: str) -> str:
    return f"# {_safe(remark)}" if remark else "#"


def _safe(text: str) -> str:
    """Foreign text on one line: what is unseen escaped, of what is long the beginning."""
    line = shown(text)
    return line if len(line) <= LONGEST else f"{line[:LONGEST]}..."


def _word(name: str) -> str:
    """The name of a file as a word of the command line."""
    return shlex.quote(shown(f"./{name}" if name.startswith("-") and name != "-" else name))


def _flow(value: Value) -> str:
    """A value on one line."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return number_text(value)
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key}: {_flow(item)}' for key, item in value.items())}}}"
    return f"[{', '.join(map(_flow, value))}]"


def number_text(value: float) -> str:
    """The fewest digits that mean the number; a whole one without a point."""
    text = repr(float(value))
    return "0" if value == 0.0 else text.removesuffix(".0")


def pointed(value: float) -> str:
    """A number with a point in it: it may stand for one with a unit (manual/format.md, "Parameters")."""
    text = repr(float(value))
    return text if "." in text else text.replace("e", ".0e")


def _quoted(text: str) -> str:
    """A text, in quotes where YAML would read something else."""
    if PLAIN.match(text) and type(plain(text)) is str:
        return text
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
