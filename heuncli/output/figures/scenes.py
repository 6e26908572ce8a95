"""Figures of the machine at instants of its run in a view: poses, supports, acting loads, paths of points.

The first instant is drawn with thick lines and with the loads that act; later ones are thin lines. None are drawn
beyond the horizon.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.multibody.coupled_start.prepare_coupled import prepare_coupled
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.output.drawing.figure import Arrow, Figure, Item, Panel, PlaceLabel, Scaling
from heuncli.output.drawing.ticks import format_short
from heuncli.output.figures import machine_items, rope_items, traces
from heuncli.output.figures.acting_loads import NO_LOADS, ActingLoads, collect_loads, draw_key, draw_loads
from heuncli.output.figures.courses import FigureSource, require_claimed
from heuncli.output.figures.machine_items import PosedMachine
from heuncli.output.figures.traces import PointPath
from heuncli.output.figures.windows import Window, choose_window, clip_items
from heuncli.output.machine_geometry.machine import Machine, make_machine
from heuncli.output.machine_geometry.poses import Poses, compute_poses, make_start_poses
from heuncli.output.machine_geometry.solids import ROUND_FACES
from heuncli.output.machine_geometry.views import choose_view, parse_view
from heuncli.results.results import Array
from heuncli.scene.file_format.models import JointForce, Spec
from heuncli.study.model.setup import build_with_cuts
from heuncli.study.quantities.table_units import Units

HEIGHT = 520.0  # pixels, maximum
STRIP_HEIGHT = 0.13  # share of the larger side, below the machine: for the key of arrows, axes and gravity
AXES_LENGTH = 0.05  # share of the larger side: the arrows of axes and gravity
N_SMOOTH_FACES, MAX_SMOOTH_BODIES = 60, 40  # faces about an axis, and up to how many bodies
LATER_PEN = 7  # of the labels of later instants


def make_scene_figure(
    source: FigureSource,
    units: Units,
    given_times: Array | None = None,
    view: str | None = None,
    point_names: Sequence[str] = (),
) -> Figure:
    """Make the figure of one run at some instants.

    given_times (n,): ascending; by default the first instant of the run
    point_names: points whose paths are drawn, `body.point`; `center` is the centre of mass unless a point has that name

    Raises Finding for an unknown view, NotDrawable for a run of which nothing is claimed.
    """
    study = source.study
    require_claimed(study)
    times = study.results.time[:1] if given_times is None else given_times
    poses = compute_poses(study, times)
    posed_machine = pose_machine(study.setup.scene, study.spec, poses, view, units)
    point_paths = traces.make_paths(source, point_names) if point_names else traces.make_reported_paths(source)
    return make_machine_figure(
        posed_machine, units, point_paths, collect_loads(study, posed_machine.machine, poses), source.name
    )


def make_assembly_figure(spec: Spec, view: str | None = None) -> Figure:
    """Make the figure of a scene as assembled, without solving it. If its rest pose is requested, it shows the start of
    the search.

    Raises SolveError if it does not close, Finding for an unknown view.
    """
    t = spec.analysis.times[0] if spec.analysis.type == "state" else 0.0
    prepared = prepare_coupled(build_with_cuts(spec)[0], t)
    poses = make_start_poses(prepared.mechanism, prepared.start, t)
    return make_machine_figure(pose_machine(prepared, spec, poses, view, Units()), Units(), [], NO_LOADS)


def pose_machine(scene: PreparedScene, spec: Spec, poses: Poses, view: str | None, units: Units) -> PosedMachine:
    """Return a machine in some poses as seen in a view. Raises Finding."""
    machine, centers = make_machine(spec, choose_face_count(spec), scene), find_centers(scene.mechanism)
    scene_view = parse_view(view, scene.mechanism.gravity) if view is not None else None
    if scene_view is None:
        scene_view = choose_view(scene, _collect_points(machine, centers, poses))
    return PosedMachine(spec, machine, centers, poses, scene_view, units.find("m")[1])


def choose_face_count(spec: Spec) -> int:
    """Return the number of faces of round surfaces: enough for a smooth outline, fewer for very many bodies."""
    return N_SMOOTH_FACES if len(spec.bodies) <= MAX_SMOOTH_BODIES else ROUND_FACES


def find_centers(mechanism: Mechanism) -> Mapping[str, Array]:
    """Return the bodies' centres of mass, body axes."""
    return {body.name: np.asarray(body.center) for body in mechanism.bodies}


def _collect_points(machine: Machine, centers: Mapping[str, Array], poses: Poses) -> Array:
    """Return points (n, 3) that span the machine at the first instant."""
    points = [poses.locate_points(body.name, np.array(p), 0) for body in machine.bodies for p in (centers[body.name],)]
    for body in machine.bodies:
        lines = [surface.corners for surface in body.surfaces if not body.is_ellipsoid] + list(body.strokes)
        points += [place for part in lines for place in poses.locate_points(body.name, part, 0)]
    points += [place for path in machine.paths for place in path]
    points += [poses.locate_points(j.b, j.q, 0) for j in machine.joints] + [
        poses.locate_points(j.a, j.p, 0) for j in machine.joints
    ]
    return np.array(points)


def make_machine_figure(
    posed_machine: PosedMachine, units: Units, point_paths: Sequence[PointPath], loads: ActingLoads, name: str = ""
) -> Figure:
    """Make the figure of the machine with the paths of some points and the loads at the first instant."""
    first = _draw_first_instant(posed_machine)
    later = [
        item for k in range(len(posed_machine.poses.times) - 1, 0, -1) for item in _draw_later_instant(posed_machine, k)
    ]
    strands = [line.ends.reshape(-1, 2) for line in rope_items.draw_ropes(posed_machine, 0)]
    machine_window = choose_window(
        posed_machine,
        [
            *(traces.project_path(posed_machine, point_path) for point_path in point_paths),
            *strands,
            *rope_items.iter_mark_places(posed_machine),
        ],
    )
    arrows = draw_loads(loads, posed_machine.view, posed_machine.size, machine_window.side, units)
    window = machine_window.extend_to_arrows([item for item in arrows.items if isinstance(item, Arrow)])
    items = [
        *clip_items(later, window),
        *traces.draw_paths(posed_machine, point_paths),
        *clip_items(first, window),
        *arrows.items,
    ]
    items += [
        *machine_items.make_labels(posed_machine, 0),
        *rope_items.make_labels(posed_machine, 0),
        *_label_instants(posed_machine),
        *traces.make_labels(posed_machine, point_paths),
    ]
    strip = STRIP_HEIGHT * window.side
    items += _draw_axes(posed_machine, window, strip)
    step = 0.035 * window.side
    key_x = window.low[0] + (0.30 if not posed_machine.view.is_axis_aligned else 0.06) * window.side
    items += draw_key(loads, arrows.scale, key_x, window.low[1] - 0.35 * strip, step, units)
    unit = units.find("m")[0]
    x_name, y_name = posed_machine.view.format_axes()
    low, high = window.low - (0.0, strip), window.high
    x_axis, y_axis = Scaling(f"{x_name} [{unit}]", low[0], high[0]), Scaling(f"{y_name} [{unit}]", low[1], high[1])
    panel = Panel(x_axis, y_axis, tuple(items), HEIGHT, has_equal_scales=True, title=name, is_layered=True)
    return Figure(
        posed_machine.spec.title,
        _describe_view(posed_machine),
        [panel],
        (),
        [*_make_notes(posed_machine, loads), *arrows.notes, *window.notes],
    )


def _draw_first_instant(posed_machine: PosedMachine) -> list[Item]:
    """Draw the first instant."""
    items = [*machine_items.draw_bodies(posed_machine, 0), *machine_items.draw_mass_marks(posed_machine, 0)]
    items += [
        item for line in posed_machine.machine.lines for item in machine_items.draw_force_line(posed_machine, line, 0)
    ]
    items += rope_items.draw_ropes(posed_machine, 0)
    items += machine_items.draw_belt_strands(posed_machine, 0)
    items += machine_items.draw_joint_actions(posed_machine, 0)
    return [*items, *machine_items.draw_joints(posed_machine, 0), *rope_items.draw_marks(posed_machine, 0)]


def _draw_later_instant(posed_machine: PosedMachine, k: int) -> list[Item]:
    """Draw a later instant in thin lines."""
    items = machine_items.draw_bodies(posed_machine, k, thin=True)
    items += [
        item
        for line in posed_machine.machine.lines
        for item in machine_items.draw_force_line(posed_machine, line, k, thin=True)
    ]
    items += rope_items.draw_ropes(posed_machine, k, thin=True)
    return items + machine_items.draw_joints(posed_machine, k, thin=True)


def _label_instants(posed_machine: PosedMachine) -> Iterator[PlaceLabel]:
    """Label the instants at the body that has moved most since the first."""
    if len(posed_machine.poses.times) < 2:
        return
    places_of_body = {
        body.name: np.array(
            [
                posed_machine.project(body.name, posed_machine.centers[body.name], k)
                for k in range(len(posed_machine.poses.times))
            ]
        )
        for body in posed_machine.machine.bodies
    }
    most_moved = max(
        places_of_body, key=lambda name: (float(np.abs(places_of_body[name] - places_of_body[name][0]).max()), name)
    )
    for t, (x, y) in zip(posed_machine.poses.times.tolist(), places_of_body[most_moved].tolist(), strict=True):
        text = f"{format_short(t)} s"
        yield PlaceLabel(x, y, text, text, LATER_PEN)


def _draw_axes(posed_machine: PosedMachine, window: Window, strip: float) -> Iterator[Item]:
    """Draw the world's axes if they are not those of the figure, and gravity if it is visible."""
    length = AXES_LENGTH * window.side
    x, y = float(window.low[0]) + 1.6 * length, float(window.low[1]) - 0.5 * strip
    if not posed_machine.view.is_axis_aligned:
        for name, axis in zip("xyz", np.eye(3), strict=True):
            a, b = (length * posed_machine.view.project(axis)).tolist()
            yield Arrow(x, y, a, b, None, name)
    gravity = posed_machine.view.project(np.array(posed_machine.spec.gravity))
    size = float(np.linalg.norm(posed_machine.spec.gravity))
    if size > 0.0 and float(np.hypot(*gravity)) > 0.2 * size:
        a, b = (1.4 * length * gravity / size).tolist()
        yield Arrow(float(window.high[0]) - 1.2 * length, float(window.low[1]) - 0.1 * strip, a, b, LATER_PEN, "g")


def _describe_view(posed_machine: PosedMachine) -> list[str]:
    """Describe the instants and the view."""
    times = [format_short(t) for t in posed_machine.poses.times.tolist()]
    times_text = f"t = {times[0]} s" + (f"; thin lines: t = {', '.join(times[1:])} s" if len(times) > 1 else "")
    return [f"{times_text}; seen from {posed_machine.view.description}"]


def _make_notes(posed_machine: PosedMachine, loads: ActingLoads) -> list[str]:
    """Return notes on what is not drawn, and on what no symbol shows."""
    notes = []
    if not posed_machine.has_names:
        bodies, joints = len(posed_machine.machine.bodies), len(posed_machine.machine.joints)
        notes.append(f"names not shown: too many bodies ({bodies}) and joints ({joints})")
    if loads.indeterminate:
        notes.append(f"open, not drawn: forces and moments of {', '.join(loads.indeterminate)}")
    spread = [
        body.name for body in posed_machine.machine.bodies if body.is_ellipsoid and posed_machine.solids[body.name]
    ]
    if spread:
        notes.append(f"drawn as the ellipsoid of the same inertia: {', '.join(spread)}")
    forces = posed_machine.spec.forces.items()
    acting = [f"{n} ({LOAD_KINDS[f.type].display_name} on {f.joint})" for n, f in forces if isinstance(f, JointForce)]
    acting += [f"{n} (drive of {drive.joint})" for n, drive in posed_machine.spec.drives.items()]
    if acting and posed_machine.has_names:
        notes.append(f"acting in joints: {', '.join(acting)}")
    return notes
