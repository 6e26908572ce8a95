"""Compute mass and inertia of a URDF's link from its shapes or meshes at one density.

    P = sum V diag(T, 1) of all elements, T = diag(a^2, b^2, c^2)/12 of a box,
    diag(r^2/4, r^2/4, l^2/12) of a cylinder, r^2/5 of a sphere

Where <inertia> is missing, the density is the one that gives the stated mass, so only the ratio of the elements'
volumes matters; where the mass is missing, it is that of --density. A mesh file is searched for relative to the model;
`package://NAME/...` in a folder NAME above the model, or inside a folder above it. The result is numbers: the spec
names no mesh file. Impure: reads the meshes.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.text_safety import escape
from heuncli.results.results import Array
from heuncli.scene.file_format.models import ZERO
from heuncli.scene.file_format.named_files import MAX_FILE_SIZE
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.scene.importers.attitudes import rotation_from_roll_pitch_yaw
from heuncli.scene.importers.urdf.document import Inertial, UrdfLink, read_pose
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.masses import GEOMETRY_TAGS, LinkMass, find_form, has_supported_shapes, read_sizes
from heuncli.scene.importers.xml_elements import XmlElement
from heuncli.scene.meshes.model import middle_of_extent, volume_moments
from heuncli.scene.meshes.reading import read_closed_mesh
from heuncli.scene.shapes.inertia import assemble_pseudo_inertia, split_pseudo_inertia

PACKAGE_PREFIX, FILE_PREFIX = "package://", "file://"


def find_mesh_tag(link: UrdfLink) -> str | None:
    """Return the tag, collision or visual, whose elements in a link are all meshes; None if there is none."""
    found = {
        source: [_find_mesh_element(element) for element in link.element.find_all(source)] for source in GEOMETRY_TAGS
    }
    matching = (source for source in GEOMETRY_TAGS if found[source] and all(form is not None for form in found[source]))
    return next(matching, None)


def _find_mesh_element(element: XmlElement) -> XmlElement | None:
    parts = [part for geometry in element.find_all("geometry") for part in geometry.children]
    return parts[0] if len(parts) == 1 and parts[0].tag == "mesh" and "filename" in parts[0].attributes else None


def compute_mesh_mass(link: UrdfLink, tag: str, density: float, fields: UrdfFields) -> LinkMass | None:
    """Compute the mass, centre and inertia of a link's meshes; None, and problems, if one is no solid."""
    parts = [mesh_pseudo_inertia(element, density, link, fields) for element in link.element.find_all(tag)]
    known = [part for part in parts if part is not None]
    if len(known) < len(parts):
        return None
    mass, center, inertia = split_pseudo_inertia(np.sum(known, axis=0))
    x, y, z = center.tolist()
    a, b, c = ((p, q, r) for p, q, r in inertia.tolist())
    note = f"from the {tag} meshes, at {density:g} kg/m^3" + (": overlaps count twice" if len(known) > 1 else "")
    return LinkMass(mass, (x, y, z), ZERO, (a, b, c), {"mass": note})


def mesh_pseudo_inertia(element: XmlElement, density: float, link: UrdfLink, fields: UrdfFields) -> Array | None:
    """Compute the pseudo-inertia (4, 4) of one mesh, in the link's frame."""
    form, pose = _find_mesh_element(element), read_pose(element, link.path, fields)
    assert form is not None
    scale = (
        fields.read_numbers(form, "scale", link.path, 3, (1.0, 1.0, 1.0)) if "scale" in form.attributes else (1.0,) * 3
    )
    if pose is None or scale is None:
        return None
    name = form.attributes["filename"]
    try:
        path = find_mesh_file(name, fields.file)
        mesh = read_closed_mesh(read_bytes(str(path), MAX_FILE_SIZE), path.name)
        if not all(scale):
            raise Finding(
                "import-shape",
                "its scale is 0 along an axis",
                "give the length of one mesh unit in m: 0.001 0.001 0.001",
            )
    except Finding as finding:
        message = f"it has no <inertial>, and its {element.tag} {escape(name)} cannot give a mass: {finding.message}"
        fields.report("import-shape", form, link.path, message, f"give it an <inertial>; or {finding.hint}")
        return None
    corners = mesh.corners * np.array(scale)
    volume, first, second = volume_moments(corners, mesh.triangles)
    signed_density = density * (1.0 if volume > 0.0 else -1.0)  # a mirrored mesh has its triangles inward
    P = signed_density * assemble_pseudo_inertia(np.array(volume), first, second)
    G = np.eye(4)
    G[:3, :3] = np.array(rotation_from_roll_pitch_yaw(pose.rpy))
    G[:3, 3] = G[:3, :3] @ middle_of_extent(corners) + np.array(pose.xyz)
    return np.asarray(G @ P @ G.T)


def find_mesh_file(name: str, model: str) -> Path:
    """Find the file of a mesh. Raises Finding [import-shape] if it is nowhere."""
    folder = Path() if model == STANDARD_INPUT else Path(model).parent
    if name.startswith(PACKAGE_PREFIX):
        package, _, rest = name.removeprefix(PACKAGE_PREFIX).partition("/")
        above = [folder.absolute(), *folder.absolute().parents]
        candidates = [place / rest for place in above if place.name == package]
        candidates += [place / package / rest for place in above]
    else:
        candidates = [folder / name.removeprefix(FILE_PREFIX)]
    try:
        found = next((place for place in candidates if place.is_file()), None)
    except (OSError, ValueError):  # not a valid file name
        found = None
    if found is None:
        raise Finding(
            "import-shape", "file not found", "put it at the path given in the model; package://NAME is NAME/"
        )
    return found


def compute_shape_mass(link: UrdfLink, inertial: Inertial, fields: UrdfFields) -> LinkMass | None:
    """Compute the mass properties of a link from its mass and its shapes; None, and problems, if one is no solid.

    The centre of mass is the stated one, or that of the shapes if the file states none.
    """
    mesh_tag = None if has_supported_shapes(link) else find_mesh_tag(link)
    tag = mesh_tag or _find_shape_tag(link)
    elements = link.element.find_all(tag)
    if mesh_tag is not None:
        parts = [mesh_pseudo_inertia(element, 1.0, link, fields) for element in elements]
    else:
        parts = [_shape_pseudo_inertia(element, link, fields) for element in elements]
    known = [part for part in parts if part is not None]
    if len(known) < len(parts):
        return None
    volume, center, inertia = split_pseudo_inertia(np.sum(known, axis=0))
    x, y, z = center.tolist()
    a, b, c = ((p, q, r) for p, q, r in (inertia * (inertial.mass / volume)).tolist())
    notes = {"inertia": f"repaired (shape): that of the {tag} elements, scaled to the mass; the file has none"}
    if not inertial.has_center:
        notes["center"] = f"that of the {tag} elements; the file has none"
    return LinkMass(inertial.mass, inertial.pose.xyz if inertial.has_center else (x, y, z), ZERO, (a, b, c), notes)


def _find_shape_tag(link: UrdfLink) -> str:
    """Return the tag, collision or visual, whose elements are all shapes; else the first that occurs."""
    found = {tag: link.element.find_all(tag) for tag in GEOMETRY_TAGS}
    present = [tag for tag in GEOMETRY_TAGS if found[tag]]
    return next((tag for tag in present if all(find_form(element) is not None for element in found[tag])), present[0])


def _shape_pseudo_inertia(element: XmlElement, link: UrdfLink, fields: UrdfFields) -> Array | None:
    """Compute the pseudo-inertia (4, 4) of one shape of density 1, in the link's frame."""
    form, pose = find_form(element), read_pose(element, link.path, fields)
    if form is None:
        message = f"its {element.tag} is not a box, cylinder or sphere, so it gives no inertia"
        hint = "give it an <inertia>; or --repair point makes it a point mass"
        fields.report("import-shape", element, link.path, message, hint)
        return None
    sizes = read_sizes(form, link, fields)
    if sizes is None or pose is None:
        return None
    if form.tag == "box":
        volume, squares = math.prod(sizes), [size * size / 12.0 for size in sizes]
    elif form.tag == "cylinder":
        radius, length = sizes
        volume, squares = math.pi * radius**2 * length, [radius**2 / 4.0, radius**2 / 4.0, length**2 / 12.0]
    else:
        volume, squares = 4.0 / 3.0 * math.pi * sizes[0] ** 3, [sizes[0] ** 2 / 5.0] * 3
    P = assemble_pseudo_inertia(np.array(volume), np.zeros(3), volume * np.diag(squares))
    G = np.eye(4)
    G[:3, :3] = np.array(rotation_from_roll_pitch_yaw(pose.rpy))
    G[:3, 3] = pose.xyz
    return np.asarray(G @ P @ G.T)
