"""Words for the quantities of the results: what a client reads in place of a path.

`joints.main.radial` is "main, radial force"; with a label "Main bearing" it is "Main bearing, radial force". Axes,
legends, headings and reports take their words here. A path is as `--measure` takes it, without a reducer.

A title and labels from the command line or from Python replace those of the spec.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache

from heuncli.base.errors import Finding, Problem, UsageError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.results.path_words import NAMES, POSITION_WORD, TREE, Node, is_cut_word, split_path
from heuncli.results.results_schema import CUT, IMPULSES, ROWS, SHARES, Quantity
from heuncli.scene.file_format.labels import GROUND, check_plain_text
from heuncli.scene.file_format.models import Spec, format_case_title
from heuncli.study.quantities.labels import Labels

# Quantity, with its kind before it where the same name means another thing there -> its words. A second text is for
# the components of a vector, {} in it is their letter; without one the letter follows the words.
WORDS: dict[str, str | tuple[str, str]] = {
    "force": ("force", "F{}"), "moment": ("moment", "M{}"),
    "direct_force": ("direct part of the force", "direct part of F{}"),
    "direct_moment": ("direct part of the moment", "direct part of M{}"), "torque": "torque", "power": "power",
    "axial": "axial force", "radial": "radial force", "tilting": "tilting moment", "tension": "tension",
    "bearings.axial": "axial force of bearing", "bearings.radial": "radial force of bearing",
    "radial_force": ("radial load of bearing", "radial load {} of bearing"),
    "bearings.point": "point of bearing",
    "pressure": "mean pressure", "drive": "drive", "value": "load", "open": "indeterminate components",
    "chosen": "components by a chosen distribution", "point": "point", "direction": "direction", "time": "time",
    "position": "position", "velocity": ("velocity", "v {}"), "acceleration": ("acceleration", "a {}"),
    "bodies.position": "position of the origin",
    "bodies.velocity": ("velocity of the origin", "velocity of the origin, v {}"), "rotation": "orientation",
    "quaternion": "orientation quaternion", "rodrigues": "Rodrigues vector", "center": "centre of mass",
    "center_velocity": ("velocity", "v {}"), "center_acceleration": ("acceleration", "a {}"),
    "angular_velocity": ("angular velocity", "ω {}"), "angular_acceleration": ("angular acceleration", "α {}"),
    "momentum": ("momentum", "p {}"), "moment_of_momentum": ("moment of momentum", "L {}"),
    "center_velocity_jump": ("jump of velocity", "Δv {}"),
    "angular_velocity_jump": ("jump of angular velocity", "Δω {}"), "angle": "angle", "rate": "angular velocity",
    "travel": "travel", "speed": "speed", "coordinates.acceleration": "acceleration",
    "coordinates.angular_acceleration": "angular acceleration", "about": "reference point of the moment",
    "axis.point": "point of the central axis", "axis.direction": "direction of the central axis",
    "axis.pitch": "pitch of the central axis",
    "mass_effect.force": ("force of the mass effect", "F{} of the mass effect"),
    "mass_effect.moment_orbital": ("orbital moment of the mass effect", "M{} orbital of the mass effect"),
    "mass_effect.moment_spin": ("spin moment of the mass effect", "M{} spin of the mass effect"),
    "contact_point": "contact point", "contact": "contact force", "pressure_angle": "pressure angle",
    "normal": "normal force", "efficiency": "efficiency", "last_tension": "last tension",
    "tight": "tension of the tight strand", "slack": "tension of the slack strand", "friction": "friction force",
    "along": "friction force along the track", "aside": "friction force across the track",
    "reserve": "reserve against slip",
    "grip": "grip reserve", "N": "axial force N", "Q1": "shear force Q1", "Q2": "shear force Q2",
    "T": "torsion", "M1": "bending moment M1", "M2": "bending moment M2", "Q": "shear force", "M": "bending moment",
    "points.normal": "normal stress", "points.shear": "shear stress",
    "sections.normal": "normal n", "first_axis": "first axis e1", "line.point": "point of the reduction line",
    "line.direction": "direction of the reduction line", "line.kind": "kind of the reduction line",
    "line.pressure_centre": "centre of pressure", "normal_max": "highest normal stress",
    "normal_min": "lowest normal stress", "shear_torsion": "shear stress of torsion",
    "shear_mean": "mean shear stress", "shear_max": "highest shear stress", "mises": "von Mises stress",
    "deflection.w1": "deflection along e1", "deflection.w2": "deflection along e2",
    "deflection.slope1": "slope along e1", "deflection.slope2": "slope along e2",
    "buckling": "safety against buckling",
    "utilisation": "utilisation", "sections.energy": "kinetic energy beyond the cut", "s": "distance along the cuts",
    "side": "side of the load", "length": "length", "shift": "displacement", "turn": "rotation angle",
    "turning": "rotation angle", "forces.rate": "speed", "kinetic": "kinetic energy", "potential": "potential energy",
    "work": "work", "sum": "energy minus work", "momentum.total": "total momentum",
    "system_vector.total": "system vector B",
    "moment_orbital": ("orbital moment of momentum", "orbital moment of momentum {}"),
    "moment_spin": ("spin moment of momentum", "spin moment of momentum {}"),
    "system_vector.bodies": "part of the system vector",
    "system_vector.energy_part": "energy part of the system vector",
    "system_vector.deviation_part": "deviation part of the system vector", "names": "causes",
    "energy_before": "kinetic energy before", "energy_after": "kinetic energy after",
    "energy_jump": "change of kinetic energy", "condition": "condition", "begins": "state at the start",
    "error": "error of the time", "to": "state", "terms": "terms of the determinate sum",
    "certain_sums.value": "determinate sum", "certain_sums.unit": "unit of the sum",
    "energy_drift": "relative energy error",
    "constraint_gap": "gap of the constraints", "balance_residual": "force balance error", "horizon": "horizon",
    "unknown": "uncertain instants", "estimate.motion": "error of the motion",
    "estimate.reactions": "error of the reactions", "estimate.drives": "error of the drives",
    "estimate.foundation": "error of the foundation loads", "estimate.sections": "error of the section loads",
    "estimate.energy": "error of the energy", "model": "model", "status": "status", "title": "title",
    "labels": "labels",
}  # fmt: skip
# Of two words the first holds where the joint or force slides, the second where it turns.
SLIDING_OR_TURNING = {
    "drive": ("drive force", "drive torque"), "forces.value": ("force", "torque"),
    "forces.rate": ("speed", "angular velocity"), "coordinates.acceleration": ("acceleration", "angular acceleration"),
}  # fmt: skip
REDUCERS = {
    "max abs": "greatest magnitude", "max": "maximum", "min": "minimum", "abs": "greatest magnitude",
    "first": "at the start", "final": "at the end",
}  # fmt: skip
# Word of a path -> the blocks whose labels its names have; other names have a label of their own block
LABELLED_BLOCKS = {
    "coordinates": ("joints",), "supports": ("joints",), "elements": ("forces", "couplings", "drives", "stops"),
    "causes": ("forces", "couplings", "drives", "stops", "impulses", "joints"), "rolling": ("couplings",),
    "latches": ("stops",), "system_vector": ("bodies",),
}  # fmt: skip
# One thing of a block of the spec -> the block, as sentences name it: "the body crank", "joints.main"
THINGS = {
    "body": "bodies", "joint": "joints", "rod": "joints", "drive": "drives", "force": "forces", "section": "sections",
    "sensor": "sensors",
    "stop": "stops", "latch": "stops", "coupling": "couplings", "rope": "couplings", "cam": "couplings",
    "impulse": "impulses", "case": "cases",
}  # fmt: skip
THING_IN_SENTENCE = re.compile(rf"\b({'|'.join(THINGS)}) (\w+)\b")
PATH_IN_SENTENCE = re.compile(rf"\b({'|'.join(dict.fromkeys(THINGS.values()))})\.(\w+(?:\.\w+)*)")
MAX_NAME_WORDS = 3  # words of a name with dots at most, such as drives.motor, crank.pin
SIDE_PHRASES = {"before": ", before the load", "beyond": ", beyond the load"}
UNITLESS = frozenset({"", "1"})


class PathParts(NamedTuple):
    """The parts of a path: its words in the schema, the names of the scene, the quantity, and components and cuts.

    names: placeholder and name, in their order
    """

    words: tuple[str, ...]
    names: tuple[tuple[str, str], ...]
    row: Quantity
    rest: tuple[str, ...]

    def find_name(self, placeholder: str) -> str:
        """Return the name in the place of a word of the schema; empty if there is none."""
        return next((name for word, name in self.names if word == placeholder), "")


def describe_path(path: str, labels: Labels) -> str:
    """Describe a path of the results in words: the object's label or name, a comma, and the quantity."""
    if path in labels.captions:
        return labels.captions[path]
    parts = parse_path(path)
    if parts is None:
        return _describe_entry(path, labels)
    number, bearing = parts.find_name("NUMBER"), parts.find_name("BEARING")
    if parts.words[0] == IMPULSES:
        parts = parts._replace(words=parts.words[1:])
    subject = _describe_subject(parts, labels)
    text = _describe_quantity(parts, labels) + f" {bearing}" * bool(bearing)
    text += f" at impulse {number}" if number and parts.words[0] != "certain_sums" else f" {number}" * bool(number)
    return f"{subject}, {text}" if subject else text


def describe_axis(path: str, labels: Labels, unit: str) -> str:
    """Describe a path as the title of an axis, with the unit in brackets if there is one."""
    words = describe_path(path, labels)
    return words if unit in UNITLESS else f"{words} [{unit}]"


def describe_measure(measure: str, labels: Labels) -> str:
    """Describe a measure, a path with or without a reducer: `max abs joints.main.force`, `at 0.5 energy.kinetic`."""
    *reducer, path = measure.split()
    words = " ".join(reducer)
    suffix = f"{words} s" if reducer[:1] == ["at"] else REDUCERS.get(words, words)
    text = describe_path(path, labels)
    return f"{text}, {suffix}" if suffix else text


def describe_object(kind: str, name: str, labels: Labels) -> str:
    """Return the words for a named thing of a scene: its label, else its name; for a block without names its kind."""
    first, dot, rest = name.partition(".")
    if kind == "foundation" and dot and first in ("supports", "elements"):
        return f"{describe_object(first, rest, labels)} on the ground"
    if kind == "couplings" and ".on." in name:
        coupling, _, end = name.partition(".on.")
        return f"{describe_object(kind, coupling, labels)} on {describe_object('bodies', end, labels)}"
    if kind == "joints" and ".bearings." in name:
        joint, _, number = name.partition(".bearings.")
        return f"{describe_object(kind, joint, labels)} {number}"
    label = find_label(kind, name, labels)
    if label:
        return label
    if kind == "points" and dot:
        owner = describe_object("bodies", first, labels) if first != GROUND else describe_object(GROUND, "", labels)
        return f"{owner} {make_readable(rest)}"
    return make_readable(rest if dot and first in LABELLED_BLOCKS["causes"] else name or kind)


def find_label(kind: str, name: str, labels: Labels) -> str:
    """Return the label of a named thing, or of a block; empty if it has none.

    kind: the block of its path
    name: its name in that block; one that is ambiguous there begins with its own block, as in `drives.motor`
    """
    first, dot, rest = name.partition(".")
    if kind == "foundation" and dot:
        kind, name = first, rest
        first, dot, rest = name.partition(".")
    own_block = first if dot and first in LABELLED_BLOCKS["causes"] else ""
    if own_block:
        kind, name = own_block, rest
    paths = (f"{block}.{name}" if name else block for block in LABELLED_BLOCKS.get(kind, (kind,)))
    return next((labels.captions[path] for path in paths if path in labels.captions), "")


def describe_sentence(text: str, labels: Labels) -> str:
    """Return a message of the solver in which labels stand in place of paths and names."""
    text = PATH_IN_SENTENCE.sub(lambda found: _describe_mention(found[1], found[2], labels), text)
    return THING_IN_SENTENCE.sub(
        lambda found: f"{found[1]} {describe_object(THINGS[found[1]], found[2], labels)}", text
    )


def _describe_mention(block: str, rest: str, labels: Labels) -> str:
    """Describe a path in a sentence: a quantity, or a thing with its kind."""
    if parse_path(f"{block}.{rest}") is not None:
        return describe_path(f"{block}.{rest}", labels)
    name, _, key = rest.partition(".")
    kind = next(thing for thing, own in THINGS.items() if own == block)
    return f"{kind} {describe_object(block, name, labels)}" + (f", {make_readable(key)}" if key else "")


def make_readable(name: str) -> str:
    """Return a name with blanks in place of underscores and dots."""
    return name.replace("_", " ").replace(".", " ").strip()


@lru_cache(maxsize=10_000)
def parse_path(path: str) -> PathParts | None:
    """Split a path to a quantity of the results into its parts; None if it leads to none."""
    return _follow_words(TREE, split_path(path), PathParts((), (), ROWS[0], ()))


def _follow_words(node: Node | Quantity, words: Sequence[str], parts: PathParts) -> PathParts | None:
    """Follow the words below a node of the schema; names of one word are tried first."""
    if isinstance(node, Quantity):
        return parts._replace(row=node, rest=tuple(words))
    if not words:
        return None
    if words[0] in node:
        found = _follow_words(node[words[0]], words[1:], parts._replace(words=(*parts.words, words[0])))
        if found is not None:
            return found
    placeholder = next((name for name in NAMES if name in node), None)
    for used in range(1, min(len(words), MAX_NAME_WORDS) + 1) if placeholder is not None else ():
        assert placeholder is not None
        names = (*parts.names, (placeholder, ".".join(words[:used])))
        found = _follow_words(node[placeholder], words[used:], parts._replace(names=names))
        if found is not None:
            return found
    return None


def _describe_subject(parts: PathParts, labels: Labels) -> str:
    """Describe what a quantity belongs to; empty if its words say so themselves."""
    kind = parts.words[0]
    names = [name for word, name in parts.names if word not in ("CAUSE", "NUMBER", "END", "BEARING")]
    if kind == "foundation":
        words = [*parts.words[1:2], *names] if names else []
        return describe_object(kind, ".".join(words), labels)
    if not names:
        return ""
    end = parts.find_name("END")
    return describe_object(kind, f"{names[0]}.on.{end}" if end else names[0], labels)


def _describe_quantity(parts: PathParts, labels: Labels) -> str:
    """Describe a quantity with its component, the position of its cut, and the cause whose share it is."""
    words = [word for word in parts.words if word != SHARES]
    kind, quantity = words[0], words[-1]
    keys = (".".join(words[-2:]), f"{kind}.{quantity}", quantity)
    key = next((key for key in keys if key in WORDS), quantity)
    texts = WORDS.get(key, make_readable(quantity))
    text, template = texts if isinstance(texts, tuple) else (texts, f"{texts} {{}}")
    pair = SLIDING_OR_TURNING.get(key) or SLIDING_OR_TURNING.get(f"{kind}.{key}")
    if pair is not None and len(parts.row.units) > 1:
        text = pair[labels.is_rotational(kind, parts.names[0][1])]
    components = " ".join(word for word in parts.rest if not is_cut_word(word))
    text = template.format(components) if components else text
    cut = next((word for word in parts.rest if is_cut_word(word)), "")
    text += _describe_cut(cut, has_cuts=CUT in parts.row.shape) if cut else ""
    corner, cause = parts.find_name("CORNER"), parts.find_name("CAUSE")
    text += f" at {make_readable(corner)}" if corner else ""
    return f"{text} due to {describe_object('causes', cause, labels)}" if cause else text


def _describe_cut(word: str, *, has_cuts: bool) -> str:
    """Describe the word of a path that selects a cut: `3`, `3:before`, `@end`, `@0.28`, `@280mm`; or an instant."""
    position, number = POSITION_WORD.fullmatch(word), word.partition(":")[0]
    if position is None:
        text = f" at cut {number}" if has_cuts else f" {number}"
    elif position["at"].lower() in ("start", "end"):
        text = f" at the {position['at'].lower()}"
    else:
        text = f" at {position['at']} {position['unit'] or 'm'}"
    return text + SIDE_PHRASES.get(word.partition(":")[2], "")


def _describe_entry(path: str, labels: Labels) -> str:
    """Describe a path of the spec: a parameter, a named thing, or a key of one."""
    block, *words = path.split(".")
    if not words:
        return labels.captions.get(f"parameters.{block}") or describe_object(block, "", labels)
    used = 2 if block == "points" else 1
    name, rest = ".".join(words[:used]), ".".join(words[used:])
    subject = describe_object(block, name, labels)
    return f"{subject}, {make_readable(rest)}" if rest else subject


OPTIONS = ("--title", "--label")  # the words before what is wrong
ARGUMENTS = ("title", "labels")


def set_captions(
    spec: Spec, title: str | None, labels: Iterable[tuple[str, str]], names: tuple[str, str] = ARGUMENTS
) -> Spec:
    """Return a spec with another title, and with labels for paths as users write them.

    names: of title and labels, for messages

    Raises UsageError with all that is wrong.
    """
    problems: list[Problem] = []
    found: dict[str, str] = {}
    shown = spec.title
    try:
        if title is not None:
            shown = format_case_title(check_text(names[0], title), spec.case, spec.cases)
    except UsageError as error:
        problems += error.problems
    for path, text in labels:
        try:
            found[_find_label_path(path, spec, names[1])] = check_text(f"{names[1]} {path}", text)
        except UsageError as error:
            problems += error.problems
    if problems:
        raise UsageError(*problems)
    return spec._replace(title=shown, labels={**spec.labels, **found})


def check_text(option: str, text: str) -> str:
    """Return the text of an option as it is shown. Raises UsageError."""
    try:
        return check_plain_text(text)
    except Finding as finding:
        raise UsageError(Problem("bad-option", f"{option}: {finding.message}", hint=finding.hint)) from None


def _find_label_path(path: str, spec: Spec, option: str) -> str:
    """Find the path under which a label is stored, from a path as users write it. Raises UsageError."""
    paths = dict(iter_label_paths(spec))
    found = paths.get(path)
    if found is not None:
        return found
    parts = parse_path(path)
    if parts is not None and (not parts.names or any(path.startswith(f"{known}.") for known in paths.values())):
        return path  # it names one quantity of an entry
    same_names = [known for known in paths if known.endswith(f".{path}")]
    hint = f"did you mean {', or '.join(same_names)}?" if same_names else suggest(path, paths, "paths")
    raise UsageError(Problem("unknown-path", f"{option} {path}: nothing in the spec has this name", hint=hint))


def iter_label_paths(spec: Spec) -> Iterator[tuple[str, str]]:
    """Yield all that has a label: the path as users write it, and the path under which its label is stored.

    Points have two paths, as in the spec and as in the results.
    """
    from heuncli.scene.file_format.labels import BLOCKS, EVENTS, GROUND, POINTS
    from heuncli.scene.file_format.names import collect_scene_names

    names = collect_scene_names(spec)
    yield GROUND, GROUND
    for block, kept_block in {**BLOCKS, EVENTS: EVENTS}.items():
        yield from ((f"{block}.{name}", f"{kept_block}.{name}") for name in names.entries[block])
    for owner, points in names.points.items():
        prefix = GROUND if owner == GROUND else f"bodies.{owner}"
        for point in points:
            label_path = f"{POINTS}.{owner}.{point}"
            yield from ((label_path, label_path), (f"{prefix}.{POINTS}.{point}", label_path))
