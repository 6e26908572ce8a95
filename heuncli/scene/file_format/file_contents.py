"""What named files hold: measured curves of expectations, and surfaces of shapes.

A curve is two columns of a CSV file, in SI (manual/format.md, "Expect"); a mesh is checked to be a closed surface.
Impure: reads files.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from xml.parsers import expat

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding, SourceLocation
from heuncli.base.records import replace
from heuncli.base.units import Dimension, are_in_range, describe, is_in_range, range_error
from heuncli.scene.file_format.column_layout import Columns
from heuncli.scene.file_format.format import ExpectEntry
from heuncli.scene.file_format.format_shapes import MeshShape
from heuncli.scene.file_format.models import Curve, Logo
from heuncli.scene.file_format.named_files import RELATIVE_PATH_HINT, NamedFiles
from heuncli.scene.file_format.tables import FileColumns, TableProblem, has_error, read_file_columns
from heuncli.scene.meshes.model import TriangleMesh
from heuncli.scene.meshes.reading import read_closed_mesh

# Measured curves

ONE_POINT_HINT = "a curve needs at least two points; for one number use at: and is:"
ASCENDING_HINT = "sort the rows by x, with one row for each x"


def build_curve(
    item: ExpectEntry,
    x_of: str | None,
    run: tuple[float, float] | None,
    column_dimensions: tuple[tuple[Dimension, ...], tuple[Dimension, ...]],
    files: NamedFiles,
) -> tuple[Curve | None, list[TableProblem]]:
    """Build the curve of an expectation (None if it cannot be used) and list its problems.

    x_of: path of the result that x is; None: time
    run: first and last instant of the run, if they matter
    column_dimensions: the dimensions that each column may have; empty if unknown
    """
    assert item.curve is not None
    problems: list[TableProblem] = []
    found = read_curve_columns(item, x_of, files, problems)
    units = found.units if found is not None else []
    file = str(files.path(item.curve))
    for unit, dimensions in zip(units, column_dimensions, strict=False):
        if unit.heading is not None and unit.dimension is not None and dimensions and unit.dimension not in dimensions:
            expected = " or ".join(describe(one) for one in dimensions)
            kind = describe(unit.dimension)
            message = f"column {unit.heading.number} is {kind} according to its heading, expected {expected}"
            finding = Finding("wrong-dimension", message, "choose another column, or give its unit: x_unit, y_unit")
            problems.append(TableProblem((), finding, SourceLocation(file, unit.heading.line, 1)))
    if found is None or has_error(problems):
        return None, problems
    columns, sizes = found.numbers, [unit.size for unit in units]
    lines = found.list_lines()
    first_error = next(check_curve_points(columns, sizes, None if x_of is not None else run), None)
    if first_error is not None:
        i, finding = first_error
        return None, [*problems, TableProblem((), finding, SourceLocation(file, lines[i] if len(lines) else 1, 1))]
    required_share = item.within if item.within is not None else 1.0
    return Curve(file, columns[0], columns[1], lines, x_of, required_share), problems


def read_curve_columns(
    item: ExpectEntry, x_of: str | None, files: NamedFiles, problems: list[TableProblem]
) -> FileColumns | None:
    """Read the columns in SI, with their units. If x is a path, it is the column of that name, or else the first
    one.
    """
    assert item.curve is not None
    x_column = item.x if item.x is not None else 1
    y_column = item.y if item.y is not None else 2
    file_problems: list[TableProblem] = []
    units = (item.x_unit, item.y_unit)
    if item.skip is not None and item.skip < 0:
        problems.append(TableProblem(("skip",), Finding("table-form", f"skip is {item.skip}", "give 0 or more")))
        return None
    reading = units, item.curve, files, file_problems, item.skip or 0, item.gaps or "refuse", item.sheet
    found = read_file_columns((x_column, y_column), *reading)
    if x_of is not None and any(problem.keys == ("x",) for problem in file_problems):
        file_problems.clear()
        found = read_file_columns((1, y_column), *reading)
    problems += [
        replace(problem, keys=("curve",)) if problem.keys == ("file",) else problem for problem in file_problems
    ]
    return found


def check_curve_points(
    columns: Columns, sizes: list[float], run: tuple[float, float] | None
) -> Iterator[tuple[int, Finding]]:
    """Yield what prevents points from forming a curve within a run: the index of a point, and what is wrong with it."""
    x, y = (np.frombuffer(column) for column in columns)
    for name, values in (("x", x), ("y", y)):
        is_outside = ~are_in_range(values)
        if is_outside.any():
            i = int(is_outside.argmax())
            yield i, range_error(float(values[i]), f"{name} (SI)")
    if len(x) < 2:
        yield len(x) - 1, Finding("curve-points", f"{'only one point' if len(x) else 'no points'}", ONE_POINT_HINT)
        return
    is_falling = x[1:] <= x[:-1]
    if is_falling.any():
        i = int(is_falling.argmax()) + 1
        value, previous = x[i] / sizes[0], x[i - 1] / sizes[0]
        yield i, Finding("curve-points", f"x must increase, but {value:.9g} follows {previous:.9g}", ASCENDING_HINT)
    if run is not None:
        slack = tolerances.SAME_INSTANT * (run[1] - run[0])
        outside = (x < run[0] - slack) | (x > run[1] + slack)
        if outside.any():
            i = int(outside.argmax())
            message = f"{x[i]:.9g} s is outside the run, which lasts from {run[0]:.9g} to {run[1]:.9g} s"
            yield (
                i,
                Finding("curve-points", message, "remove these rows, or run longer; for milliseconds give x_unit: ms"),
            )


# Surfaces

LARGE_SIZE = 10.0  # [m] machine parts are smaller; one drawn in millimetres has more units than this


def read_mesh(file: str, files: NamedFiles) -> tuple[TriangleMesh | None, list[TableProblem]]:
    """Read the mesh of a file, and list what is wrong with it."""
    try:
        content = files.read_content(file)
    except Finding as error:
        message = f"the file '{files.path(file)}' cannot be read: {error.message}"
        is_large = error.code == "too-large"
        hint = "use a coarser mesh" if is_large else RELATIVE_PATH_HINT
        return None, [TableProblem(("file",), Finding(error.code if is_large else "mesh-file", message, hint))]
    try:
        return read_closed_mesh(content, file), []
    except Finding as error:
        message = f"the mesh '{files.path(file)}' cannot be used as a body: {error.message}"
        return None, [TableProblem(("file",), Finding(error.code, message, error.hint))]


def check_mesh_mass(shape: MeshShape, surface: TriangleMesh) -> Iterator[TableProblem]:
    """Yield a problem if mass or inertia of a mesh are outside the range of computation."""
    if surface.moments is not None and shape.scale is not None:
        message = "a STEP file states its own unit of length, and scale is another"
        yield TableProblem(("scale",), Finding("mesh-file", message, "leave scale out"))
        return
    scale = 1.0 if shape.scale is None else shape.scale
    mass_or_density = shape.density if shape.mass is None else shape.mass
    if scale <= 0.0 or mass_or_density is None or mass_or_density <= 0.0:  # reported by the rules
        return
    mass = mass_or_density if shape.mass is not None else mass_or_density * surface.volume * scale**3
    if not is_in_range(mass) or not mass:
        yield TableProblem(("file",), range_error(mass, "the mass of this shape [kg] (density times volume)"))
        return
    reach = scale * max(map(abs, (*surface.low.tolist(), *surface.high.tolist())))
    reach += max(map(abs, shape.at or (0.0,)))
    if not is_in_range(mass * reach**2):
        description = f"the inertia of this shape [kg m^2] ({mass:g} kg times the square of {reach:g} m)"
        yield TableProblem(("file",), range_error(mass * reach**2, description))


def iter_mesh_warnings(shape: MeshShape, surface: TriangleMesh | None, files: NamedFiles) -> Iterator[Finding]:
    """Yield warnings about a mesh: a file outside the folder, repairs, and an implausible size without a scale."""
    outside = files.find_outside_warning(shape.file)
    if outside is not None:
        yield outside
    if surface is None:
        return
    for note in surface.notes:
        yield Finding("mesh-mended", f"the mesh '{shape.file}': {note}", "export it again if this is not intended")
    size = float((surface.high - surface.low).max())
    if shape.scale is None and surface.moments is None and size > LARGE_SIZE:
        message = f"the mesh '{shape.file}' is {size:.4g} m long: without a scale its unit is the metre"
        yield Finding("mesh-size", message, "give scale: 1 mm if it was drawn in millimetres, otherwise scale: 1 m")


# Logos

MAX_LOGO_SIZE = 1_000_000  # bytes; it is embedded in every report
PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
LOGO_HINT = "a logo is a PNG or SVG file"


def read_logo(file: str, files: NamedFiles) -> Logo:
    """Read the logo of a report. Raises Finding [logo-file]."""
    try:
        content = bytes(files.read_content(file))
    except Finding as error:
        message = f"the file '{files.path(file)}' cannot be read: {error.message}"
        raise Finding("logo-file", message, RELATIVE_PATH_HINT) from None
    if len(content) > MAX_LOGO_SIZE:
        message = f"the file '{files.path(file)}' has {len(content) / 1e6:.3g} MB; at most 1 MB is embedded"
        raise Finding("logo-file", message, "save it with fewer pixels, or as SVG")
    if content.startswith(PNG_SIGNATURE):
        reason = find_png_fault(content)
        media_type = "image/png"
    else:
        reason = find_svg_fault(content)
        media_type = "image/svg+xml"
    if reason is not None:
        raise Finding("logo-file", f"the file '{files.path(file)}' is not a picture: {reason}", LOGO_HINT)
    return Logo(file, content, media_type)


def find_png_fault(content: bytes) -> str | None:
    """Return why bytes that begin as PNG are no picture: cut off, damaged, or without a size; else None."""
    position = len(PNG_SIGNATURE)
    names: list[bytes] = []
    while position + 12 <= len(content):
        size = int.from_bytes(content[position : position + 4], "big")
        chunk, end = content[position + 4 : position + 8 + size], position + 12 + size
        if end > len(content) or zlib.crc32(chunk) != int.from_bytes(content[end - 4 : end], "big"):
            return "the PNG is damaged"
        if not names and (chunk[:4] != b"IHDR" or not all((any(chunk[4:8]), any(chunk[8:12])))):
            return "the PNG has no size"
        names.append(chunk[:4])
        if names[-1] == b"IEND":
            return None if b"IDAT" in names else "the PNG has no pixels"
        position = end
    return "the PNG ends too early"


def find_svg_fault(content: bytes) -> str | None:
    """Return why a file is no SVG that can be embedded, else None. Entities are not accepted: they may be endless."""
    elements: list[str] = []
    entities: list[str] = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda name, attributes: elements.append(name)
    parser.EntityDeclHandler = lambda name, *rest: entities.append(name)
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError) as error:
        return f"neither PNG nor SVG ({error})"
    if entities:
        return "it declares entities"
    return None if elements[0].rpartition(":")[2] == "svg" else f"its first element is <{elements[0]}>, not <svg>"
