"""The shapes of small oscillations: the machine's lines as it rests, and as far to both sides as a mode takes it.

Displacements are those of the first order, drawn so large that the farthest point moves by a share of the machine.
Where points do not pass the pose at rest together, as on turning shafts, the second lines are a quarter of a period
later.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.analyses.modes.moved_bodies import MovedBodies
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.linearisation.oscillations import Mode
from heuncli.multibody.mechanism.model import Body
from heuncli.output.drawing.figure import Figure, Item, Panel, Scaling, Spot, Strokes, Trace
from heuncli.output.figures.refusals import NotDrawable
from heuncli.output.machine_geometry.machine import Machine
from heuncli.output.machine_geometry.views import SceneView
from heuncli.output.tables.mode_words import about, figures_of, notes
from heuncli.results.results import Array
from heuncli.scene.file_format.names import GROUND

HEIGHT = 230.0  # pixels
MOST = 12  # modes that are drawn
SHARE = 0.12  # of the machine's extent: how far its farthest point is drawn to move
TURNED = 0.35  # [rad] the farthest turn, beyond which lines drawn by the first order are too long
FAR = 3.0  # of the extent: supports farther off, as of planes, are not drawn
EDGE = 0.05  # of the extent: beyond what is drawn
PHASE = 0.02  # of the largest displacement: smaller parts of the other phase are none
REST, ONE, OTHER = None, 0, 1  # pens


class DrawnMode(NamedTuple):
    """A mode: its title, its lines the one way and the other, each (n, 3), and whether that is a quarter later."""

    title: str
    one: list[Array]
    other: list[Array]
    apart: bool


class MovingLine(NamedTuple):
    """A line of the machine: its name, its points (n, 3), and which body they go with (n,), -1 with the ground."""

    name: str
    points: Array
    bodies: tuple[int, ...]


def mode_shapes(found: MovedBodies, machine: Machine, view: SceneView) -> Figure:
    """The figure of a scene's modes, a panel each. Raises NotDrawable where nothing is free to oscillate."""
    modes = found.modes.modes
    if not modes:
        raise NotDrawable("modes: nothing is free to oscillate", "heun run moves what is driven")
    lines = list(_lines(found, machine))
    resting = np.concatenate([line.points for line in lines])
    extent = float(np.ptp(view.flat(resting), axis=0).max()) or 1.0
    middle = resting.mean(axis=0)
    supports = [place for place in _supports(machine) if np.linalg.norm(place - middle) <= FAR * extent]
    drawn = [_drawn(found, k, mode, lines, extent) for k, mode in enumerate(modes[:MOST])]
    every = np.concatenate([view.flat(np.concatenate(way)) for mode in drawn for way in (mode.one, mode.other)])
    every = np.concatenate([every, *(view.flat(place)[None] for place in supports)])
    low, high = every.min(axis=0) - EDGE * extent, every.max(axis=0) + EDGE * extent
    axes = tuple(Scaling("", float(a), float(b)) for a, b in zip(low, high, strict=True))
    panels = [_panel(mode, lines, supports, view, (axes[0], axes[1])) for mode in drawn]
    told = list(notes(found.modes))
    if len(modes) > MOST:
        told.append(f"the first {MOST} of {len(modes)} modes are drawn; heun modes lists them all")
    later = " (where phases differ a quarter of a period later)" if any(mode.apart for mode in drawn) else ""
    legend = [("one way", ONE), (f"the other way{later}", OTHER)]
    return Figure(found.modes.title, about(found.modes), panels, legend, told)


def _lines(found: MovedBodies, machine: Machine) -> Iterator[MovingLine]:
    """The edges of bodies, or the lines between their points; springs, rods and ropes between theirs."""
    places = {name: k for k, name in enumerate(found.names)}
    for body in machine.bodies:
        k = places[body.name]
        own = [edge for surface in body.surfaces for edge in surface.edges] or list(body.strokes)
        if sum(map(len, own)) < 2:
            own = _cross(found.scene.mechanism.bodies[k])
        for line in own:
            yield MovingLine(body.name, _in_world(found, k, line), (k,) * len(line))
    ropes = [(j.name, j.a, j.p, j.b, j.q) for j in machine.joints if JOINTS[j.kind].keeps_distance]
    springs = [(one.name, one.a, one.p, one.b, one.q) for one in machine.lines]
    for name, a, p, b, q in (*springs, *ropes):
        ends = places.get(a, -1), places.get(b, -1)
        points = np.array([_in_world(found, k, at) for k, at in zip(ends, (p, q), strict=True)])
        yield MovingLine(name, points, ends)


def _cross(body: Body) -> list[Array]:
    """Lines along the axes of a body that has neither shape nor points, as long as its mass reaches."""
    second = (0.5 * np.trace(body.inertia) - np.diag(body.inertia)) / body.mass
    reach = np.sqrt(np.maximum(second, 0.0))
    return [np.array([body.center - a * e, body.center + a * e]) for a, e in zip(reach, np.eye(3), strict=True)]


def _supports(machine: Machine) -> Iterator[Array]:
    """Where joints stand on the ground, (3,)."""
    for joint in machine.joints:
        if joint.a == GROUND:
            yield joint.p
        elif joint.b == GROUND:
            yield joint.q


def _in_world(found: MovedBodies, body: int, points: Array) -> Array:
    """Points (..., 3) of a body, or of the ground, in the world."""
    if body < 0:
        return np.asarray(points, dtype=np.float64)
    return np.asarray(points @ found.attitudes[body].T + found.places[body])


def _displacements(found: MovedBodies, mode: int, line: MovingLine) -> Array:
    """How far the points of a line go, (n, 3) complex."""
    moved = np.zeros(line.points.shape, dtype=complex)
    for body in set(line.bodies) - {-1}:
        own = np.array(line.bodies) == body
        moved[own] = found.moved(mode, body, line.points[own])
    return moved


def _drawn(found: MovedBodies, k: int, mode: Mode, lines: list[MovingLine], extent: float) -> DrawnMode:
    """A mode's lines, so far from where they rest as is seen."""
    parts = [_displacements(found, k, line) for line in lines]
    whole = np.concatenate(parts)
    flat = whole.reshape(-1)
    largest = flat[int(np.argmax(np.abs(flat)))] if np.abs(flat).max(initial=0.0) > 0.0 else 1.0
    phase = np.conj(largest) / abs(largest)
    size = float(np.sqrt((np.abs(whole) ** 2).sum(axis=1)).max())
    turned = float(np.sqrt((np.abs(found.turns[k]) ** 2).sum(axis=1)).max(initial=0.0))
    scale = min(SHARE * extent / size if size else 0.0, TURNED / turned if turned else np.inf)
    apart = bool(np.abs((phase * flat).imag).max() > PHASE * abs(largest))
    later = phase * (1j if apart else -1.0)
    one = [line.points + scale * (phase * part).real for line, part in zip(lines, parts, strict=True)]
    other = [line.points + scale * (later * part).real for line, part in zip(lines, parts, strict=True)]
    return DrawnMode(_title(k, mode, found), one, other, apart)


def _title(k: int, mode: Mode, found: MovedBodies) -> str:
    """A mode in a line: its number, its frequency and damping or its growth, what moves most."""
    figures = figures_of(mode)
    moving = ", ".join(found.modes.largest[k])
    if mode.kind == "free":
        return f"mode {k + 1}: free; {moving}"
    unstable = "UNSTABLE, " if mode.growth > 0.0 else ""
    if not mode.frequency:
        return f"mode {k + 1}: {unstable}{mode.kind}, growth {figures.growth} 1/s; {moving}"
    return f"mode {k + 1}: {unstable}{figures.frequency} Hz, damping {figures.damping}; {moving}"


def _panel(
    mode: DrawnMode, lines: list[MovingLine], supports: list[Array], view: SceneView, axes: tuple[Scaling, Scaling]
) -> Panel:
    """A mode: at rest, and displaced."""
    items: list[Item] = []
    for line in lines:
        flat = view.flat(line.points)
        items.append(Strokes(np.stack([flat[:-1], flat[1:]], axis=1), REST, 0.8))
    for number, way in ((OTHER, mode.other), (ONE, mode.one)):
        for line, points in zip(lines, way, strict=True):
            flat = view.flat(points)
            items.append(Trace(line.name, flat[:, 0], flat[:, 1], number, thin=number == OTHER))
    for place in supports:
        across, up = view.flat(place)
        items.append(Spot(float(across), float(up), "", REST, "triangle"))
    return Panel(*axes, tuple(items), HEIGHT, equal=True, bare=True, title=mode.title)
