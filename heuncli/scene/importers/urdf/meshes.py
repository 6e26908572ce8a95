"""Compute the mass properties of a link whose collision or visual elements are meshes, from the density of --density.

A mesh file is searched for relative to the model; `package://NAME/...` in a folder NAME above the model, or inside a
folder above it. The result is numbers: the spec names no mesh file. Impure: reads the meshes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.text_safety import escape
from heuncli.results.results import Array
from heuncli.scene.file_format.models import ZERO
from heuncli.scene.file_format.named_files import MAX_FILE_SIZE
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.scene.importers.attitudes import rotation_from_roll_pitch_yaw
from heuncli.scene.importers.urdf.document import UrdfLink, read_pose
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.masses import GEOMETRY_TAGS, LinkMass
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
