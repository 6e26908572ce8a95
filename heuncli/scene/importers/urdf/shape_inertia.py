"""Compute the inertia of a link that has a mass and no <inertia>, from its shapes or meshes at one density.

    P = sum V diag(T, 1) of all elements, T = diag(a^2, b^2, c^2)/12 of a box,
    diag(r^2/4, r^2/4, l^2/12) of a cylinder, r^2/5 of a sphere

The density is the one that gives the stated mass, so only the ratio of the elements' volumes matters. Impure: reads
the meshes.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.file_format.models import ZERO
from heuncli.scene.importers.attitudes import rotation_from_roll_pitch_yaw
from heuncli.scene.importers.urdf.document import Inertial, UrdfLink, read_pose
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.masses import GEOMETRY_TAGS, LinkMass, find_form, has_supported_shapes, read_sizes
from heuncli.scene.importers.urdf.meshes import find_mesh_tag, mesh_pseudo_inertia
from heuncli.scene.importers.xml_elements import XmlElement
from heuncli.scene.shapes.inertia import assemble_pseudo_inertia, split_pseudo_inertia


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
