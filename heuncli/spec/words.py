"""What other programs call things, for hints."""

from __future__ import annotations

from heuncli.joint_kinds import SYNONYMS

FORCE_WORDS = {
    "moment": "couple", "motor": "torque", "thrust": "torque", "springdamper": "spring", "spring_damper": "spring",
    "dashpot": "damper", "load": "force", "cylinder": "actuator", "coulomb": "friction",
    "torsion_spring": "turn_spring", "torsional_spring": "turn_spring", "rotational_spring": "turn_spring",
    "rotary_spring": "turn_spring", "angular_spring": "turn_spring", "spiral_spring": "turn_spring",
    "line_load": "distributed", "udl": "distributed", "uniform": "distributed", "distributed_load": "distributed",
    "line_force": "distributed",
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
    "bumpers": "stops", "limits": "stops", "contacts": "stops", "buffers": "stops", "bumper": "stops",
    "limit": "stops", "contact": "stops", "stop": "stops", "endstops": "stops", "end_stops": "stops",
    "blows": "impulses", "blow": "impulses", "impulse": "impulses", "hits": "impulses", "shocks": "impulses",
    "e": "restitution", "cor": "restitution", "bounce": "restitution", "rebound": "restitution", "mu": "friction",
    "position": "travel", "displacement": "travel", "distance": "length", "moment": "couple", "torque": "couple",
    "when": "time", "instant": "time", "t": "time", "point": "on", "one_sided": "tension_only", "slack": "tension_only",
}  # fmt: skip
ELSEWHERE = {  # keys that stand in another place than the one where they were written
    "stops": "limits of coordinates are a block of their own: stops: {buffer: {joint: guide, travel: [0, 0.2]}}",
    "restitution": "it stands at a rod with tension_only, or at a stop",
    "tension_only": "it stands at a joint of type rod",
}
JOINT_WORDS = SYNONYMS | dict.fromkeys(("cable", "rope", "string", "tether"), "rod, with tension_only: true")
LATER = {  # of the format, but of a later version: (block or key, word)
    ("joints", "curve"), ("shapes", "mesh"), ("keys", "sweep"),
}  # fmt: skip
TYPES = {  # by the key above the entry: code, what it is called, foreign words
    "joints": ("unknown-joint-type", "a joint type", JOINT_WORDS),
    "forces": ("unknown-force-type", "a force type", FORCE_WORDS),
    "shapes": ("unknown-shape-type", "a shape", SHAPE_WORDS),
}
