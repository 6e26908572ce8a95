"""Turn the collision or visual elements of a link without inertia into shapes with the density of --density.

The collision elements are used if all of them are boxes, cylinders and spheres, otherwise the visual ones. A URDF
cylinder is centred at the origin, with its axis along z.
"""

from __future__ import annotations

from typing import Any

from heuncli.scene.file_format.models import Matrix, Vec
from heuncli.scene.importers.attitudes import (
    add_vectors,
    compose_rotations,
    is_right_angled,
    rotate_vector,
    rotation_from_roll_pitch_yaw,
    round_vector,
)
from heuncli.scene.importers.description import DescribedEntry
from heuncli.scene.importers.urdf.document import UrdfLink, read_pose
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.xml_elements import XmlElement

GEOMETRY_TAGS = ("collision", "visual")
SIZE_ATTRIBUTES = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}


def make_shapes(
    link: UrdfLink, R: Matrix, density: float, fields: UrdfFields
) -> tuple[str, tuple[DescribedEntry, ...]]:
    """Make the shapes of a link, and return the tag of the elements from which they come. Elements that are no shape
    add problems.

    R: the attitude of the link with every joint at 0; the shapes are given along the world's axes. A link without
    geometry has no shapes, and that is no problem.
    """
    found = {source: link.element.find_all(source) for source in GEOMETRY_TAGS}
    present = [source for source in GEOMETRY_TAGS if found[source]]
    source = next(
        (source for source in present if all(map(_is_supported, found[source]))), present[0] if present else ""
    )
    shapes = [_make_shape(element, R, density, link, fields) for element in found.get(source, ())]
    return source, tuple(shape for shape in shapes if shape is not None)


def has_supported_shapes(link: UrdfLink) -> bool:
    """Return whether all visual or all collision elements are boxes, cylinders and spheres."""
    return any(found and all(map(_is_supported, found)) for found in map(link.element.find_all, GEOMETRY_TAGS))


def _is_supported(element: XmlElement) -> bool:
    """Return whether the element is a box, cylinder or sphere."""
    return _find_form(element) is not None


def _find_form(element: XmlElement) -> XmlElement | None:
    parts = [part for geometry in element.find_all("geometry") for part in geometry.children]
    return parts[0] if len(parts) == 1 and parts[0].tag in SIZE_ATTRIBUTES else None


def _make_shape(
    element: XmlElement, R: Matrix, density: float, link: UrdfLink, fields: UrdfFields
) -> DescribedEntry | None:
    form, pose = _find_form(element), read_pose(element, link.path, fields)
    if form is None:
        parts = [part.tag for geometry in element.find_all("geometry") for part in geometry.children]
        geometry_text = f"a {parts[0]}" if parts else "nothing"
        message = f"it has no <inertial>, and its {element.tag} is {geometry_text}: not a shape that --density can fill"
        hint = "give it an <inertial>; --density fills boxes, cylinders and spheres, and links made only of meshes"
        fields.report("import-shape", element, link.path, message, hint)
        return None
    sizes = _read_sizes(form, link, fields)
    if sizes is None or pose is None:
        return None
    attitude = compose_rotations(R, rotation_from_roll_pitch_yaw(pose.rpy))
    return DescribedEntry("", _shape_keys(form.tag, rotate_vector(R, pose.xyz), attitude, sizes) | {"density": density})


def _shape_keys(form: str, center: Vec, attitude: Matrix, sizes: tuple[float, ...]) -> dict[str, Any]:
    """Make the keys of a shape, along the world's axes."""
    if form == "sphere":
        return {"type": "sphere", "center": center, "radius": sizes[0]}
    if form == "cylinder":
        half = rotate_vector(attitude, (0.0, 0.0, sizes[1] / 2.0))
        ends = {"from": add_vectors(center, (-half[0], -half[1], -half[2])), "to": add_vectors(center, half)}
        return {"type": "cylinder", **ends, "radius": sizes[0]}
    if is_right_angled(attitude):
        x, y, z = (abs(size) for size in rotate_vector(attitude, (sizes[0], sizes[1], sizes[2])))
        return {"type": "box", "center": center, "size": (x, y, z)}
    rows = tuple(round_vector(row) for row in attitude)
    return {"type": "box", "center": center, "size": sizes, "orientation": {"matrix": rows}}


def _read_sizes(form: XmlElement, link: UrdfLink, fields: UrdfFields) -> tuple[float, ...] | None:
    """Read the sizes [m], all above 0; None if they are wrong."""
    values: list[float] = []
    for name in SIZE_ATTRIBUTES[form.tag]:
        found = fields.read_numbers(form, name, link.path, 3 if name == "size" else 1, None)
        if found is None:
            return None
        values += found
    if min(values) <= 0.0:
        message = f"the dimensions of the {form.tag} are {', '.join(f'{value:g}' for value in values)}"
        fields.report("import-shape", form, link.path, message, "each dimension must be above 0")
        return None
    return tuple(values)
