"""The shapes of small oscillations: the machine's lines at rest, and displaced to both sides by a mode.

Displacements are of first order, scaled so that the farthest point moves by a fixed share of the machine's size. If the
points do not pass the rest pose at the same time, as on turning shafts, the second lines are a quarter of a period
later.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.modes.study import BodyModes
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.linearisation.oscillations import Mode
from heuncli.multibody.mechanism.model import Body
from heuncli.output.drawing.axes import write_minus
from heuncli.output.drawing.figure import Figure, Item, Panel, Scaling, Spot, Strokes, Trace
from heuncli.output.figures.courses import NotDrawable
from heuncli.output.machine_geometry.machine import Machine
from heuncli.output.machine_geometry.views import SceneView
from heuncli.output.tables.mode_words import describe_coordinate, describe_modes, format_mode, iter_notes
from heuncli.results.results import Array
from heuncli.scene.file_format.names import GROUND

HEIGHT = 220.0  # pixels
MAX_COLUMNS = 3
ENTRY = re.compile(r"\b(?:forces|drives|joints|couplings)\.(\w+)")  # an entry of the spec in a sentence
DIGITS = 4  # of frequencies and dampings
MAX_MODES = 12  # maximum number drawn
DISPLACEMENT_SHARE = 0.12  # of the machine's extent: largest displacement drawn
MAX_TURN = 0.35  # [rad] largest turn for which first-order lines keep their length
MAX_SUPPORT_DISTANCE = 3.0  # of the extent: farther supports, as of planes, are not drawn
MARGIN = 0.05  # of the extent, around all
MIN_PHASE_PART = 0.02  # of the largest displacement: a smaller part of the other phase is neglected
REST, ONE, OTHER = None, 0, 1  # pens


class ModeLines(NamedTuple):
    """A mode: its title, and its lines on the one side and on the other, (n, 3) each.

    is_quarter_later: whether the other lines are a quarter of a period later
    """

    title: str
    one: list[Array]
    other: list[Array]
    is_quarter_later: bool


class MovingLine(NamedTuple):
    """A line of the machine: its name, its points (n, 3), and the body of each point (n,); -1 is the ground."""

    name: str
    points: Array
    bodies: tuple[int, ...]


def make_mode_shapes(moved_bodies: BodyModes, machine: Machine, view: SceneView) -> Figure:
    """Make the figure of a scene's modes, a panel each. Raises NotDrawable if nothing is free to oscillate."""
    modes = moved_bodies.modes.modes
    if not modes:
        raise NotDrawable("modes: 0 degrees of freedom, so no modes", "driven motion: heun run")
    lines = list(_iter_lines(moved_bodies, machine))
    resting = np.concatenate([line.points for line in lines])
    extent = float(np.ptp(view.project(resting), axis=0).max()) or 1.0
    middle = resting.mean(axis=0)
    supports = [
        place for place in _iter_supports(machine) if np.linalg.norm(place - middle) <= MAX_SUPPORT_DISTANCE * extent
    ]
    mode_lines = [_make_mode_lines(moved_bodies, k, mode, lines, extent) for k, mode in enumerate(modes[:MAX_MODES])]
    all_points = np.concatenate(
        [view.project(np.concatenate(displaced)) for mode in mode_lines for displaced in (mode.one, mode.other)]
    )
    all_points = np.concatenate([all_points, *(view.project(place)[None] for place in supports)])
    low, high = all_points.min(axis=0) - MARGIN * extent, all_points.max(axis=0) + MARGIN * extent
    axes = tuple(Scaling("", float(a), float(b)) for a, b in zip(low, high, strict=True))
    panels = [_make_panel(mode, lines, supports, view, (axes[0], axes[1])) for mode in mode_lines]
    sentences = list(iter_notes(moved_bodies.modes))
    if len(modes) > MAX_MODES:
        sentences.append(f"first {MAX_MODES} of {len(modes)} modes drawn; all: heun modes")
    later_phrase = (
        " (with phase differences: a quarter period later)" if any(mode.is_quarter_later for mode in mode_lines) else ""
    )
    legend = [("one extreme", ONE), (f"other extreme{later_phrase}", OTHER)]
    sentences += _describe_equal_frequencies(modes)
    columns = min(MAX_COLUMNS, len(panels))
    words = [ENTRY.sub(r"\1", sentence) for sentence in describe_modes(moved_bodies.modes)]
    return Figure(moved_bodies.modes.title, words, panels, legend, sentences, n_columns=columns)


def _describe_equal_frequencies(modes: Sequence[Mode]) -> Iterator[str]:
    """Yield which modes have the same frequency to all digits that are certain."""
    numbers: dict[str, list[int]] = {}
    for k, mode in enumerate(modes[:MAX_MODES], 1):
        if mode.frequency:
            numbers.setdefault(format_mode(mode).frequency, []).append(k)
    groups = [f"{', '.join(map(str, same[:-1]))} and {same[-1]}" for same in numbers.values() if len(same) > 1]
    if groups:
        yield f"equal frequencies: modes {'; '.join(groups)}: any mixture of their shapes is a mode, too"


def _iter_lines(moved_bodies: BodyModes, machine: Machine) -> Iterator[MovingLine]:
    """Yield the edges of bodies, or the lines between their points, and the lines of springs, rods and ropes."""
    places = {name: k for k, name in enumerate(moved_bodies.names)}
    for body in machine.bodies:
        k = places[body.name]
        body_lines = [edge for surface in body.surfaces for edge in surface.edges] or list(body.strokes)
        if sum(map(len, body_lines)) < 2:
            body_lines = _make_box(moved_bodies.scene.mechanism.bodies[k])
        for line in body_lines:
            yield MovingLine(body.name, _to_world(moved_bodies, k, line), (k,) * len(line))
    ropes = [(j.name, j.a, j.p, j.b, j.q) for j in machine.joints if JOINTS[j.kind].keeps_distance]
    springs = [
        (force_line.name, force_line.a, force_line.p, force_line.b, force_line.q) for force_line in machine.lines
    ]
    for name, a, p, b, q in (*springs, *ropes):
        ends = places.get(a, -1), places.get(b, -1)
        points = np.array([_to_world(moved_bodies, k, point) for k, point in zip(ends, (p, q), strict=True)])
        yield MovingLine(name, points, ends)


def _make_box(body: Body) -> list[Array]:
    """Return the edges of the box of even density that has the mass moments of a body without shape and points."""
    second = (0.5 * np.trace(body.inertia) - np.diag(body.inertia)) / (body.mass or 1.0)
    a, b, c = np.sqrt(3.0 * np.maximum(second, 0.0))  # half its sides: a²/3 is the mean square of x
    ring = np.array([(-a, -b), (a, -b), (a, b), (-a, b), (-a, -b)])
    ends = [np.column_stack([ring, np.full(5, side)]) for side in (-c, c)]
    return [body.center + line for line in (*ends, *np.stack(ends, axis=1)[:4])]


def _iter_supports(machine: Machine) -> Iterator[Array]:
    """Yield the points of joints on the ground, (3,)."""
    for joint in machine.joints:
        if joint.a == GROUND:
            yield joint.p
        elif joint.b == GROUND:
            yield joint.q


def _to_world(moved_bodies: BodyModes, body: int, points: Array) -> Array:
    """Transform points (..., 3) of a body, or of the ground, to the world."""
    if body < 0:
        return np.asarray(points, dtype=np.float64)
    return np.asarray(points @ moved_bodies.attitudes[body].T + moved_bodies.places[body])


def _find_displacements(moved_bodies: BodyModes, mode: int, line: MovingLine) -> Array:
    """Return the displacements of the points of a line, (n, 3) complex."""
    displacements = np.zeros(line.points.shape, dtype=complex)
    for body in set(line.bodies) - {-1}:
        of_body = np.array(line.bodies) == body
        displacements[of_body] = moved_bodies.displace_points(mode, body, line.points[of_body])
    return displacements


def _make_mode_lines(moved_bodies: BodyModes, k: int, mode: Mode, lines: list[MovingLine], extent: float) -> ModeLines:
    """Return a mode's lines, displaced far enough to be visible."""
    parts = [_find_displacements(moved_bodies, k, line) for line in lines]
    whole = np.concatenate(parts)
    flat = whole.reshape(-1)
    largest = flat[int(np.argmax(np.abs(flat)))] if np.abs(flat).max(initial=0.0) > 0.0 else 1.0
    phase = np.conj(largest) / abs(largest)
    size = float(np.sqrt((np.abs(whole) ** 2).sum(axis=1)).max())
    largest_turn = float(np.sqrt((np.abs(moved_bodies.turns[k]) ** 2).sum(axis=1)).max(initial=0.0))
    scale = min(
        DISPLACEMENT_SHARE * extent / size if size else 0.0, MAX_TURN / largest_turn if largest_turn else np.inf
    )
    has_phases = bool(np.abs((phase * flat).imag).max() > MIN_PHASE_PART * abs(largest))
    later = phase * (1j if has_phases else -1.0)
    one_side = [line.points + scale * (phase * part).real for line, part in zip(lines, parts, strict=True)]
    other_side = [line.points + scale * (later * part).real for line, part in zip(lines, parts, strict=True)]
    return ModeLines(_make_title(k, mode, moved_bodies), one_side, other_side, has_phases)


def _make_title(k: int, mode: Mode, moved_bodies: BodyModes) -> str:
    """Return a mode in two lines: its number, frequency and damping ratio or growth; what moves most."""
    texts = format_mode(mode)
    moving = ", ".join(map(describe_coordinate, moved_bodies.modes.largest[k]))
    if mode.kind == "free":
        return f"mode {k + 1}: free\n{moving}"
    unstable = "UNSTABLE, " if mode.growth > 0.0 else ""
    if not mode.frequency:
        return f"mode {k + 1}: {unstable}{mode.kind}, growth {_shorten(texts.growth)} 1/s\n{moving}"
    damping = f"ζ = {_shorten(texts.damping)}"
    return f"mode {k + 1}: {unstable}{_shorten(texts.frequency)} Hz, {damping}\n{moving}"


def _shorten(text: str) -> str:
    """Shorten a number to four digits; other words stay."""
    digits = text.partition("e")[0].lstrip("-0.").replace(".", "")
    return write_minus(f"{float(text):#.{DIGITS}g}" if digits.isdecimal() and len(digits) > DIGITS else text)


def _make_panel(
    mode: ModeLines, lines: list[MovingLine], supports: list[Array], view: SceneView, axes: tuple[Scaling, Scaling]
) -> Panel:
    """Make the panel of a mode: at rest, and displaced."""
    items: list[Item] = []
    for line in lines:
        flat = view.project(line.points)
        items.append(Strokes(np.stack([flat[:-1], flat[1:]], axis=1), REST, 0.8))
    for number, displaced in ((OTHER, mode.other), (ONE, mode.one)):
        for line, points in zip(lines, displaced, strict=True):
            flat = view.project(points)
            items.append(Trace(line.name, flat[:, 0], flat[:, 1], number, is_thin=number == OTHER))
    for place in supports:
        across, up = view.project(place)
        items.append(Spot(float(across), float(up), "", REST, "triangle"))
    return Panel(*axes, tuple(items), HEIGHT, has_equal_scales=True, is_bare=True, title=mode.title)
