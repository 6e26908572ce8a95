"""Write a described machine as the text of a spec, as a person would: comments, units, one entry a line.

Foreign text appears in comments and in the title only, on one line and escaped as for a terminal, so none of it becomes
YAML. Numbers are written with the fewest digits that identify them, so digits of the file are kept.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence

from heuncli.base.text_safety import escape
from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.source import parse_plain_scalar
from heuncli.scene.importers.description import (
    DescribedBody,
    DescribedEntry,
    DescribedMachine,
    DescribedParameter,
    DescribedPoint,
    SpecValue,
)

MAX_LINE_LENGTH = 120  # characters of an unbroken line
MAX_REMARK_LENGTH = 240  # characters of a remark
# names, joint ends, numbers with a unit need no quotes
PLAIN_TEXT = re.compile(r"(?:-?\d)?[\w.]+(?: [A-Za-z][\w^/*]*)?\Z")
BLOCK_REMARKS = {
    "bodies": "kg, m, kg m^2 about the centre of mass; with all joints at 0, body axes are parallel to world axes",
    "joints": "directions in body axes, which are parallel to world axes with all joints at 0",
}


def format_spec(machine: DescribedMachine, name: str) -> str:
    """Format a machine as a spec. name: the spec's file name; the first line is the command that runs it."""
    return "\n".join(_iter_lines(machine, name)).rstrip("\n") + "\n"


def _iter_lines(machine: DescribedMachine, name: str) -> Iterator[str]:
    yield f"# heun run {_quote_argument(name)}"
    yield "#"
    yield from map(_format_comment, machine.header_lines)
    yield from map(_format_comment, _left_out_lines(machine))
    yield _format_comment(f"Made by heun import from {_base_name(machine.file)}, {machine.form}, sha256")
    yield _format_comment(machine.sha256)
    yield "heun: 1 # format version; numbers without a unit are SI"
    yield f"title: {_quote_text(_make_safe(machine.title))}"
    yield ""
    yield from _block_lines(
        machine, "parameters", (line for one in machine.parameters for line in _parameter_lines(one))
    )
    yield from _with_comment(f"gravity: {_format_value(machine.gravity)}", machine.remarks.get("gravity", ""))
    yield ""
    if machine.ground:
        yield from _block_lines(machine, "ground", _point_lines(machine.ground, 2))
    yield from _block_lines(machine, "bodies", (line for body in machine.bodies for line in _body_lines(body)))
    for block, entries in (
        ("joints", machine.joints),
        ("drives", machine.drives),
        ("forces", machine.forces),
        ("stops", machine.stops),
        ("couplings", machine.couplings),
    ):
        yield from _block_lines(machine, block, (line for entry in entries for line in _entry_lines(entry)))
    yield from _block_lines(
        machine, "analysis", (f"  {key}: {_format_value(value)}" for key, value in machine.analysis.items())
    )


def _left_out_lines(machine: DescribedMachine) -> Iterator[str]:
    """List what is left out in comments: whoever opens the spec later has not seen the warnings."""
    if machine.left_out:
        yield "Left out:"
    for problem in machine.left_out:
        path = problem.location.path if problem.location is not None else ""
        yield f"- {path}: {problem.message}" if path else f"- {problem.message}"


def _base_name(name: str) -> str:
    """Return the name of a file without its folders, which mean nothing on another computer."""
    return "standard input" if name == "-" else name.replace("\\", "/").rpartition("/")[2]


def _block_lines(machine: DescribedMachine, name: str, content: Iterable[str]) -> Iterator[str]:
    """Yield a block and an empty line after it, or nothing if it has no entries."""
    lines = iter(content)
    first = next(lines, None)
    if first is None:
        return
    remark = machine.remarks.get(name, BLOCK_REMARKS.get(name, ""))
    yield from _with_comment(f"{name}:", remark)
    yield first
    yield from lines
    yield ""


def _parameter_lines(parameter: DescribedParameter) -> Iterator[str]:
    yield from _with_comment(f"  {parameter.name}: {_format_value(parameter.value)}", parameter.remark)


def _body_lines(body: DescribedBody) -> Iterator[str]:
    yield from _with_comment(f"  {body.name}:", body.remark)
    if body.mass is not None:
        yield from _with_comment(f"    mass: {_format_value(body.mass)}", body.notes.get("mass", ""))
    if body.center is not None:
        yield from _with_comment(f"    center: {_format_value(body.center)}", body.notes.get("center", ""))
    if body.inertia is not None:
        yield from _inertia_lines(body.inertia, body.notes.get("inertia", ""))
    if body.shapes:
        yield from _with_comment("    shapes:", body.notes.get("shapes", ""))
        for shape in body.shapes:
            yield from _key_lines("      - ", shape.keys, shape.remark)
    yield from _point_lines(body.points, 4)
    for key, value in body.start.items():
        yield from _with_comment(f"    {key}: {_format_value(value)}", body.notes.get(key, ""))


def _inertia_lines(inertia: Matrix, remark: str) -> Iterator[str]:
    """Write the three moments if the axes are principal, otherwise the rows of the tensor."""
    moments = tuple(inertia[i][i] for i in range(3))
    if all(inertia[i][j] == 0.0 for i in range(3) for j in range(3) if i != j):
        yield from _with_comment(f"    inertia: {_format_value(moments)}", remark)
        return
    yield from _with_comment("    inertia:", remark)
    yield from (f"      - {_format_value(row)}" for row in inertia)


def _point_lines(points: Sequence[DescribedPoint], indent: int) -> Iterator[str]:
    """Write the points on one line if they fit and have no remarks, otherwise one a line."""
    if not points:
        return
    pad = " " * indent
    if not any(point.remark for point in points):
        line = f"{pad}points: {_format_value({point.name: point.place for point in points})}"
        if len(line) <= MAX_LINE_LENGTH:
            yield line
            return
    yield f"{pad}points:"
    for point in points:
        yield from _with_comment(f"{pad}  {point.name}: {_format_value(point.place)}", point.remark)


def _entry_lines(entry: DescribedEntry) -> Iterator[str]:
    yield from _key_lines(f"  {entry.name}: ", entry.keys, entry.remark)


def _key_lines(head: str, keys: Mapping[str, SpecValue], remark: str) -> Iterator[str]:
    """Write an entry on one line if it fits, otherwise one line for each key."""
    line = f"{head}{_format_value(keys)}"
    if len(line) <= MAX_LINE_LENGTH:
        yield from _with_comment(line, remark)
        return
    inner = " " * (len(head) if head.endswith("- ") else len(head) - len(head.lstrip()) + 2)
    lines = [f"{inner}{key}: {_format_value(value)}" for key, value in keys.items()]
    if head.endswith("- "):
        lines[0] = head + lines[0].lstrip()
        if remark:
            yield " " * (len(head) - 2) + _format_comment(remark)
    else:
        yield from _with_comment(head.rstrip(), remark)
    yield from lines


def _with_comment(line: str, remark: str) -> Iterator[str]:
    """Append the remark to a line, or put it on the line above if both together are too long."""
    if not remark:
        yield line
        return
    comment = _format_comment(remark)
    if len(line) + 1 + len(comment) <= MAX_LINE_LENGTH:
        yield f"{line} {comment}"
    else:
        yield " " * (len(line) - len(line.lstrip())) + comment
        yield line


def _format_comment(remark: str) -> str:
    return f"# {_make_safe(remark)}" if remark else "#"


def _make_safe(text: str) -> str:
    """Put foreign text on one line: escape invisible characters and shorten long text."""
    line = escape(text)
    return line if len(line) <= MAX_REMARK_LENGTH else f"{line[:MAX_REMARK_LENGTH]}..."


def _quote_argument(name: str) -> str:
    """Quote a file name as an argument of a command line."""
    return shlex.quote(escape(f"./{name}" if name.startswith("-") and name != "-" else name))


def _format_value(value: SpecValue) -> str:
    """Format a value on one line, as YAML in flow style."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return format_number(value)
    if isinstance(value, str):
        return _quote_text(value)
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key}: {_format_value(item)}' for key, item in value.items())}}}"
    return f"[{', '.join(map(_format_value, value))}]"


def format_number(value: float) -> str:
    """Format a number with the fewest digits that identify it; a whole number without a decimal point."""
    text = repr(float(value))
    return "0" if value == 0.0 else text.removesuffix(".0")


def format_decimal(value: float) -> str:
    """Format a number with a decimal point, so that it may stand for a number with a unit (manual/format.md,
    "Parameters").
    """
    text = repr(float(value))
    return text if "." in text else text.replace("e", ".0e")


def _quote_text(text: str) -> str:
    """Quote a text where YAML would read it as something else."""
    if PLAIN_TEXT.match(text) and type(parse_plain_scalar(text)) is str:
        return text
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
