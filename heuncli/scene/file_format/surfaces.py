"""The files of meshes that shapes name -> closed surfaces, and what to say of them. Impure: reads files."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.errors import Finding
from heuncli.base.number_range import is_in_range, out_of_range
from heuncli.scene.file_format.format_shapes import MeshShape
from heuncli.scene.file_format.named_files import RELATIVE, NamedFiles
from heuncli.scene.file_format.tables import Wrong
from heuncli.scene.meshes.model import TriangleMesh
from heuncli.scene.meshes.reading import mesh_of

LARGE = 10.0  # [m] a part of machinery is smaller; drawn in millimetres it is larger than so many units


def surface_of(file: str, files: NamedFiles) -> tuple[TriangleMesh | None, list[Wrong]]:
    """The mesh in a file, or what is wrong with it."""
    try:
        content = files.content(file)
    except Finding as refused:
        message = f"the file '{files.path(file)}' cannot be read: {refused.message}"
        is_large = refused.code == "too-large"
        hint = "a coarser mesh will do" if is_large else RELATIVE
        return None, [Wrong(("file",), Finding(refused.code if is_large else "mesh-file", message, hint))]
    try:
        return mesh_of(content, file), []
    except Finding as refused:
        message = f"the mesh '{files.path(file)}' cannot be a body: {refused.message}"
        return None, [Wrong(("file",), Finding(refused.code, message, refused.hint))]


def judged(shape: MeshShape, surface: TriangleMesh) -> Iterator[Wrong]:
    """Masses and inertias that are not computed with."""
    scale = 1.0 if shape.scale is None else shape.scale
    given = shape.density if shape.mass is None else shape.mass
    if scale <= 0.0 or given is None or given <= 0.0:  # told by the rules
        return
    mass = given if shape.mass is not None else given * surface.volume * scale**3
    if not is_in_range(mass) or not mass:
        yield Wrong(("file",), out_of_range(mass, "the mass of this shape [kg], its density times its volume,"))
        return
    reach = scale * max(map(abs, (*surface.low.tolist(), *surface.high.tolist())))
    reach += max(map(abs, shape.at or (0.0,)))
    if not is_in_range(mass * reach**2):
        what = f"the inertia of this shape [kg m^2], {mass:g} kg times the square of {reach:g} m,"
        yield Wrong(("file",), out_of_range(mass * reach**2, what))


def noted(shape: MeshShape, surface: TriangleMesh | None, files: NamedFiles) -> Iterator[Finding]:
    """What to say of a mesh all the same: where its file lies, what of it was put right, its size without a scale."""
    outside = files.outside(shape.file)
    if outside is not None:
        yield outside
    if surface is None:
        return
    for note in surface.notes:
        yield Finding("mesh-mended", f"the mesh '{shape.file}': {note}", "export it again, if it is not meant so")
    size = float((surface.high - surface.low).max())
    if shape.scale is None and size > LARGE:
        message = f"the mesh '{shape.file}' is {size:.4g} m long, for without a scale its unit is the metre"
        yield Finding("mesh-size", message, "scale: 1 mm, if it was drawn in millimetres, or scale: 1 m")
