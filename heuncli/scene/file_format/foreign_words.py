"""Words of other programs and other mistakes in keys and types, mapped to heun's words and hints.

Common words for types of joints and loads are accepted: `replace_type_aliases` puts heun's words in their place before
anything else reads the data. So results, messages and all later code know one word for each type.
"""

from __future__ import annotations

from typing import Any

from heuncli.base.joint_kinds import SYNONYMS
from heuncli.base.load_kinds import LOAD_SYNONYMS

# Foreign words

COUPLING_WORDS = {
    "gears": "gear", "spur": "gear", "bevel": "gear", "rack": "gear", "rackpinion": "gear", "rack_and_pinion": "gear",
    "chain": "belt", "pulley": "rope", "sheave": "rope", "hoist": "rope", "tackle": "rope", "spindle": "screw",
    "lead_screw": "screw", "leadscrew": "screw", "nut": "screw", "couple": "ratio", "mimic": "ratio", "linear": "ratio",
    "follower": "cam",
}  # fmt: skip
SHAPE_WORDS = {
    "bar": "rod", "line": "rod", "beam": "rod", "tube": "cylinder", "pipe": "cylinder", "disk": "cylinder",
    "disc": "cylinder", "cuboid": "box", "cube": "box", "brick": "box", "ball": "sphere", "frustum": "cone",
    "mass": "point", "particle": "point", "stl": "mesh", "obj": "mesh", "ply": "mesh", "cad": "mesh", "surface": "mesh",
    "polyhedron": "mesh", "trimesh": "mesh", "import": "mesh",
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
    "latch": "latches", "catches": "latches", "locks": "latches", "detents": "latches", "clamps": "latches",
    "limit": "stops", "contact": "stops", "stop": "stops", "endstops": "stops", "end_stops": "stops",
    "blows": "impulses", "blow": "impulses", "impulse": "impulses", "hits": "impulses", "shocks": "impulses",
    "e": "restitution", "cor": "restitution", "bounce": "restitution", "rebound": "restitution", "mu": "friction",
    "position": "travel", "displacement": "travel", "distance": "length", "moment": "couple", "torque": "couple",
    "body": "bodies", "parts": "bodies", "members": "bodies", "bars": "bodies", "kind": "type", "joint": "joints",
    "rho": "density", "wheels": "rolling", "tyres": "rolling", "tires": "rolling", "hub": "wheel",
    "when": "time", "instant": "time", "t": "time", "point": "on", "slack": "tension_only",
    "lifts": "one_sided", "unilateral": "one_sided",
}  # fmt: skip
AMBIGUOUS_WORDS = {  # words whose meaning depends on the place, the most likely key first
    "value": ("vector", "is", "value"), "vector": ("value",), "force": ("vector", "value"), "path": ("of",),
    "what": ("of",), "quantity": ("of",), "result": ("of",), "body": ("on",), "at": ("on",), "where": ("on",),
    "damping": ("coefficient",), "coefficient": ("damping",), "c": ("coefficient",), "d": ("coefficient", "damping"),
    "l0": ("length",), "natural_length": ("length",), "free": ("length",), "rpm": ("rate",),
    "n": ("rate", "count"), "number": ("count",), "samples": ("count",), "on": ("body",), "load": ("vector",),
    "q": ("vector",), "intensity": ("vector",),
    "omega": ("rate",), "velocity": ("rate", "speed"), "angular_velocity": ("rate",), "solver": ("method", "analysis"),
    "integrator": ("method",), "t_max": ("duration",), "tmax": ("duration",), "stop": ("duration",),
    "t_stop": ("duration",), "simulation": ("analysis",), "settings": ("analysis",), "run": ("analysis",),
    "options": ("analysis",), "g": ("gravity",), "world": ("ground",), "base": ("ground",), "frame": ("ground",),
    "springs": ("forces",), "dampers": ("forces",), "actuators": ("forces",), "materials": ("parameters",),
    "output": ("report",), "outputs": ("report",), "equals": ("is",), "expected": ("is",), "max": ("below",),
    "min": ("above",), "less": ("below",), "greater": ("above",), "j": ("inertia",), "i": ("inertia",),
    "m": ("mass",), "r": ("radius",), "start": ("from",), "sides": ("size",), "pos": ("position",),
    "pose": ("position",), "markers": ("points",), "frames": ("points",), "geometry": ("shapes",),
    "shape": ("shapes",), "a": ("from",), "b": ("to",), "body1": ("from",), "body2": ("to",), "body_a": ("from",),
    "body_b": ("to",), "kind": ("type",), "n_samples": ("samples",), "mode": ("type",),
}  # fmt: skip
VALUE_WORDS = {  # values of `type` under analysis, of `space` and the like
    **dict.fromkeys(("dynamic", "dynamics", "transient", "simulation", "kinematic", "kinematics"), ("motion",)),
    **dict.fromkeys(("static", "statics", "equilibrium", "steady"), ("rest", "state")),
    "2d": ("planar",), "plane": ("planar",), "3d": ("spatial",), "space": ("spatial",), "local": ("body",),
    "global": ("world",), "shock": ("impulse",),
    **dict.fromkeys(("stress", "stresses", "shear", "bending", "cuts", "internal"), ("sections",)),
    **dict.fromkeys(("reactions", "reaction", "constraints", "bearings"), ("joints",)),
    **dict.fromkeys(("positions", "velocities", "accelerations", "bodies", "coordinates"), ("motion",)),
    **dict.fromkeys(("supports", "ground", "base"), ("foundation",)), "loads": ("forces",), "blows": ("impulses",),
}  # fmt: skip
METHOD_WORDS = {  # names of integration methods, in lower case, without hyphens
    "forwardeuler": "Euler", "expliciteuler": "Euler", "improvedeuler": "Heun2", "heun": "Heun2", "midpoint": "Heun2",
    "rk2": "Heun2", "rk3": "Heun3", "rungekutta": "RK4", "rungekutta4": "RK4", "kutta": "RK4", "classical": "RK4",
    "rk45": "DOPRI5", "ode45": "DOPRI5", "dopri": "DOPRI5", "dp5": "DOPRI5", "rkf45": "DOPRI5", "tsit5": "DOPRI5",
    "dormandprince": "DOPRI5", "rk23": "DOPRI5", "ode23": "DOPRI5", "rk853": "DOP853", "dop8": "DOP853",
    "dopri8": "DOP853", "dp8": "DOP853", "ode78": "DOP853", "ode113": "DOP853", "abm": "DOP853", "adams": "DOP853",
    "vern9": "Verner98", "vern98": "Verner98", "verner": "Verner98", "ode89": "Verner98",
    "gauss": "Gauss4", "gausslegendre": "Gauss4", "implicitmidpoint": "Gauss4", "symplectic": "Gauss4",
    "verlet": "Gauss4", "leapfrog": "Gauss4", "newmark": "Gauss4", "gausslegendre4": "Gauss4",
    "gausslegendre6": "Gauss6", "radau": "Radau5", "radauiia": "Radau5", "radauiia5": "Radau5", "stiff": "Radau5",
    "implicit": "Radau5", "implicteuler": "Radau5", "ode15s": "Radau5", "ode23s": "Radau5", "ode23t": "Radau5",
    "dassl": "Radau5", "ida": "Radau5", "cvode": "Radau5", "gstiff": "Radau5", "hht": "Radau5", "rodas": "Radau5",
    "rosenbrock": "Radau5", "generalizedalpha": "Radau5", "bdf": "SciPy-BDF", "lsoda": "SciPy-LSODA",
    "odeint": "SciPy-LSODA", "vode": "SciPy-BDF", "default": "auto", "automatic": "auto", "adaptive": "auto",
}  # fmt: skip
FORM_HINTS = {  # what the values of some keys look like
    "rotor": "the rotating part of the motor: {mass: 0.2 kg, inertia: 1e-4 kg*m^2}",
    "gravity": "a vector: [0, 0, -9.81]", "orientation": "for example {axis: [0, 0, 1], angle: 60 deg}",
    "inertia": "the moments of inertia [A1, A2, A3], or a 3x3 tensor in rows",
    "report": "for example [joints, energy]", "expect": "for example [{of: joints.NAME.force.z, is: 9.81}]",
    "shapes": "write a list even for one shape: [{type: cylinder, ...}]", "times": "for example [0, 0.5, 1]",
    "points": "by name: {top: [0, 0, 0]}", "events": "by name: {falls: pivot.angle > 1}",
    "rectangle": "for example {width: 0.1, height: 0.2}", "circle": "for example {radius: 0.1}",
    "tube": "for example {radius: 0.1, inner_radius: 0.09}", "ground": "for example {points: {O: [0, 0, 0]}}",
    "analysis": "for example {duration: 2, samples: 201}", "initial": "for example {angle: 30 deg, rate: 0}",
    "stiffness": "one number, or {force: 2e8, moment: 1e5}; for a bushing [x, y, z], or {x: table, y: 2e5}",
    "near": "for example {position: [0, 0, 1]}",
    "foundation": "for example {about: [0, 0, 0]}", "properties": "auto, or for example {circle: {radius: 0.01}}",
    "piece": "for example {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0]}",
    "title": "write a text, in quotes if it contains :",
    "of": "the path of a result: joints.NAME.force.z", "until": "a condition such as guide.travel > 0.2",
}  # fmt: skip
JOINT_LIST_HINT = "a list of joints: [first, second]"  # hint for `of` of a coupling
COORDINATE_KEYS = frozenset({"from", "to", "center", "position", "at"})  # keys of coordinates, in body or world axes
KIND_HINTS = {  # hints by the kind of value that is expected
    "a mapping": "keys with their values: {key: value}", "a text": "write a name, or a text in quotes",
    "true or false": "true or false, without quotes", "a number": "for example 0.5, \"12 mm\" or \"2*L\"",
}  # fmt: skip
MISSING_KEY_HINTS = {  # explanation of required keys
    "length": "the free length, without force", "vector": "three components, for example [0, 0, -10]",
    "on": "the point at which it acts: body.point",
    "speed": "the rate at which friction is nearly full, for example 0.01",
    "axis": "a direction such as [0, 0, 1]", "joint": "the name of the joint in which it acts",
    "of": "the path of a result: joints.NAME.force.z", "body": "the name of the body",
    "from": "one end: body.point, ground.point", "to": "the other end: body.point, ground.point",
    "mass": "in kg, for example 1.5", "center": "its centre: [x, y, z]",
    "inertia": "about its centre of mass: [A1, A2, A3]",
    "radius": "in m, or with a unit: 10 mm", "to_radius": "the radius at its other end, 0 for a tip",
    "inner_radius": "in m, or with a unit: 9 mm", "size": "its three edges: [x, y, z]", "at": "the point: [x, y, z]",
    "curve": "its torque over its speed: a table, or an expression of rate",
    "radii": "of both pulleys: [50 mm, 100 mm]", "pretension": "the tension of each strand at rest, in N",
    "lift": "a table of the lift over the disc's angle, or segments", "contact": "roller, flat or point",
    "set": "for example {n: 1500 rpm}", "file": "the file with its triangles: rod.stl",
    "diameter": "in m, or with a unit",
    "factors": "one number for each joint in of: [1, 2]", "lead": "the travel per revolution, for example 5 mm",
    "through": "points and sheaves in order: [ground.A, cage.top]",
    "stiffness": "in N/m, for a turn_spring in N*m/rad",
    "value": "a number or an expression in time, for example 5*sin(t)",
    "to_axis": "the axis fixed in the to body, for example [0, 1, 0]", "normal": "a direction such as [0, 0, 1]",
    "angle": "the free angle, without torque", "width": "along e1, in m", "height": "along e2, in m",
}  # fmt: skip
THREAD_FRICTION_KEYS = (
    "efficiency",
    "coefficient",
    "mu",
    "radius",
    "flank_angle",
    "speed",
)  # keys of a screw's friction
MOTOR_HINTS = {  # terms of a motor's data sheet, and how the format expresses them
    "stall_torque": "it is called stall here", "no_load_speed": "it is called idle here",
    "idle_speed": "it is called idle here", "speed": "its no-load speed is called idle here",
    "torque": "its torque at standstill is called stall here",
    "gear": "it is called ratio here: motor revolutions per revolution of the joint",
    "max_torque": "it is called limit here", "torque_limit": "it is called limit here",
    "peak_torque": "it is called limit here", "duty": "it is called value here",
    "max_speed": "to end the run at a maximum speed: analysis: {until: shaft.rate > 300}",
    "speed_limit": "to end the run at a maximum speed: analysis: {until: shaft.rate > 300}",
    "inertia": "give it for the rotating part: rotor: {mass: 0.2 kg, inertia: 1e-4 kg*m^2}",
    "rotor_inertia": "give it for the rotating part: rotor: {mass: 0.2 kg, inertia: 1e-4 kg*m^2}",
    "armature": "give it for the rotating part: rotor: {mass: 0.2 kg, inertia: 1e-4 kg*m^2}",
    "damping": "add a separate load: forces: {drag: {type: damper, joint: NAME, coefficient: 0.01}}",
    "friction": "add a separate load: forces: {rubs: {type: friction, joint: NAME, torque: 0.3 N m}}",
    "voltage": "currents and voltages are not computed: give stall and idle at its voltage",
    "current": "currents and voltages are not computed: give as limit the torque at the maximum current",
}  # fmt: skip
BRAKE_HINTS = dict.fromkeys(
    ("ramp", "rise", "delay"), 'its size may vary in time: torque: "8*min(t/0.2, 1)"'
) | dict.fromkeys(("size", "value"), "give its magnitude as torque, in a slide as force")
LATCH_HINTS = dict.fromkeys(
    ("until", "opens", "off"), "it releases when release becomes true: release: t > 1.5"
) | dict.fromkeys(
    ("at", "time", "from", "position"), "give where it catches as angle or travel, and from when on as when: t > 0.1"
)
HINTS_BY_KEYS = (
    (("stall", "ratio"), MOTOR_HINTS),
    (("joint", "speed", "radius"), BRAKE_HINTS),
    (("release", "every"), LATCH_HINTS),
)
CV_HINT = "write a constant-velocity joint under joints: {NAME: {type: cv, from: ..., to: ..., axis: [1, 0, 0]}}"
MISPLACED_KEYS = {  # keys that belong somewhere else, or are expressed differently
    "stops": "limits of coordinates have their own block: stops: {buffer: {joint: guide, travel: [0, 0.2]}}",
    "restitution": "it belongs to a rod with tension_only, or to a stop",
    "tension_only": "it belongs to a joint of type rod",
    "diameter": "give the radius instead, half the diameter",
    "length": "give its two ends, from and to",
    "height": "give its two ends, from and to",
    "torque": "write a torque as a force of type torque; a drive prescribes the motion, and its torque is a result",
    "on": "a torque acts in a joint; on a body write a couple, type: couple",
    "dt": "the tolerance sets the steps; samples is the number of output times, times lists them",
    "units": "write units with the numbers: 12 mm; numbers without a unit are SI; for tables: --units",
    "mu": "coefficient refers to the joint's own force; for friction of a given size use torque or force",
    "drive": "a driven joint has an entry in a block of its own: drives: {motor: {joint: NAME, rate: 1500 rpm}}",
    "friction": "write it as a load: forces: {rubs: {type: friction, joint: NAME, torque: 0.3 N m}}, "
    "with force in place of torque in a slide",
    "damping": "write it as a load: forces: {drag: {type: damper, joint: NAME, coefficient: 0.01}}",
    "spring": "write it as a load: forces: {k: {type: turn_spring, joint: NAME, stiffness: 10}}, or of type spring",
    "motor": "for a driven pin or slide: drives: {motor: {joint: NAME, rate: 1500 rpm}}, or a force of type motor",
    "efficiency": "give gear losses as a separate load: forces: {rubs: {type: friction, joint: spin, "
    "torque: 0.3 N m}}; a thread has its own friction",
    "material": "give the density of the shape: 7850 kg/m^3",
    "color": "shapes have no colour",
    "colour": "shapes have no colour",
    "cv": CV_HINT,
    "constant_velocity": CV_HINT,
    "homokinetic": CV_HINT,
    "rzeppa": CV_HINT,
}
JOINT_WORDS = SYNONYMS | dict.fromkeys(("cable", "rope", "string", "tether"), "rod, with tension_only: true")
PLANNED_WORDS = {  # words reserved for a later version: (block or key, word)
    ("keys", "sweep"),
}  # fmt: skip
TYPES = {  # by block: error code, description, foreign words
    "joints": ("unknown-joint-type", "a joint type", JOINT_WORDS),
    "forces": ("unknown-force-type", "a force type", LOAD_SYNONYMS),
    "couplings": ("unknown-coupling-type", "a coupling type", COUPLING_WORDS),
    "shapes": ("unknown-shape-type", "a shape", SHAPE_WORDS),
}


# Type aliases

TYPE_ALIASES: dict[str, dict[str, str]] = {  # by block: the accepted word, heun's word
    "joints": {"hinge": "pin", "revolute": "pin", "prismatic": "slide", "spherical": "ball", "fixed": "weld"},
    "forces": {"torsion_spring": "turn_spring"},
}


def replace_type_aliases(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data with heun's words as types. What does not change is shared with the given data."""
    changed_blocks = {
        block: _replace_in_block(data[block], aliases)
        for block, aliases in TYPE_ALIASES.items()
        if any(_find_type(entry, aliases) for entry in _list_entries(data.get(block)))
    }
    return {**data, **changed_blocks} if changed_blocks else data


def list_aliases(block: str, type_name: str) -> list[str]:
    """List the words that are accepted for a type of a block."""
    return [alias for alias, name in TYPE_ALIASES.get(block, {}).items() if name == type_name]


def _list_entries(block: Any) -> list[Any]:
    return list(block.values()) if type(block) is dict else []


def _find_type(entry: Any, aliases: dict[str, str]) -> str | None:
    """Return heun's word for the type of an entry, if the entry has another one."""
    word = entry.get("type") if type(entry) is dict else None
    return aliases.get(word) if type(word) is str else None


def _replace_in_block(entries: dict[str, Any], aliases: dict[str, str]) -> dict[str, Any]:
    found = {name: _find_type(entry, aliases) for name, entry in entries.items()}
    return {name: {**entry, "type": found[name]} if found[name] else entry for name, entry in entries.items()}
