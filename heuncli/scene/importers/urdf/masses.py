"""The mass of a link: its properties, validated and repaired, or its shapes with their density.

Mass properties must be those of rigid bodies; --repair names the faults that are repaired:

    A1 <= A2 <= A3, principal moments:    0 <= A1,  A3 <= A1 + A2

Without repair, the moments may violate this by what heun accepts as rounding. A repair changes as little as possible:

    negative    moments below 0 become 0
    triangle    A1 and A2 are raised, each by half of A3 - A1 - A2, which minimizes the sum of squares of the changes
    zero        a link with a mass and no moment at all becomes a point mass
    point       a link with a mass and no <inertia> becomes a point mass
    shape       a link with a mass and no <inertia> gets the inertia of its shapes, scaled to its mass
    massless    a link without mass at the end of a chain gets a point mass of REPAIRED_MASS at its origin; a mass of
                0 loses its inertia

Moments that are rounding beside mass * size^2 count as 0 before they are judged.

A link without mass between two joints is a body of mass 0, if a joint beyond it moves something with a mass. Others
have shapes of the density of --density. The collision elements are used if all of them are boxes,
cylinders and spheres, otherwise the visual ones. A URDF cylinder is centred at the origin, with its axis along z.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.models import ZERO, Vec
from heuncli.scene.file_format.rotations import symmetric_eigenvalues
from heuncli.scene.importers.attitudes import (
    add_vectors,
    compose_rotations,
    is_right_angled,
    rotate_vector,
    rotation_from_roll_pitch_yaw,
    round_number,
    round_vector,
)
from heuncli.scene.importers.description import DescribedEntry, ImportOptions
from heuncli.scene.importers.spec_text import format_number
from heuncli.scene.importers.urdf.document import Inertial, Robot, UrdfLink, read_pose
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.tree import LinkTree
from heuncli.scene.importers.xml_elements import XmlElement

# Masses

REPAIRED_MASS = 1e-6  # [kg] mass given to a massless link that moves: below the last digit of robot masses


class LinkMass(NamedTuple):
    """mass: [kg]
    center: centre of mass in the link's frame [m]
    rpy: roll, pitch, yaw of the inertia's axes [rad]
    inertia: about the centre of mass, in those axes [kg m^2]
    notes: remarks by key
    """

    mass: float
    center: Vec
    rpy: Vec
    inertia: Matrix
    notes: dict[str, str]


def find_size(robot: Robot) -> float:
    """Return the size of a robot [m]: the longest distance in its joints and centres of mass, or 1 if all are 0."""
    places = [joint.pose.xyz for joint in robot.joints.values()]
    places += [link.inertial.pose.xyz for link in robot.links.values() if link.inertial is not None]
    return max((math.hypot(*place) for place in places), default=0.0) or 1.0


def validate_mass(link: UrdfLink, repair: frozenset[str], size: float, fields: UrdfFields) -> LinkMass | None:
    """Return the validated mass properties of a link; None if it has none, or if they are wrong, which is then a
    problem.

    size: of the robot [m]
    """
    inertial = link.inertial
    if inertial is not None and inertial.moments is not None:
        least = tolerances.NO_IMPORTED_MOMENT * abs(inertial.mass) * size * size
        moments = tuple(0.0 if abs(moment) <= least else moment for moment in inertial.moments)
        inertial = inertial._replace(moments=moments)
    if inertial is None or (inertial.mass == 0.0 and not any(inertial.moments or ())):
        return None  # explicitly without mass
    if inertial.mass == 0.0 and "massless" in repair:
        fields.links_without_inertia[link.name] = None
        return None
    if inertial.mass <= 0.0:
        message = "the mass is 0, the inertia is not" if inertial.mass == 0.0 else f"the mass is {inertial.mass:g} kg"
        hint = "a moving link needs a mass above 0; leave out <inertial> for a frame without mass"
        if inertial.mass == 0.0:
            hint += "; --repair massless leaves the inertia out"
        fields.report("import-mass", inertial.element, link.path, message, hint)
        return None
    if inertial.moments is None:
        return _make_point_mass(link, inertial, repair, fields)
    validation = _InertiaValidation(link, inertial, inertial.moments, repair, fields)
    validation.check_zero()
    validation.check_negative()
    validation.check_triangle()
    return LinkMass(inertial.mass, inertial.pose.xyz, inertial.pose.rpy, validation.inertia, validation.notes)


def takes_inertia_of_shapes(link: UrdfLink, options: ImportOptions) -> bool:
    """Return whether a link has a mass without inertia that the options take from its shapes."""
    inertial, is_asked = link.inertial, "shape" in options.repair or options.density is not None
    if inertial is None or inertial.moments is not None or inertial.mass <= 0.0 or "point" in options.repair:
        return False
    return is_asked and _has_geometry(link)


def _has_geometry(link: UrdfLink) -> bool:
    return any(link.element.find_all(tag) for tag in GEOMETRY_TAGS)


def _make_point_mass(link: UrdfLink, inertial: Inertial, repair: frozenset[str], fields: UrdfFields) -> LinkMass | None:
    """Make a link with a mass and no inertia a point mass, if that repair is asked for; else it is a problem."""
    if "point" in repair:
        notes = {"inertia": "repaired (point): a point mass; the file has no inertia"}
        return LinkMass(inertial.mass, inertial.pose.xyz, ZERO, (ZERO, ZERO, ZERO), notes)
    hint = "add it, or repair it: --repair point makes a point mass at the origin of <inertial>"
    if _has_geometry(link):
        hint += "; --repair shape (or --density) scales its shapes to the mass"
    fields.report("import-missing", inertial.element, link.path, "<inertial> has no <inertia>", hint)
    return None


class _InertiaValidation:
    """The inertia of one link while it is checked for three faults."""

    def __init__(
        self, link: UrdfLink, inertial: Inertial, moments: tuple[float, ...], repair: frozenset[str], fields: UrdfFields
    ) -> None:
        self.link, self.inertial, self.repair, self.fields = link, inertial, repair, fields
        self.moments, self.inertia = moments, _make_tensor(moments)
        self.repairs_done: list[str] = []
        self.notes: dict[str, str] = {}

    def check_zero(self) -> None:
        """Check that some moment is not 0. A moment of 0 about one axis is a thin rod, which is a valid body."""
        if not any(self.moments):
            if "zero" in self.repair:
                self.notes["inertia"] = "repaired (zero): a point mass; all moments are 0 in the file"
            else:
                self.report(
                    f"all moments of inertia are 0, but the mass is {self.inertial.mass:g} kg",
                    "zero",
                    "makes it a point mass",
                )
        elif (moments := symmetric_eigenvalues(self.inertia))[0] == 0.0 and moments[2] - moments[1] <= self.tolerance(
            "triangle"
        ):
            self.notes["inertia"] = "a thin rod: no moment of inertia about its axis"

    def check_negative(self) -> None:
        """Check that no principal moment is below 0."""
        moments = symmetric_eigenvalues(self.inertia)
        if moments[0] >= -self.tolerance("negative"):
            return
        if "negative" in self.repair:
            least, middle, most = (max(moment, 0.0) for moment in moments)
            self.replace_moments("negative", (least, middle, most))
        else:
            self.report(
                f"a principal moment of inertia is negative: {_format_moments(moments)} kg m^2",
                "negative",
                "sets it to 0",
            )

    def check_triangle(self) -> None:
        """Check that no principal moment exceeds the sum of the other two."""
        least, middle, most = moments = symmetric_eigenvalues(self.inertia)
        excess = most - least - middle
        if excess <= self.tolerance("triangle") or least < -self.tolerance("negative"):  # reported already if negative
            return
        if "triangle" in self.repair:
            self.replace_moments("triangle", (least + excess / 2.0, middle + excess / 2.0, most))
        else:
            message = f"no body has the principal moments {_format_moments(moments)} kg m^2: "
            message += "none may exceed the sum of the others"
            self.report(message, "triangle", "increases the two smaller ones")

    def tolerance(self, word: str) -> float:
        """Return the accepted violation of a rule [kg m^2]; after a repair, it is that of typed digits."""
        share = tolerances.INERTIA_TYPED if word in self.repair else tolerances.INERTIA_REFUSED
        return share * max(map(abs, symmetric_eigenvalues(self.inertia)))

    def report(self, message: str, word: str, effect: str) -> None:
        hint = f"check the exporting program; --repair {word} {effect} and notes this next to the value"
        self.fields.report("import-inertia", self.inertial.element, self.link.path, message, hint)

    def replace_moments(self, word: str, moments: Vec) -> None:
        """Set other principal moments, ascending, about the same axes, and note both."""
        self.repairs_done.append(word)
        old = _format_moments(symmetric_eigenvalues(_make_tensor(self.moments)))
        words = ", ".join(self.repairs_done)
        self.notes["inertia"] = f"repaired ({words}): principal moments {_format_moments(moments)}; the file has {old}"
        self.inertia = _replace_principal_moments(self.inertia, moments)


def _replace_principal_moments(inertia: Matrix, moments: Vec) -> Matrix:
    """Return the tensor of the same principal axes with other moments, ascending."""
    size = max(map(abs, moments))
    if all(inertia[i][j] == 0.0 for i, j in ((0, 1), (0, 2), (1, 2))):
        order = sorted(range(3), key=lambda i: inertia[i][i])
        given = {axis: round_number(moment, size) for axis, moment in zip(order, moments, strict=True)}
        return (given[0], 0.0, 0.0), (0.0, given[1], 0.0), (0.0, 0.0, given[2])
    import numpy as np  # takes 50 ms, and only such a file needs it

    _, axes = np.linalg.eigh(np.array(inertia))  # ascending, as the moments are
    tensor = (axes * np.array(moments)) @ axes.T
    rows = [[round_number(float(tensor[i][j] + tensor[j][i]) / 2.0, size) for j in range(3)] for i in range(3)]
    return tuple(map(tuple, rows))  # type: ignore[return-value]


def _make_tensor(moments: tuple[float, ...]) -> Matrix:
    xx, yy, zz, xy, xz, yz = moments
    return (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)


def _format_moments(moments: Vec) -> str:
    return ", ".join(format_number(float(f"{moment:.6g}")) for moment in moments)


MASSLESS = LinkMass(0.0, ZERO, ZERO, (ZERO, ZERO, ZERO), {"mass": "a frame between joints"})


def find_massless_frames(tree: LinkTree, heads: Collection[str], links_with_mass: Collection[str]) -> set[str]:
    """Find the links without mass that are frames between joints: one joint moves them, another carries from them
    something with a mass.

    heads: first links of the rigid groups without mass
    """
    has_load: set[str] = set()  # links with a mass on them or beyond them
    for link in reversed(tree.links):
        joint = tree.parent_joints.get(link.name)
        if joint is not None and (link.name in links_with_mass or link.name in has_load) and joint.kind != "floating":
            has_load.add(joint.parent)
    frames = {name for name in heads if name in has_load}
    return {name for name in frames if name in tree.parent_joints and tree.parent_joints[name].has_one_coordinate}


def make_repaired_mass(link: UrdfLink) -> LinkMass:
    """Make the mass properties that the repair `massless` gives a link without mass."""
    reason = "has no mass" if link.inertial is None else "has mass 0"
    notes = {"mass": f"repaired (massless): the link {reason} in the file"}
    return LinkMass(REPAIRED_MASS, ZERO, ZERO, (ZERO, ZERO, ZERO), notes)


# Geometry

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
        (source for source in present if all(map(is_supported, found[source]))), present[0] if present else ""
    )
    shapes = [_make_shape(element, R, density, link, fields) for element in found.get(source, ())]
    return source, tuple(shape for shape in shapes if shape is not None)


def has_supported_shapes(link: UrdfLink) -> bool:
    """Return whether all visual or all collision elements are boxes, cylinders and spheres."""
    return any(found and all(map(is_supported, found)) for found in map(link.element.find_all, GEOMETRY_TAGS))


def is_supported(element: XmlElement) -> bool:
    """Return whether the element is a box, cylinder or sphere."""
    return find_form(element) is not None


def find_form(element: XmlElement) -> XmlElement | None:
    parts = [part for geometry in element.find_all("geometry") for part in geometry.children]
    return parts[0] if len(parts) == 1 and parts[0].tag in SIZE_ATTRIBUTES else None


def _make_shape(
    element: XmlElement, R: Matrix, density: float, link: UrdfLink, fields: UrdfFields
) -> DescribedEntry | None:
    form, pose = find_form(element), read_pose(element, link.path, fields)
    if form is None:
        parts = [part.tag for geometry in element.find_all("geometry") for part in geometry.children]
        geometry_text = f"a {parts[0]}" if parts else "nothing"
        message = f"it has no <inertial>, and its {element.tag} is {geometry_text}: not a shape that --density can fill"
        hint = "give it an <inertial>; --density fills boxes, cylinders and spheres, and links made only of meshes"
        fields.report("import-shape", element, link.path, message, hint)
        return None
    sizes = read_sizes(form, link, fields)
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


def read_sizes(form: XmlElement, link: UrdfLink, fields: UrdfFields) -> tuple[float, ...] | None:
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
