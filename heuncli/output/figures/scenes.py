"""The machine at instants of its run, seen from somewhere: where it stands, what holds it, what acts, how points go.

The first instant is drawn strongly, with what acts there; later ones are thin lines. Beyond the horizon there are none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.multibody.coupled_start.prepared import prepare_coupled
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.output.drawing.figure import Arrow, Figure, Item, Panel, PlaceLabel, Scaling
from heuncli.output.drawing.ticks import short
from heuncli.output.figures import machine_items, rope_items, traces
from heuncli.output.figures.courses import Pictured, require_claimed
from heuncli.output.figures.machine_items import Stood
from heuncli.output.figures.pulls import NOTHING, Pulls, drawn, key, pulls_of
from heuncli.output.figures.traces import Traced
from heuncli.output.figures.windows import Window, clipped, window_of
from heuncli.output.machine_geometry.machine import Machine, machine_of
from heuncli.output.machine_geometry.poses import Poses, poses_at_start, poses_of
from heuncli.output.machine_geometry.solids import ROUND
from heuncli.output.machine_geometry.views import usual, view_of
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Damper, Friction, Motor, Spec, Torque, TurnSpring
from heuncli.study.model.setup import draw
from heuncli.study.quantities.table_units import Units

HEIGHT = 520.0  # pixels of a picture, at most
STRIP = 0.13  # of the larger side, below what is drawn: for the key of arrows, axes and gravity
CORNER = 0.05  # of the larger side: the arrows of axes and gravity
IN_JOINTS = (Damper, Friction, Motor, Torque, TurnSpring)
SMOOTH, MANY = 60, 40  # faces about an axis, and of up to how many bodies
LATER = 7  # the pen of what names later instants


def scene(
    source: Pictured,
    units: Units,
    at: Array | None = None,
    view: str | None = None,
    traced: Sequence[str] = (),
) -> Figure:
    """The figure of one run at some instants (n,) ascending; default: its first. traced: points, `body.point`.

    A body's point `center` is its centre of mass, where none is named so. Raises Finding for a view that there is not,
    NotDrawable for a run of which nothing is claimed.
    """
    study = source.study
    require_claimed(study)
    times = study.results.time[:1] if at is None else at
    poses = poses_of(study, times)
    stood = standing(study.setup.scene, study.spec, poses, view, units)
    ways = traces.traced(source, traced) if traced else traces.reported(source)
    return figure(stood, units, ways, pulls_of(study, stood.machine, poses), source.name)


def as_assembled(spec: Spec, view: str | None = None) -> Figure:
    """The figure of a scene as it is assembled; nothing is solved. Raises SolveError where it does not close, Finding.

    Of one whose rest pose is asked for it is the pose from which that is looked for.
    """
    t = spec.analysis.times[0] if spec.analysis.type == "state" else 0.0
    prepared = prepare_coupled(draw(spec)[0], t)
    poses = poses_at_start(prepared.mechanism, prepared.start, t)
    return figure(standing(prepared, spec, poses, view, Units()), Units(), [], NOTHING)


def standing(scene: PreparedScene, spec: Spec, poses: Poses, view: str | None, units: Units) -> Stood:
    """A machine in some poses as it is seen. Raises Finding."""
    machine, centers = machine_of(spec, faces(spec), scene), centers_of(scene.mechanism)
    seen = view_of(view, scene.mechanism.gravity) if view is not None else None
    if seen is None:
        seen = usual(scene, _extent(machine, centers, poses))
    return Stood(spec, machine, centers, poses, seen, units.of("m")[1])


def faces(spec: Spec) -> int:
    """How many of what is round: enough for a smooth outline, fewer of very many bodies."""
    return SMOOTH if len(spec.bodies) <= MANY else ROUND


def centers_of(mechanism: Mechanism) -> Mapping[str, Array]:
    """The bodies' centres of mass, in body axes."""
    return {body.name: np.asarray(body.center) for body in mechanism.bodies}


def _extent(machine: Machine, centers: Mapping[str, Array], poses: Poses) -> Array:
    """Points (n, 3) that a machine reaches to at the first instant."""
    points = [poses.at(body.name, np.array(p), 0) for body in machine.bodies for p in (centers[body.name],)]
    for body in machine.bodies:
        own = [surface.corners for surface in body.surfaces if not body.spread] + list(body.strokes)
        points += [place for part in own for place in poses.at(body.name, part, 0)]
    points += [place for path in machine.paths for place in path]
    points += [poses.at(j.b, j.q, 0) for j in machine.joints] + [poses.at(j.a, j.p, 0) for j in machine.joints]
    return np.array(points)


def figure(stood: Stood, units: Units, ways: Sequence[Traced], pulls: Pulls, name: str = "") -> Figure:
    """The machine with the ways of some points and what acts at the first instant."""
    first = _first(stood)
    later = [item for k in range(len(stood.poses.times) - 1, 0, -1) for item in _later(stood, k)]
    strands = [line.ends.reshape(-1, 2) for line in rope_items.ropes(stood, 0)]
    within = window_of(stood, [*(traces.seen(stood, one) for one in ways), *strands, *rope_items.reach(stood)])
    arrows = drawn(pulls, stood.view, stood.size, within.side, units)
    window = within.with_arrows([item for item in arrows.items if isinstance(item, Arrow)])
    items = [*clipped(later, window), *traces.curves(stood, ways), *clipped(first, window), *arrows.items]
    items += [
        *machine_items.names(stood, 0),
        *rope_items.names(stood, 0),
        *_instants(stood),
        *traces.names(stood, ways),
    ]
    strip = STRIP * window.side
    items += _corner(stood, window, strip)
    step = 0.035 * window.side
    where = window.low[0] + (0.30 if not stood.view.along_axes else 0.06) * window.side
    items += key(pulls, arrows.scale, where, window.low[1] - 0.35 * strip, step, units)
    unit = units.of("m")[0]
    right, up = stood.view.names()
    low, high = window.low - (0.0, strip), window.high
    across, upward = Scaling(f"{right} [{unit}]", low[0], high[0]), Scaling(f"{up} [{unit}]", low[1], high[1])
    panel = Panel(across, upward, tuple(items), HEIGHT, equal=True, title=name, layered=True)
    return Figure(stood.spec.title, _words(stood), [panel], (), [*_notes(stood, pulls), *arrows.notes, *window.notes])


def _first(stood: Stood) -> list[Item]:
    """The first instant."""
    items = [*machine_items.bodies(stood, 0), *machine_items.marks(stood, 0)]
    items += [item for line in stood.machine.lines for item in machine_items.line(stood, line, 0)]
    items += rope_items.ropes(stood, 0)
    items += machine_items.strands(stood, 0)
    items += machine_items.in_joints(stood, 0)
    return [*items, *machine_items.joints(stood, 0), *rope_items.marks(stood, 0)]


def _later(stood: Stood, k: int) -> list[Item]:
    """Another one, in thin lines."""
    items = machine_items.bodies(stood, k, thin=True)
    items += [item for line in stood.machine.lines for item in machine_items.line(stood, line, k, thin=True)]
    items += rope_items.ropes(stood, k, thin=True)
    return items + machine_items.joints(stood, k, thin=True)


def _instants(stood: Stood) -> Iterator[PlaceLabel]:
    """The later instants, beside the body that has moved most since the first."""
    if len(stood.poses.times) < 2:
        return
    ways = {
        body.name: np.array([stood.seen(body.name, stood.centers[body.name], k) for k in range(len(stood.poses.times))])
        for body in stood.machine.bodies
    }
    most = max(ways, key=lambda name: (float(np.abs(ways[name] - ways[name][0]).max()), name))
    for t, (x, y) in zip(stood.poses.times.tolist(), ways[most].tolist(), strict=True):
        text = f"{short(t)} s"
        yield PlaceLabel(x, y, text, text, LATER)


def _corner(stood: Stood, window: Window, strip: float) -> Iterator[Item]:
    """The world's axes where they are not those of the picture, and gravity where it is seen."""
    length = CORNER * window.side
    x, y = float(window.low[0]) + 1.6 * length, float(window.low[1]) - 0.5 * strip
    if not stood.view.along_axes:
        for name, axis in zip("xyz", np.eye(3), strict=True):
            a, b = (length * stood.view.flat(axis)).tolist()
            yield Arrow(x, y, a, b, None, name)
    gravity = stood.view.flat(np.array(stood.spec.gravity))
    size = float(np.linalg.norm(stood.spec.gravity))
    if size > 0.0 and float(np.hypot(*gravity)) > 0.2 * size:
        a, b = (1.4 * length * gravity / size).tolist()
        yield Arrow(float(window.high[0]) - 1.2 * length, float(window.low[1]) - 0.1 * strip, a, b, LATER, "g")


def _words(stood: Stood) -> list[str]:
    """At which instants, and from where."""
    times = [short(t) for t in stood.poses.times.tolist()]
    at = f"t = {times[0]} s" + (f"; in thin lines t = {', '.join(times[1:])} s" if len(times) > 1 else "")
    return [f"{at}; seen from {stood.view.words}"]


def _notes(stood: Stood, pulls: Pulls) -> list[str]:
    """What is not drawn, and what no symbol tells."""
    notes = []
    if not stood.are_named:
        bodies, joints = len(stood.machine.bodies), len(stood.machine.joints)
        notes.append(f"without names: {bodies} bodies and {joints} joints are too many for them")
    if pulls.open:
        notes.append(f"open, and not drawn: the forces and moments of {', '.join(pulls.open)}")
    spread = [body.name for body in stood.machine.bodies if body.spread and stood.solids[body.name]]
    if spread:
        notes.append(f"drawn as the ellipsoid that has its inertia: {', '.join(spread)}")
    forces = stood.spec.forces.items()
    acting = [f"{n} ({f.type.replace('_', ' ')} in {f.joint})" for n, f in forces if isinstance(f, IN_JOINTS)]
    acting += [f"{n} (drive of {drive.joint})" for n, drive in stood.spec.drives.items()]
    if acting and stood.are_named:
        notes.append(f"in joints: {', '.join(acting)}")
    return notes
