"""URDF -> a described machine: read, judged as a whole, then said in the words of a spec."""

from __future__ import annotations

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.models import Matrix
from heuncli.scene.importers.asked import ImportAsked
from heuncli.scene.importers.described import DescribedEntry, DescribedMachine
from heuncli.scene.importers.urdf.carriers import attitudes_of, heads_of, placed_links
from heuncli.scene.importers.urdf.document import Robot, robot_of
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.geometry import has_plain, shapes_of
from heuncli.scene.importers.urdf.masses import LinkMass, mass_of, without_mass
from heuncli.scene.importers.urdf.said import JudgedRobot, said
from heuncli.scene.importers.urdf.tree import LinkTree, tree_of
from heuncli.scene.importers.xml_elements import XmlElement

WORLD = "world"  # the name of a root that is the ground
MASSES_HINT = (
    "give it an <inertial>; --density fills boxes, cylinders, spheres, meshes; --repair massless gives it 1 mg"
)


def described(_content: bytes, file: str, root: XmlElement, asked: ImportAsked, sha256: str) -> DescribedMachine:
    """The machine that a URDF describes. Raises SpecError with all problems, in the order of the lines."""
    fields = UrdfFields(file, "right-angles" in asked.repair)
    robot = robot_of(root, fields)
    tree = tree_of(robot, fields)
    masses = {name: mass_of(link, asked.repair, fields) for name, link in robot.links.items()}
    known = {name: mass for name, mass in masses.items() if mass is not None}
    judged = None if tree is None or fields.problems else _judged(robot, tree, known, asked, fields)
    if judged is None or fields.problems:
        raise SpecError(*sorted(fields.problems, key=lambda problem: problem.location[1:3] if problem.location else ()))
    return said(judged, asked, fields, sha256)


def _judged(
    robot: Robot, tree: LinkTree, masses: dict[str, LinkMass], asked: ImportAsked, fields: UrdfFields
) -> JudgedRobot | None:
    """The robot with all that is found out of it; None, and problems, where it is no machine."""
    attitudes = attitudes_of(tree)
    meshes = _meshes(tree, masses, asked, fields)
    shapes = _shapes(tree, attitudes, {*masses, *meshes}, asked, fields)
    masses = masses | {name: mass for name, mass in meshes.items() if mass is not None}
    grounded = not asked.base_free
    if asked.base_free and tree.root.name == WORLD:
        message = "the root is the world itself, which --base free would let go"
        hint = "leave --base out; a joint of type floating lets a link go"
        fields.report("import-tree", tree.root.element, tree.root.path, message, hint)
    placed, lost = placed_links(tree, attitudes, {*masses, *shapes, *meshes}, grounded)
    heads = heads_of(tree)
    unborne = list(dict.fromkeys(heads[name] for name in lost))
    if unborne and "massless" in asked.repair:
        masses = masses | {name: without_mass(robot.links[name]) for name in unborne}
        placed, _ = placed_links(tree, attitudes, {*masses, *shapes}, grounded)
    else:
        _report_lost(unborne, robot, tree, fields)
    if not masses and not shapes and not fields.problems:
        message = "no link has a mass"
        fields.report("import-mass", robot.element, "", message, "give the links that move an <inertial>, or --density")
    return None if fields.problems else JudgedRobot(robot, tree, masses, shapes, placed, grounded)


def _report_lost(unborne: list[str], robot: Robot, tree: LinkTree, fields: UrdfFields) -> None:
    """Links without mass that no body carries."""
    for name in unborne:
        joint = tree.above.get(name)
        moved = "is to be free" if joint is None else f"is moved by the joint {joint.name} ({joint.kind})"
        message = f"it has no mass, nor has anything fixed to it, and {moved}"
        link = robot.links[name]
        fields.report("import-massless", link.element, link.path, message, MASSES_HINT)


def _meshes(
    tree: LinkTree, masses: dict[str, LinkMass], asked: ImportAsked, fields: UrdfFields
) -> dict[str, LinkMass | None]:
    """Masses of links without one whose elements are meshes, where a density was given; None of those in error."""
    if asked.density is None:
        return {}
    bare = [link for link in tree.links if link.name not in masses and not has_plain(link)]
    found: dict[str, LinkMass | None] = {}
    for link in bare:
        from heuncli.scene.importers.urdf.meshes import (  # with NumPy, which few models need
            mass_of_meshes,
            source_of_meshes,
        )

        source = source_of_meshes(link)
        if source is not None:
            found[link.name] = mass_of_meshes(link, source, asked.density, fields)
    return found


def _shapes(
    tree: LinkTree, attitudes: dict[str, Matrix], known: set[str], asked: ImportAsked, fields: UrdfFields
) -> dict[str, tuple[str, tuple[DescribedEntry, ...]]]:
    """Shapes of links without mass, where a density was given; and of which elements they are."""
    if asked.density is None:
        return {}
    found = {
        link.name: shapes_of(link, attitudes[link.name], asked.density, fields)
        for link in tree.links
        if link.name not in known
    }
    return {name: shapes for name, shapes in found.items() if shapes[1]}
