"""Sort the elements of a URDF that URDF itself does not define: what other programs add, and what changes mechanics.

An element with a prefix (<drake:...>) belongs to another program by its form. It is left out and counted, unless its
name says that it moves, loads or connects something. An element without a prefix is left out only if it is known.
"""

from __future__ import annotations

import re
from collections import Counter

from heuncli.base.spelling import suggest
from heuncli.scene.importers.description import LEFT_OUT_CODE
from heuncli.scene.importers.urdf.fields import SIMILARITY_THRESHOLD, UrdfFields
from heuncli.scene.importers.xml_elements import XmlElement

# elements of a robot, link or joint without mechanical meaning, as ROS and others document them
NON_MECHANICAL_TAGS = frozenset({
    "material", "gazebo", "transmission", "sensor", "plugin", "ros2_control", "safety_controller",
    "mujoco", "frame", "actuator", "actuators", "motor", "controller", "hardware", "hardwareInterface",
    # collisions
    "collision_filter_group", "collision_checking", "self_collide", "self_collision", "self_collision_checking",
    "disable_collisions", "enable_collisions", "disable_default_collisions", "verify_collisions", "collision_pair",
    # semantics (SRDF), remarks, looks
    "group", "group_state", "end_effector", "passive_joint", "author", "comment", "description", "license", "date",
    "version", "metadata", "properties", "verbose", "camera", "light", "color", "texture", "rviz",
})  # fmt: skip
DEFAULT_TEXTS = {"gravity": ("1", "true"), "kinematic": ("0", "false")}  # Gazebo's defaults, which change nothing
COMMON_TAGS = ("gazebo", "material", "mujoco", "transmission", "sensor", "plugin", "ros2_control", "safety_controller")
OBSERVES = re.compile(r"sensor|controller|collision|contact|visual|state|publisher|limit|filter", re.IGNORECASE)
CLOSES = re.compile(r"loop|constraint|closure|weld", re.IGNORECASE)
CONNECTS = re.compile(r"joint|mimic|coupl|gear|screw|link(?![a-z])", re.IGNORECASE)
LOADS = re.compile(
    r"(?<![a-z])(force|cable|rope|wing)|torque|spring|damp|bushing|stiffness|friction|tendon|drag|propell|thrust|buoyan",
    re.IGNORECASE,
)
CARRIES = re.compile(r"mass(?![a-z])|inerti|gravity|axis|origin(?![a-z])|(?<![a-z])pose|dynamics", re.IGNORECASE)
WORD_STARTS = re.compile(r"(?<=[a-z])(?=[A-Z])")  # in linearForce
MECHANICAL_HINTS = {
    CLOSES: "URDF has no loops: delete it, import, and close the loop in the spec by a joint (joints:)",
    LOADS: "delete it, import, and add the load to the spec: forces: {NAME: {type: spring | damper | bushing, ...}}",
    CONNECTS: "write it as a <joint> of URDF (a ball joint as three revolute ones), or delete it and add the joint or "
    "coupling to the spec",
    CARRIES: "write what it says in the elements of URDF, or delete it and correct the spec",
}
UNKNOWN_HINT = "delete it if it says nothing of the mechanics"


def find_mechanical_hint(tag: str) -> str | None:
    """Return what to do about an element that changes the mechanics; None if its name says nothing of them."""
    name = WORD_STARTS.sub("_", tag.rpartition(":")[2])
    if OBSERVES.search(name):
        return None
    return next((hint for pattern, hint in MECHANICAL_HINTS.items() if pattern.search(name)), None)


def leave_out_part(
    part: XmlElement, path: str, known_tags: tuple[str, ...], fields: UrdfFields, ignored_tags: Counter[str], place: str
) -> bool:
    """Count an element that URDF does not define, or report it. Returns whether it is left out.

    known_tags: the elements that may stand there, for the message
    place: the words that follow its name in the list of what is left out, such as " in joints"
    """
    is_foreign = ":" in part.tag
    says_nothing = part.tag in NON_MECHANICAL_TAGS or part.text.strip().lower() in DEFAULT_TEXTS.get(part.tag, ())
    hint = None if says_nothing else find_mechanical_hint(part.tag)
    if says_nothing or (is_foreign and hint is None):
        ignored_tags[part.tag + place] += 1
        _report_gravity(part, path, fields)
        return True
    if hint is not None and (is_foreign or not _resembles(part.tag, known_tags)):
        fields.report("import-part", part, path, f"<{part.tag}> changes the mechanics, and heun does not read it", hint)
        return False
    owner = path.partition(" ")[0]
    message = f"<{owner}> has an unknown part <{part.tag}>"
    if owner == "robot":
        message = f"<{part.tag}> is not a known part of a robot"
    hint = suggest(part.tag, (*known_tags, *COMMON_TAGS), "parts")
    fields.report("import-part", part, path, message, hint if hint.endswith("?") else f"{UNKNOWN_HINT}; {hint}")
    return False


def _resembles(tag: str, known_tags: tuple[str, ...]) -> bool:
    """Return whether a tag may be a known one misspelt: jiont."""
    from difflib import get_close_matches  # few files need it

    return bool(get_close_matches(tag, known_tags, 1, SIMILARITY_THRESHOLD))


def _report_gravity(part: XmlElement, path: str, fields: UrdfFields) -> None:
    """Warn of the one quantity of <mujoco> that a spec has elsewhere."""
    for option in part.find_all("option") if part.tag == "mujoco" else ():
        if "gravity" in option.attributes:
            message = f'gravity="{option.attributes["gravity"]}" of <mujoco> is left out'
            fields.left_out.append(fields.make_problem(LEFT_OUT_CODE, option, path, message, "set gravity in the spec"))
