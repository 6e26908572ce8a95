"""Mass properties of a link whose collision or visual elements are meshes, of the density that was asked for.

The file of a mesh is looked for beside the model; `package://NAME/...` in a folder NAME above it, or below one that is.
What comes of it are numbers: the spec that is made names no file. Impure: reads the meshes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.foreign_text import shown
from heuncli.results.results import Array
from heuncli.scene.file_format.models import ZERO
from heuncli.scene.file_format.named_files import LARGEST
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.scene.importers.attitudes import of_roll_pitch_yaw
from heuncli.scene.importers.urdf.document import UrdfLink, pose_of
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.geometry import SOURCES
from heuncli.scene.importers.urdf.masses import LinkMass
from heuncli.scene.importers.xml_elements import XmlElement
from heuncli.scene.meshes.model import middle_of, moments
from heuncli.scene.meshes.reading import mesh_of
from heuncli.scene.shapes.inertia import assembled, properties

PACKAGE, FILE = "package://", "file://"


def source_of_meshes(link: UrdfLink) -> str | None:
    """Which elements of a link are meshes, all of them; None if none are so."""
    found = {source: [_form(element) for element in link.element.all(source)] for source in SOURCES}
    whole = (source for source in SOURCES if found[source] and all(form is not None for form in found[source]))
    return next(whole, None)


def _form(element: XmlElement) -> XmlElement | None:
    parts = [part for geometry in element.all("geometry") for part in geometry.inner]
    return parts[0] if len(parts) == 1 and parts[0].tag == "mesh" and "filename" in parts[0].attributes else None


def mass_of_meshes(link: UrdfLink, source: str, density: float, fields: UrdfFields) -> LinkMass | None:
    """The mass, centre and inertia of a link's meshes; None, and problems, where one is no solid."""
    parts = [_pseudo_inertia(element, density, link, fields) for element in link.element.all(source)]
    known = [part for part in parts if part is not None]
    if len(known) < len(parts):
        return None
    mass, center, inertia = properties(np.sum(known, axis=0))
    x, y, z = center.tolist()
    a, b, c = ((p, q, r) for p, q, r in inertia.tolist())
    note = f"of the {source} meshes, at {density:g} kg/m^3" + (": what overlaps counts twice" if len(known) > 1 else "")
    return LinkMass(mass, (x, y, z), ZERO, (a, b, c), {"mass": note})


def _pseudo_inertia(element: XmlElement, density: float, link: UrdfLink, fields: UrdfFields) -> Array | None:
    """Of one mesh, in the link's frame."""
    form, pose = _form(element), pose_of(element, link.path, fields)
    assert form is not None
    scale = fields.numbers(form, "scale", link.path, 3, (1.0, 1.0, 1.0)) if "scale" in form.attributes else (1.0,) * 3
    if pose is None or scale is None:
        return None
    name = form.attributes["filename"]
    try:
        path = path_of(name, fields.file)
        mesh = mesh_of(read_bytes(str(path), LARGEST), path.name)
        if not all(scale):
            raise Finding("import-shape", "its scale is 0 along an axis", "one mesh's unit in m: 0.001 0.001 0.001")
    except Finding as finding:
        message = f"it has no <inertial>, and its {element.tag} {shown(name)} has no mass: {finding.message}"
        fields.report("import-shape", form, link.path, message, f"give it an <inertial>; or {finding.hint}")
        return None
    corners = mesh.corners * np.array(scale)
    volume, first, second = moments(corners, mesh.triangles)
    side = density * (1.0 if volume > 0.0 else -1.0)  # mirrored, its triangles are turned inward
    P = side * assembled(np.array(volume), first, second)
    G = np.eye(4)
    G[:3, :3] = np.array(of_roll_pitch_yaw(pose.rpy))
    G[:3, 3] = G[:3, :3] @ middle_of(corners) + np.array(pose.xyz)
    return np.asarray(G @ P @ G.T)


def path_of(name: str, model: str) -> Path:
    """Where the file of a mesh stands. Raises Finding where none is there."""
    folder = Path() if model == STANDARD_INPUT else Path(model).parent
    if name.startswith(PACKAGE):
        package, _, rest = name.removeprefix(PACKAGE).partition("/")
        above = [folder.absolute(), *folder.absolute().parents]
        places = [place / rest for place in above if place.name == package]
        places += [place / package / rest for place in above]
    else:
        places = [folder / name.removeprefix(FILE)]
    try:
        found = next((place for place in places if place.is_file()), None)
    except (OSError, ValueError):  # no name of a file
        found = None
    if found is None:
        raise Finding(
            "import-shape", "there is no such file", "put it where the model names it; package://NAME is NAME/"
        )
    return found
