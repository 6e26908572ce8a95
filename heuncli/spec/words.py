"""What other programs call things, for hints."""

from __future__ import annotations

from heuncli.joint_kinds import SYNONYMS

FORCE_WORDS = {
    "moment": "couple", "motor": "torque", "thrust": "torque", "springdamper": "spring", "spring_damper": "spring",
    "dashpot": "damper", "load": "force", "cylinder": "actuator", "coulomb": "friction",
}  # fmt: skip
SHAPE_WORDS = {
    "bar": "rod", "line": "rod", "beam": "rod", "tube": "cylinder", "pipe": "cylinder", "disk": "cylinder",
    "disc": "cylinder", "cuboid": "box", "cube": "box", "brick": "box", "ball": "sphere", "frustum": "cone",
    "mass": "point", "particle": "point",
}  # fmt: skip
KEY_WORDS = {
    "com": "center", "cog": "center", "centre": "center", "cm": "center", "moments": "inertia", "tensor": "inertia",
    "rotation": "orientation", "attitude": "orientation", "omega": "angular_velocity", "spin": "angular_velocity",
    "end": "duration", "time": "duration", "tend": "duration", "t_end": "duration", "steps": "samples",
    "tol": "tolerance", "rtol": "tolerance", "parent": "from", "child": "to", "connections": "joints",
    "constraints": "joints", "loads": "forces", "links": "bodies", "cuts": "sections", "motors": "drives",
    "variables": "parameters", "constants": "parameters", "version": "heun", "name": "title", "k": "stiffness",
    "c": "damping", "free_length": "length", "rest_length": "length", "direction": "axis", "points_on": "points",
}  # fmt: skip
LATER = {  # of the format, but of a later version: (block or key, word)
    ("joints", "curve"), ("shapes", "mesh"), ("keys", "restitution"), ("keys", "sweep"),
}  # fmt: skip
TYPES = {  # by the key above the entry: code, what it is called, foreign words
    "joints": ("unknown-joint-type", "a joint type", SYNONYMS),
    "forces": ("unknown-force-type", "a force type", FORCE_WORDS),
    "shapes": ("unknown-shape-type", "a shape", SHAPE_WORDS),
}
