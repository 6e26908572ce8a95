"""Read a URDF into a described machine: read all elements, validate them as a whole, then translate them to a spec.

Links become bodies and points; joints are held by drives at their parameters.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.base.errors import Problem, SpecError
from heuncli.base.records import record
from heuncli.base.spelling import list_words
from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.models import Vec
from heuncli.scene.importers.attitudes import (
    add_vectors,
    compose_rotations,
    rotate_tensor,
    rotate_vector,
    rotation_from_roll_pitch_yaw,
)
from heuncli.scene.importers.description import (
    LEFT_OUT_CODE,
    DescribedBody,
    DescribedEntry,
    DescribedMachine,
    ImportOptions,
    assign_names,
    format_original_name,
    make_label,
)
from heuncli.scene.importers.urdf.carriers import (
    GROUND,
    PlacedLink,
    RobotPoints,
    SpecJoint,
    compute_attitudes,
    find_group_heads,
    iter_spec_joints,
    place_links,
)
from heuncli.scene.importers.urdf.coordinates import RobotCoordinates
from heuncli.scene.importers.urdf.document import WORLD_LINK, Robot, UrdfLink, read_robot
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.masses import (
    MASSLESS,
    LinkMass,
    find_massless_frames,
    find_size,
    has_supported_shapes,
    make_repaired_mass,
    make_shapes,
    takes_inertia_of_shapes,
    validate_mass,
)
from heuncli.scene.importers.urdf.tree import LinkTree, build_tree
from heuncli.scene.importers.xml_elements import XmlElement

# Machine

GRAVITY: Vec = (0.0, 0.0, -9.81)  # URDF has none; z is up in ROS
# A body in a plane also fits upside down, so its orientation is fixed, not searched; no joint may rotate the plane.
DRAWN_ORIENTATION = {"axis": (0.0, 0.0, 1.0), "angle": "0 deg"}


@record
class ValidatedRobot:
    """A robot without errors: the masses and shapes of its bodies, and the places of its links."""

    robot: Robot
    tree: LinkTree
    masses: dict[str, LinkMass]
    shapes: dict[str, tuple[str, tuple[DescribedEntry, ...]]]
    placed_links: dict[str, PlacedLink]
    is_grounded: bool


def build_machine(
    validated_robot: ValidatedRobot, options: ImportOptions, fields: UrdfFields, sha256: str
) -> DescribedMachine:
    """Build the machine. Raises SpecError if the options contradict the file."""
    carriers = [
        link.name for link in validated_robot.tree.links if validated_robot.placed_links[link.name].carrier == link.name
    ]
    bodies = dict(zip(carriers, assign_names("link", carriers), strict=True))
    points = RobotPoints()
    spec_joints = [
        *iter_spec_joints(
            validated_robot.tree,
            validated_robot.placed_links,
            validated_robot.is_grounded,
            points,
            validated_robot.robot.loop_joints,
        )
    ]
    points.assign_names(bodies)
    names = assign_names("joint", [one.original for one in spec_joints])
    coordinates = RobotCoordinates(spec_joints, names, validated_robot.tree.leaders, options, fields)
    _report_moving_planes(validated_robot, fields)
    if fields.problems:
        raise SpecError(*fields.problems)
    starts = _find_starts(validated_robot)
    return DescribedMachine(
        title=validated_robot.robot.title,
        form="URDF",
        file=fields.file,
        sha256=sha256,
        gravity=GRAVITY,
        bodies=tuple(
            _make_body(validated_robot, name, bodies[name], points, starts.get(name, {})) for name in carriers
        ),
        ground=points.get_points(GROUND),
        parameters=tuple(coordinates.parameters),
        joints=tuple(
            _make_joint(one, name, points, coordinates.initial.get(name, {}))
            for one, name in zip(spec_joints, names, strict=True)
        ),
        drives=tuple(coordinates.drives),
        forces=tuple(coordinates.dampers),
        stops=tuple(coordinates.stops),
        couplings=tuple(coordinates.couplings),
        header_lines=(*_header_lines(validated_robot, fields), *coordinates.header_lines),
        remarks={"gravity": "URDF defines none; z is up", "parameters": "joint positions"},
        left_out=(*fields.left_out, *coordinates.left_out, *_unsupported_damping(validated_robot, fields)),
    )


def _make_body(
    validated_robot: ValidatedRobot, link: str, name: str, points: RobotPoints, start: dict[str, Any]
) -> DescribedBody:
    R, remark = validated_robot.placed_links[link].R, format_original_name("link", name, link)
    start = {**make_label(name, link), **start}
    mass = validated_robot.masses.get(link)
    if mass is None:
        source, shapes = validated_robot.shapes[link]
        notes = {"shapes": f"from the {source} elements" + (": overlaps count twice" if len(shapes) > 1 else "")}
        return DescribedBody(name, None, None, None, points.get_points(link), shapes, start, remark, notes)
    if mass is MASSLESS:
        return DescribedBody(name, 0.0, None, None, points.get_points(link), (), start, remark, mass.notes)
    inertia = rotate_tensor(compose_rotations(R, rotation_from_roll_pitch_yaw(mass.rpy)), mass.inertia)
    center = rotate_vector(R, mass.center)
    return DescribedBody(name, mass.mass, center, inertia, points.get_points(link), (), start, remark, mass.notes)


def _make_joint(spec_joint: SpecJoint, name: str, points: RobotPoints, initial: dict[str, Any]) -> DescribedEntry:
    keys = {
        "type": spec_joint.type,
        "from": points.format_end(spec_joint.start),
        "to": points.format_end(spec_joint.end),
        **spec_joint.keys,
    }
    is_renamed = spec_joint.joint is not None and name != spec_joint.original
    remarks = (
        f'joint "{spec_joint.joint.name}"' if is_renamed and spec_joint.joint is not None else "",
        *spec_joint.remarks,
    )
    keys |= {"initial": initial} if initial else {}
    keys |= make_label(name, spec_joint.joint.name) if is_renamed and spec_joint.joint is not None else {}
    return DescribedEntry(name, keys, "; ".join(filter(None, remarks)))


def _find_starts(validated_robot: ValidatedRobot) -> dict[str, dict[str, Any]]:
    """Find the start keys of bodies that no joint places: floating ones, and those that shift in a plane."""
    found: dict[str, dict[str, Any]] = {}
    for link in validated_robot.tree.links:
        joint, placed_link = validated_robot.tree.parent_joints.get(link.name), validated_robot.placed_links[link.name]
        x, y, z = placed_link.offset
        origin = add_vectors(placed_link.origin, (-x, -y, -z))  # origin of the carrier
        if (joint is None and not validated_robot.is_grounded) or (joint is not None and joint.kind == "floating"):
            found[placed_link.carrier] = {"position": origin}
        elif joint is not None and joint.kind == "planar":
            found[placed_link.carrier] = {"orientation": DRAWN_ORIENTATION, "near": {"position": origin}}
    return found


def _report_moving_planes(validated_robot: ValidatedRobot, fields: UrdfFields) -> None:
    """Report a planar joint whose plane another joint rotates: its start orientation would have to rotate with it."""
    above = validated_robot.tree.parent_joints
    for joint in above.values():
        ancestor = above.get(joint.parent) if joint.kind == "planar" else None
        while ancestor is not None and ancestor.kind in ("fixed", "prismatic"):
            ancestor = above.get(ancestor.parent)
        if ancestor is not None and ancestor.kind in ("revolute", "continuous"):
            message = f"a planar joint after {ancestor.name}, which rotates its plane, is not supported yet"
            hint = "use two prismatic joints and a revolute joint instead"
            fields.report("import-joint", joint.element, joint.path, message, hint)


def _unsupported_damping(validated_robot: ValidatedRobot, fields: UrdfFields) -> Iterator[Problem]:
    """Report damping and friction in joints that do not have exactly one coordinate."""
    for joint in validated_robot.tree.parent_joints.values():
        if joint.is_movable and not joint.has_one_coordinate and (joint.damping or joint.friction):
            message = f"damping and friction of a joint of type {joint.kind} are left out"
            hint = "use a force of type damper in a plane, and a time-dependent couple on a floating link"
            yield fields.make_problem(LEFT_OUT_CODE, joint.element, joint.path, message, hint)


def _header_lines(validated_robot: ValidatedRobot, fields: UrdfFields) -> Iterator[str]:
    """Yield the remarks that concern the whole robot."""
    root = validated_robot.tree.root.name
    if not validated_robot.is_grounded:
        yield f'The root, link "{root}", is free; without --base free it is fixed to the ground.'
    elif validated_robot.placed_links[root].carrier == GROUND:
        yield f'The root, link "{root}", is the ground.'
    else:
        yield f'The root, link "{root}", is welded to the ground; the load of the weld is reported as a joint load.'
    floating = [
        link.name for link in validated_robot.tree.links if _joint_kind(validated_robot, link.name) == "floating"
    ]
    if floating:
        yield f"Free links (joints of type floating): {list_words(floating)}."
    if fields.nearly_right_angled:
        what = "read as right angles (--repair right-angles)" if fields.repair_right_angles else "kept unchanged"
        yield f"Nearly right angles, such as 1.5708, are {what}: {list_words(fields.nearly_right_angled)}."
    if fields.turned_axes:
        yield f"Axes turned by their own rpy, which some programs pass over: {list_words(fields.turned_axes)}."
    for link in fields.links_without_inertia:
        yield f'Repaired (massless): the link "{link}" has mass 0; its inertia is left out.'
    if validated_robot.robot.ignored_tags:
        counts = ", ".join(f"{count} {tag}" for tag, count in validated_robot.robot.ignored_tags.items())
        yield f"Left out, as not relevant to the mechanics: {counts}."


def _joint_kind(validated_robot: ValidatedRobot, link: str) -> str:
    joint = validated_robot.tree.parent_joints.get(link)
    return "" if joint is None else joint.kind


# Reader

MASSLESS_HINT = (
    "give it an <inertial>; --density fills boxes, cylinders, spheres, meshes; --repair massless gives it 1 mg"
)


def read_model(_content: bytes, file: str, root: XmlElement, options: ImportOptions, sha256: str) -> DescribedMachine:
    """Read the machine that a URDF describes. Raises SpecError with all problems, in the order of their lines."""
    fields = UrdfFields(file, "right-angles" in options.repair)
    return translate_robot(read_robot(root, fields), options, fields, sha256)


def translate_robot(
    robot: Robot, options: ImportOptions, fields: UrdfFields, sha256: str, form: str = "URDF"
) -> DescribedMachine:
    """Translate a robot that was read to a machine. Raises SpecError with all problems, in the order of their lines."""
    tree = build_tree(robot, fields)
    size = find_size(robot)
    masses = {name: _find_link_mass(link, options, size, fields) for name, link in robot.links.items()}
    link_masses = {name: mass for name, mass in masses.items() if mass is not None}
    validated_robot = None if tree is None or fields.problems else _validate(robot, tree, link_masses, options, fields)
    if validated_robot is None or fields.problems:
        raise SpecError(*sorted(fields.problems, key=lambda problem: problem.location[1:3] if problem.location else ()))
    return build_machine(validated_robot, options, fields, sha256)._replace(form=form)


def _find_link_mass(link: UrdfLink, options: ImportOptions, size: float, fields: UrdfFields) -> LinkMass | None:
    """Return the mass properties of a link as the file gives them, or of its shapes as asked."""
    if link.inertial is not None and takes_inertia_of_shapes(link, options):
        from heuncli.scene.importers.urdf.shape_inertia import compute_shape_mass  # imports NumPy

        return compute_shape_mass(link, link.inertial, fields)
    return validate_mass(link, options.repair, size, fields)


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
    frames = find_massless_frames(tree, uncarried_heads, {*masses, *shapes, *meshes})
    masses = masses | dict.fromkeys(frames, MASSLESS)
    uncarried_heads = [name for name in uncarried_heads if name not in frames]
    if "massless" in options.repair:
        masses = masses | {name: make_repaired_mass(robot.links[name]) for name in uncarried_heads}
    else:
        _report_uncarried(uncarried_heads, robot, tree, fields)
    if uncarried:
        link_places, _ = place_links(tree, attitudes, {*masses, *shapes, *meshes}, is_grounded)
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
        message = f"neither it nor anything on or beyond it has mass, and it {reason}"
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
        from heuncli.scene.importers.urdf.shape_inertia import (  # imports NumPy, which few models need
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
