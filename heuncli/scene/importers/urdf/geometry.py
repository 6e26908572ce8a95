"""Shapes of a link that has no inertia: its collision or visual elements, of the density that was asked for.

The collision elements where all of them are boxes, cylinders and spheres, else the visual ones. The cylinder of URDF
stands about its z axis, with its middle in the origin.
"""

from __future__ import annotations

from typing import Any

from heuncli.scene.file_format.models import Matrix, Vec
from heuncli.scene.importers.attitudes import after, is_right, kept, of_roll_pitch_yaw, shifted, turned
from heuncli.scene.importers.described import DescribedEntry
from heuncli.scene.importers.urdf.document import UrdfLink, pose_of
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.xml_elements import XmlElement

SOURCES = ("collision", "visual")
MEASURES = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}


def shapes_of(link: UrdfLink, R: Matrix, density: float, fields: UrdfFields) -> tuple[str, tuple[DescribedEntry, ...]]:
    """Which elements they are of, and the shapes, along the world's axes; none, and problems, of what is no shape.

    R: the attitude of the link with every joint at 0. A link without geometry has no shapes, and that is no problem.
    """
    found = {source: link.element.all(source) for source in SOURCES}
    given = [source for source in SOURCES if found[source]]
    source = next((source for source in given if all(map(_plain, found[source]))), given[0] if given else "")
    shapes = [_shape(element, R, density, link, fields) for element in found.get(source, ())]
    return source, tuple(shape for shape in shapes if shape is not None)


def has_plain(link: UrdfLink) -> bool:
    """Whether the elements of the one or the other kind are all of forms that heun has."""
    return any(found and all(map(_plain, found)) for found in map(link.element.all, SOURCES))


def _plain(element: XmlElement) -> bool:
    """Whether it is of a form that heun has."""
    return _form(element) is not None


def _form(element: XmlElement) -> XmlElement | None:
    parts = [part for geometry in element.all("geometry") for part in geometry.inner]
    return parts[0] if len(parts) == 1 and parts[0].tag in MEASURES else None


def _shape(element: XmlElement, R: Matrix, density: float, link: UrdfLink, fields: UrdfFields) -> DescribedEntry | None:
    form, pose = _form(element), pose_of(element, link.path, fields)
    if form is None:
        parts = [part.tag for geometry in element.all("geometry") for part in geometry.inner]
        what = f"a {parts[0]}" if parts else "nothing"
        message = f"it has no <inertial>, and its {element.tag} is {what}: no shape that --density can fill"
        hint = "give it an <inertial>; boxes, cylinders and spheres are filled, and meshes where all of it are"
        fields.report("import-shape", element, link.path, message, hint)
        return None
    sizes = _sizes(form, link, fields)
    if sizes is None or pose is None:
        return None
    attitude = after(R, of_roll_pitch_yaw(pose.rpy))
    return DescribedEntry("", _keys(form.tag, turned(R, pose.xyz), attitude, sizes) | {"density": density})


def _keys(form: str, center: Vec, attitude: Matrix, sizes: tuple[float, ...]) -> dict[str, Any]:
    """The keys of a shape, its axes along the world's."""
    if form == "sphere":
        return {"type": "sphere", "center": center, "radius": sizes[0]}
    if form == "cylinder":
        half = turned(attitude, (0.0, 0.0, sizes[1] / 2.0))
        ends = {"from": shifted(center, (-half[0], -half[1], -half[2])), "to": shifted(center, half)}
        return {"type": "cylinder", **ends, "radius": sizes[0]}
    if is_right(attitude):
        x, y, z = (abs(size) for size in turned(attitude, (sizes[0], sizes[1], sizes[2])))
        return {"type": "box", "center": center, "size": (x, y, z)}
    rows = tuple(kept(row) for row in attitude)
    return {"type": "box", "center": center, "size": sizes, "orientation": {"matrix": rows}}


def _sizes(form: XmlElement, link: UrdfLink, fields: UrdfFields) -> tuple[float, ...] | None:
    """Its measures [m], all above 0; None where they are wrong."""
    values: list[float] = []
    for name in MEASURES[form.tag]:
        found = fields.numbers(form, name, link.path, 3 if name == "size" else 1, None)
        if found is None:
            return None
        values += found
    if min(values) <= 0.0:
        message = f"the {form.tag} measures {', '.join(f'{value:g}' for value in values)}"
        fields.report("import-shape", form, link.path, message, "each measure is above 0")
        return None
    return tuple(values)
