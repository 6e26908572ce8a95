"""Read the mesh files that shapes name into closed surfaces, and check them. Impure: reads files."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.errors import Finding
from heuncli.base.number_range import is_in_range, range_error
from heuncli.scene.file_format.format_shapes import MeshShape
from heuncli.scene.file_format.named_files import RELATIVE_PATH_HINT, NamedFiles
from heuncli.scene.file_format.tables import TableProblem
from heuncli.scene.meshes.model import TriangleMesh
from heuncli.scene.meshes.reading import read_closed_mesh

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
    if shape.scale is None and size > LARGE_SIZE:
        message = f"the mesh '{shape.file}' is {size:.4g} m long: without a scale its unit is the metre"
        yield Finding("mesh-size", message, "give scale: 1 mm if it was drawn in millimetres, otherwise scale: 1 m")
