"""Read a URDF into a described machine: read all elements, validate them as a whole, then translate them to a spec."""

from __future__ import annotations

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.models import Matrix
from heuncli.scene.importers.description import DescribedEntry, DescribedMachine
from heuncli.scene.importers.import_options import ImportOptions
from heuncli.scene.importers.urdf.carriers import compute_attitudes, find_group_heads, place_links
from heuncli.scene.importers.urdf.document import Robot, read_robot
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.geometry import has_supported_shapes, make_shapes
from heuncli.scene.importers.urdf.machine import ValidatedRobot, build_machine
from heuncli.scene.importers.urdf.masses import LinkMass, make_repaired_mass, validate_mass
from heuncli.scene.importers.urdf.tree import LinkTree, build_tree
from heuncli.scene.importers.xml_elements import XmlElement

WORLD_LINK = "world"  # a root link of this name is the ground
MASSLESS_HINT = (
    "give it an <inertial>; --density fills boxes, cylinders, spheres, meshes; --repair massless gives it 1 mg"
)


def described(_content: bytes, file: str, root: XmlElement, options: ImportOptions, sha256: str) -> DescribedMachine:
    """Read the machine that a URDF describes. Raises SpecError with all problems, in the order of their lines."""
    fields = UrdfFields(file, "right-angles" in options.repair)
    robot = read_robot(root, fields)
    tree = build_tree(robot, fields)
    masses = {name: validate_mass(link, options.repair, fields) for name, link in robot.links.items()}
    link_masses = {name: mass for name, mass in masses.items() if mass is not None}
    validated_robot = None if tree is None or fields.problems else _validate(robot, tree, link_masses, options, fields)
    if validated_robot is None or fields.problems:
        raise SpecError(*sorted(fields.problems, key=lambda problem: problem.location[1:3] if problem.location else ()))
    return build_machine(validated_robot, options, fields, sha256)


def _validate(
    robot: Robot, tree: LinkTree, masses: dict[str, LinkMass], options: ImportOptions, fields: UrdfFields
) -> ValidatedRobot | None:
    """Validate the robot as a machine, and return all that is derived from it; None, and problems, if it is no
    machine.
    """
    attitudes = compute_attitudes(tree)
    meshes = _compute_mesh_masses(tree, masses, options, fields)
    shapes = _find_shapes(tree, attitudes, {*masses, *meshes}, options, fields)
    masses = masses | {name: mass for name, mass in meshes.items() if mass is not None}
    is_grounded = not options.base_free
    if options.base_free and tree.root.name == WORLD_LINK:
        message = "the root is the world itself, which --base free cannot release"
        hint = "leave out --base; to release a link use a joint of type floating"
        fields.report("import-tree", tree.root.element, tree.root.path, message, hint)
    link_places, uncarried = place_links(tree, attitudes, {*masses, *shapes, *meshes}, is_grounded)
    heads = find_group_heads(tree)
    uncarried_heads = list(dict.fromkeys(heads[name] for name in uncarried))
    if uncarried_heads and "massless" in options.repair:
        masses = masses | {name: make_repaired_mass(robot.links[name]) for name in uncarried_heads}
        link_places, _ = place_links(tree, attitudes, {*masses, *shapes}, is_grounded)
    else:
        _report_uncarried(uncarried_heads, robot, tree, fields)
    if not masses and not shapes and not fields.problems:
        message = "no link has a mass"
        fields.report(
            "import-mass", robot.element, "", message, "give the moving links an <inertial>, or use --density"
        )
    return None if fields.problems else ValidatedRobot(robot, tree, masses, shapes, link_places, is_grounded)


def _report_uncarried(uncarried_heads: list[str], robot: Robot, tree: LinkTree, fields: UrdfFields) -> None:
    """Report links without mass that no body carries."""
    for name in uncarried_heads:
        joint = tree.parent_joints.get(name)
        reason = "is to be free" if joint is None else f"is moved by the joint {joint.name} ({joint.kind})"
        message = f"neither it nor anything fixed to it has mass, and it {reason}"
        link = robot.links[name]
        fields.report("import-massless", link.element, link.path, message, MASSLESS_HINT)


def _compute_mesh_masses(
    tree: LinkTree, masses: dict[str, LinkMass], options: ImportOptions, fields: UrdfFields
) -> dict[str, LinkMass | None]:
    """Compute the masses of links without one whose elements are meshes, if a density is given; None for those in
    error.
    """
    if options.density is None:
        return {}
    links_without_mass = [link for link in tree.links if link.name not in masses and not has_supported_shapes(link)]
    mesh_masses: dict[str, LinkMass | None] = {}
    for link in links_without_mass:
        from heuncli.scene.importers.urdf.meshes import (  # imports NumPy, which few models need
            compute_mesh_mass,
            find_mesh_tag,
        )

        source = find_mesh_tag(link)
        if source is not None:
            mesh_masses[link.name] = compute_mesh_mass(link, source, options.density, fields)
    return mesh_masses


def _find_shapes(
    tree: LinkTree, attitudes: dict[str, Matrix], links_with_mass: set[str], options: ImportOptions, fields: UrdfFields
) -> dict[str, tuple[str, tuple[DescribedEntry, ...]]]:
    """Find the shapes of links without mass, if a density is given, and the tag of the elements from which they
    come.
    """
    if options.density is None:
        return {}
    found = {
        link.name: make_shapes(link, attitudes[link.name], options.density, fields)
        for link in tree.links
        if link.name not in links_with_mass
    }
    return {name: shapes for name, shapes in found.items() if shapes[1]}
