"""Rules about forces and impulses: on joints and bodies that can take them, of the right dimension, in one form."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import units as u
from heuncli.base.joint_kinds import (
    FREE,
    POINT,
    TYPES,
    JointKind,
    format_kind_names,
    kinds_accepting_load,
    propose_pins,
)
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.scene.expressions.discontinuities import find_first_negative
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format.foreign_words import MISSING_KEY_HINTS
from heuncli.scene.file_format.rules.bodies import FULL_FRICTION_HINT
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule
from heuncli.scene.file_format.semantics import find_analysis_type, run_duration

TORQUE_WORDS = {"turning": "about a", "sliding": "along a"}
FRICTION_KEYS = {"turning": "torque", "sliding": "force"}  # the key of each motion
DAMPER_LAW_KEYS = {"turning": "torque", "sliding": "force"}  # the key of a law of a damper


def iter_joint_loads(draft: DraftDocument) -> Iterator[tuple[str, fl.JointLoadEntry, JointKind]]:
    """Yield the loads in joints that exist, with the kind of the joint; an unknown kind takes no load."""
    for name, load in draft.document.forces.items():
        if isinstance(load, fl.JointLoadEntry) and load.joint in draft.names.joints:
            joint_type = draft.names.joints[load.joint]
            yield name, load, TYPES.get(joint_type, JointKind(joint_type, POINT, FREE))


@rule("load-joint")
def check_load_joint(draft: DraftDocument) -> Iterator[Violation]:
    """A joint has the motion that the load drives or resists."""
    for name, load, kind in iter_joint_loads(draft):
        path = ("forces", name)
        if isinstance(load, fl.TorqueEntry):
            if not kind.accepts_load("torque"):
                where = " or ".join(f"{TORQUE_WORDS[k.motions[0]]} {k.name}" for k in kinds_accepting_load("torque"))
                hint = propose_pins(kind, "between two points use an actuator, on a body a couple")
                yield Violation((*path, "joint"), f"type: torque acts {where}, not in a {kind.name}", hint)
        elif isinstance(load, fl.MotorEntry):
            if kind.coordinates != ("angle",):
                hint = propose_pins(kind, "in a slide use a force of type torque, with a value in guide.speed")
                yield Violation((*path, "joint"), f"a motor acts in a pin, not in a {kind.name}", hint)
        elif isinstance(load, fl.TurnSpringEntry):
            if load.torque is not None and kind.coordinates != ("angle",):
                message = f"a turn_spring with a law for its torque acts in a pin, not in a {kind.name}"
                yield Violation((*path, "joint"), message, "only a pin has one angle; otherwise give a stiffness")
            elif not kind.accepts_load("turn_spring"):
                allowed = format_kind_names(kinds_accepting_load("turn_spring"), "or")
                message = f"a turn_spring acts in a {allowed}, not in a {kind.name}"
                yield Violation((*path, "joint"), message, propose_pins(kind, "between two points use a spring"))
        elif isinstance(load, fl.DamperEntry):
            two_motion_kinds = [k for k in kinds_accepting_load("damper") if len(k.motions) == 2]
            if not kind.accepts_load("damper"):
                hint = propose_pins(kind, "between two points use a spring with damping")
                yield Violation((*path, "joint"), f"a damper has no effect in a {kind.name}", hint)
            if load.torque is not None or load.force is not None:
                yield from check_damper_law(name, load, kind)
            elif load.coefficient is None and load.sliding is None:
                allowed = "coefficient (of rotation), sliding, or both" if kind in two_motion_kinds else "coefficient"
                yield Violation(path, "the damper has neither a coefficient nor a law", f"give {allowed}", key=True)
            if load.sliding is not None and kind not in two_motion_kinds:
                message = f"sliding is for a {format_kind_names(two_motion_kinds, 'or')}, not for a {kind.name}"
                yield Violation((*path, "sliding"), message, "use coefficient", key=True)
        elif isinstance(load, fl.FrictionEntry):
            yield from check_friction_form(name, load, kind)
        elif not kind.accepts_load(load.type):
            allowed = format_kind_names(kinds_accepting_load(load.type), "or")
            yield Violation((*path, "joint"), f"a {load.type} has no effect in a {kind.name}", f"use a {allowed}")


def check_friction_form(name: str, load: fl.FrictionEntry, kind: JointKind) -> Iterator[Violation]:
    """Friction has a size that fits its joint, or a coefficient."""
    path = ("forces", name)
    given_keys = [key for key in (*FRICTION_KEYS.values(), "coefficient") if getattr(load, key) is not None]
    allowed_keys = [FRICTION_KEYS[motion] for motion in kind.motions]
    if not kind.accepts_load("friction"):
        allowed = format_kind_names(kinds_accepting_load("friction"), "or")
        message = f"friction acts in a {allowed}, not in a {kind.name}"
        yield Violation((*path, "joint"), message, "between two points use a spring with damping")
    elif len(given_keys) != 1:
        description = (
            f"both {' and '.join(given_keys[-2:])}" if given_keys else "neither torque nor force nor coefficient"
        )
        hint = f"a {kind.name} takes {' or '.join([*allowed_keys, 'coefficient'])}"
        yield Violation(path, f"the friction has {description}", hint, key=True)
    elif given_keys[0] == "coefficient":
        yield from check_friction_coefficient(name, load, kind)
    elif load.radius is not None or load.length is not None:
        key = "radius" if load.radius is not None else "length"
        message = f"{key} is for friction with a coefficient, not with a {given_keys[0]}"
        yield Violation((*path, key), message, "leave it out, or write coefficient", key=True)
    elif given_keys[0] not in allowed_keys:
        message = f"friction of a {kind.name} is a {allowed_keys[0]}"
        yield Violation((*path, given_keys[0]), message, f"write {allowed_keys[0]}", key=True)
    if load.speed is None:
        yield from check_sticking_friction(path, load, kind)
    elif load.static is not None:
        message = "static is for friction that sticks, and with a speed it is smoothed and does not"
        yield Violation((*path, "static"), message, "leave out speed, or static", key=True)


def check_sticking_friction(path: tuple[str, ...], load: fl.FrictionEntry, kind: JointKind) -> Iterator[Violation]:
    """Friction that sticks holds one coordinate, by a number that is not below the kinetic one."""
    if kind.accepts_load("friction") and (kind.follows_path or not kind.has_one_axis):
        message = f"friction in a {kind.name} needs a speed: heun lets it stick in pins, slides and cylinders"
        yield Violation(path, message, f"{FULL_FRICTION_HINT}; then it is smoothed", key=True)
    static = None if load.static is None else load.static.constant
    if load.static is not None and static is None:
        message = f"static must be a number, but '{load.static.source.strip()}' varies"
        yield Violation((*path, "static"), message, "leave it out: it then is the kinetic friction at each instant")
    kinetic = load.coefficient
    for value in (load.torque, load.force):
        if value is not None and value.constant is None and load.static is not None:
            message = "static is given for a friction that varies"
            yield Violation((*path, "static"), message, "leave it out: it then is the kinetic friction at each instant")
        elif value is not None:
            kinetic = value.constant
    if static is not None and kinetic is not None and static < kinetic:
        message = f"static, {static:g}, is below the kinetic friction, {kinetic:g}: it could not slip"
        yield Violation((*path, "static"), message, "what sticks holds at least as much: give the larger number here")
    if static is not None and load.coefficient is None and kinetic == 0.0:
        message = "static friction needs a kinetic one above 0"
        yield Violation((*path, "static"), message, "give a small torque or force, such as a thousandth of it")


def check_damper_law(name: str, load: fl.DamperEntry, kind: JointKind) -> Iterator[Violation]:
    """A damper by a law of the rate has a torque in a pin, a force in a slide."""
    path = ("forces", name)
    given_key = "torque" if load.torque is not None else "force"
    allowed_key = DAMPER_LAW_KEYS[kind.motions[0]] if kind.has_one_axis and len(kind.motions) == 1 else None
    if allowed_key is None:
        message = f"a damper with a law in its rate acts in a pin or slide, not in a {kind.name}"
        yield Violation((*path, "joint"), message, "give a coefficient")
    elif given_key != allowed_key:
        yield Violation(
            (*path, given_key), f"a damper of a {kind.name} has a {allowed_key}", f"write {allowed_key}", key=True
        )


@rule("load-form")
def check_load_form(draft: DraftDocument) -> Iterator[Violation]:
    """A spring or damper is given by numbers or by a law; a bushing resists some motion."""
    for name, load in draft.document.forces.items():
        path = ("forces", name)
        laws, numbers = LOAD_KINDS[load.type].law_keys, LOAD_KINDS[load.type].number_keys
        law_keys = [key for key in laws if getattr(load, key) is not None]
        extra_keys = [
            key for key in (*laws[1:], *numbers) if getattr(load, key) is not None and key not in law_keys[:1]
        ]
        if law_keys and extra_keys:
            message = f"the {load.type} has both {law_keys[0]} and {extra_keys[0]}"
            yield Violation(
                (*path, extra_keys[0]),
                message,
                f"put the whole law in {law_keys[0]}, or leave {law_keys[0]} out",
                key=True,
            )
        if isinstance(load, fl.BushingEntry) and all(
            getattr(load, key) is None
            for key in ("stiffness", "turning", "damping", "turning_damping", "preload", "turning_preload")
        ):
            yield Violation(
                path, "the bushing has no stiffness, damping or preload", "give stiffness, turning or both", key=True
            )


@rule("missing-key")
def check_missing_numbers(draft: DraftDocument) -> Iterator[Violation]:
    """A spring without a law has its numbers."""
    for name, load in draft.document.forces.items():
        laws = LOAD_KINDS[load.type].law_keys
        for key in LOAD_KINDS[load.type].required_keys:
            if getattr(load, key) is None and not any(getattr(load, law) is not None for law in laws):
                hint = f"{MISSING_KEY_HINTS[key]}; or give a law as {laws[0]}: ..."
                yield Violation(("forces", name), f"'{key}' is missing", hint, key=True)


@rule("brake")
def check_brake(draft: DraftDocument) -> Iterator[Violation]:
    """Friction of given size depends on time alone and is never negative."""
    duration = run_duration(draft.document.analysis)
    for name, load in draft.document.forces.items():
        for key in FRICTION_KEYS.values() if isinstance(load, fl.FrictionEntry) else ():
            value = getattr(load, key)
            if value is None or value.constant is not None:
                continue
            path = ("forces", name, key)
            if value.uses:
                message = f"the magnitude of friction may depend on time alone, not on {'.'.join(value.uses[0])}"
                yield Violation(
                    path, message, "for one that depends on a coordinate use a torque: -size*tanh(shaft.rate/0.01)"
                )
            elif (t := find_first_negative(value, duration)) is not None:
                message = f"{key} must not be negative, but is {value.value(t):g} at t = {t:.4g} s"
                yield Violation(path, message, "it resists motion in both directions: give its magnitude")


def check_friction_coefficient(name: str, load: fl.FrictionEntry, kind: JointKind) -> Iterator[Violation]:
    """Friction by a coefficient acts in a pin, which needs a radius, or in a slide, which may have a length."""
    path = ("forces", name)
    if len(kind.motions) != 1:
        message = f"friction with a coefficient acts in a pin or slide, not in a {kind.name}"
        hint = "use a pin and a slide, or friction with a given torque and force"
        yield Violation((*path, "joint"), message, hint)
    elif kind.follows_path:
        message = f"friction with a coefficient acts in a pin or slide, not in a {kind.name}"
        yield Violation((*path, "joint"), message, "along a path give its magnitude as force")
    elif kind.motions == ("turning",):
        if load.radius is None:
            hint = "add the radius of the journal, for example radius: 20 mm"
            yield Violation(path, f"friction with a coefficient about a {kind.name} needs its radius", hint, key=True)
        if load.length is not None:
            hint = "leave it out: a pin has a radius"
            yield Violation((*path, "length"), "length is for a slide: the distance between its ends", hint, key=True)
    elif load.radius is not None:
        hint = "leave it out; a slide that carries tilting moments may have a length"
        yield Violation((*path, "radius"), "radius is for a pin", hint, key=True)


@rule("dimension")
def check_load_dimension(draft: DraftDocument) -> Iterator[Violation]:
    """Where the joint decides between turning and sliding, the unit fits."""
    for name, load, kind in iter_joint_loads(draft):
        sliding = kind.motions == ("sliding",)
        if isinstance(load, fl.TorqueEntry):
            checks = [("value", load.value, u.FORCE if sliding else u.MOMENT)]
        elif isinstance(load, fl.DamperEntry):
            coefficients = [load.coefficient] if load.coefficient is not None else []
            checks = [("coefficient", value, u.DAMPING if sliding else u.TURNING_DAMPING) for value in coefficients]
        elif not isinstance(load, fl.FrictionEntry):
            checks = []
        else:
            is_sliding = load.force is not None or (load.coefficient is not None and sliding)
            of_static = u.FORCE if load.force is not None else u.MOMENT
            of_static = u.NUMBER if load.coefficient is not None else of_static
            given = ("speed", load.speed, u.VELOCITY if is_sliding else u.RATE), ("static", load.static, of_static)
            checks = [(key, value, dimension) for key, value, dimension in given if value is not None]
        for key, value, dimension in checks:
            if value.dimension is not None and value.dimension != dimension:
                message = f"'{value.source.strip()}' is {u.describe(value.dimension)}, expected {u.describe(dimension)}"
                hint = f"a number without a unit is taken to be in {u.si_unit(dimension)}"
                yield Violation(("forces", name, key), message, hint)


@rule("couple-point")
def check_couple_point(draft: DraftDocument) -> Iterator[Violation]:
    """A couple on a body with sections has a point of application, which decides on which side of a cut it acts."""
    cut_bodies = {section.body for section in draft.document.sections.values()}
    on_bodies = [
        (("forces", name, "on"), load.on.body)
        for name, load in draft.document.forces.items()
        if isinstance(load, fl.CoupleEntry) and load.on.at is None
    ]
    for name, blow in draft.document.impulses.items():
        if blow.couple is not None and blow.on is None and blow.body is not None:
            on_bodies.append((("impulses", name, "body"), blow.body))
        elif blow.couple is not None and blow.on is not None and blow.on.at is None:
            on_bodies.append((("impulses", name, "on"), blow.on.body))
    for path, body in on_bodies:
        if body in cut_bodies:
            message = f"the couple acts on {body}, which has sections, but no point is given"
            hint = f"write on: {body}.point to show on which side of the cut the couple acts"
            yield Violation(path, message, hint)


@rule("impulse-form")
def check_impulse_form(draft: DraftDocument) -> Iterator[Violation]:
    """An impulse is a vector at a point, or a couple on a body or at a point of it."""
    for name, impulse in draft.document.impulses.items():
        given_keys = {key for key in ("on", "vector", "body", "couple") if getattr(impulse, key) is not None}
        if given_keys not in ({"on", "vector"}, {"on", "couple"}, {"body", "couple"}):
            message = "expected {on: body.point, vector}, {on: body.point, couple} or {body, couple}"
            yield Violation(("impulses", name), message, "write two simultaneous impulses as two entries", key=True)


@rule("zero-impulse", is_warning=True)
def check_zero_impulse(draft: DraftDocument) -> Iterator[Violation]:
    """An impulse of size zero changes nothing."""
    for name, impulse in draft.document.impulses.items():
        for key in ("vector", "couple"):
            if getattr(impulse, key) == (0.0, 0.0, 0.0):
                message = f"{key} is [0, 0, 0]: the impulse has no effect"
                yield Violation(("impulses", name, key), message, "leave it out")


@rule("impulse-time")
def check_impulse_time(draft: DraftDocument) -> Iterator[Violation]:
    """An impulse falls within the run."""
    analysis = draft.document.analysis
    duration = run_duration(analysis)
    for name, impulse in draft.document.impulses.items():
        path = ("impulses", name, "time")
        if impulse.when is not None:
            continue
        if impulse.time < 0.0:
            yield Violation(path, f"the impulse is before the start, at {impulse.time:g} s", "the run starts at 0")
        elif impulse.time > duration and "analysis" not in draft.unread:
            hint = (
                "give analysis a longer duration"
                if duration > 0.0
                else "without a duration only the jump at time 0 is computed"
            )
            yield Violation(
                path, f"the impulse at {impulse.time:g} s is after the end of the run at {duration:g} s", hint
            )


@rule("impulse-when")
def check_impulse_when(draft: DraftDocument) -> Iterator[Violation]:
    """An impulse acts at a time or when a condition becomes true, the latter only in a motion."""
    kind = find_analysis_type(draft.document)
    for name, impulse in draft.document.impulses.items():
        path = ("impulses", name)
        if impulse.when is None:
            if impulse.every and "when" not in draft.names.entries["impulses"][name]:
                hint = "add when: a condition such as shaft.angle < 0; for known instants write one entry each"
                yield Violation((*path, "every"), "'every' without 'when'", hint, key=True)
        elif "time" in impulse.model_fields_set:
            hint = "leave one of them out; to act only after a given time: when: t > 0.1 and shaft.angle < 0"
            yield Violation((*path, "when"), "'time' and 'when' are both given", hint, key=True)
        elif kind != "motion" and "analysis" not in draft.unread:
            message = f"when needs a motion, but type: {kind} is one instant"
            yield Violation((*path, "when"), message, "give analysis a duration, or the impulse a time", key=True)
