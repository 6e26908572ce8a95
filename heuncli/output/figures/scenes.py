"""Figures of the machine at instants of its run in a view: poses, supports, acting loads, paths of points.

The first instant is drawn with the loads that act, by default that of the greatest joint force; later ones are thin,
pale lines. None are drawn beyond the horizon. Axes, scale and arrows are explained below the machine. The paths of
named points are thin curves.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.coupled_start.prepare_coupled import prepare_coupled
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.output.drawing.axes import format_short
from heuncli.output.drawing.figure import Arrow, Figure, Item, KeyArrow, Panel, PlaceLabel, Scaling, SpaceKey, Trace
from heuncli.output.figures import machine_items
from heuncli.output.figures.acting_loads import NO_LOADS, ActingLoads, collect_loads
from heuncli.output.figures.courses import FigureSource, choose_instants, require_claimed
from heuncli.output.figures.load_arrows import draw_loads, iter_key_arrows, label_loads, round_down, scale_loads
from heuncli.output.figures.posed_machine import PosedMachine, describe_instants, find_worst_instant, to_pair
from heuncli.output.figures.scene_labels import choose_labels, label_instants, make_machine_labels, make_mark_labels
from heuncli.output.figures.windows import Window, choose_window, clip_items
from heuncli.output.machine_geometry.machine import Machine, make_machine
from heuncli.output.machine_geometry.poses import Poses, compute_poses, make_start_poses
from heuncli.output.machine_geometry.solids import ROUND_FACES
from heuncli.output.machine_geometry.views import choose_view, parse_view
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.setup import build_with_cuts
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.labels import Labels, make_labels
from heuncli.study.quantities.table_units import Units, choose_prefix

HEIGHT = 560.0  # pixels, maximum
N_SMOOTH_FACES, MAX_SMOOTH_BODIES = 60, 40  # faces about an axis, and up to how many bodies
MIN_VISIBLE_GRAVITY = 0.2  # visible part of gravity, with less it is not shown
SCALE_SHARE = 0.25  # of the figure's width: the scale bar is not longer
MAX_LISTED = 6  # names in a note
CENTER = "center"  # the centre of mass, unless the spec has a point of that name
MAX_REPORTED = 8  # paths of points that the spec reports
SAME_PATH = 1e-6  # of a path's size: closer paths are drawn once


def make_scene_figure(
    source: FigureSource,
    units: Units,
    given_times: Array | None = None,
    view: str | None = None,
    point_names: Sequence[str] = (),
) -> Figure:
    """Make the figure of one run at some instants.

    given_times (n,): ascending; by default that of the greatest joint force
    point_names: points whose paths are drawn, `body.point`; `center` is the centre of mass unless a point has that name

    Raises Finding for an unknown view, NotDrawable for a run of which nothing is claimed.
    """
    study = source.study
    require_claimed(study)
    worst = find_worst_instant(study) if given_times is None else None
    times = np.array([worst.time]) if worst is not None else np.asarray(given_times)
    poses = compute_poses(study, times)
    posed_machine = pose_machine(study.setup.scene, study.spec, poses, view, units)
    point_paths = make_paths(source, point_names) if point_names else make_reported_paths(source)
    loads = collect_loads(study, posed_machine.machine, poses)
    figure = make_machine_figure(
        posed_machine, units, point_paths, loads, source.name, has_point_names=bool(point_names)
    )
    return figure._replace(words=[describe_instants(posed_machine, worst, units)])


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
        lines = [surface.corners for surface in body.surfaces] + list(body.strokes)
        points += [place for part in lines for place in poses.locate_points(body.name, part, 0)]
    points += [place for path in machine.paths for place in path]
    points += [poses.locate_points(j.b, j.q, 0) for j in machine.joints] + [
        poses.locate_points(j.a, j.p, 0) for j in machine.joints
    ]
    return np.array(points)


def make_machine_figure(
    posed_machine: PosedMachine,
    units: Units,
    point_paths: Sequence[PointPath],
    loads: ActingLoads,
    name: str = "",
    *,
    has_point_names: bool = False,
) -> Figure:
    """Make the figure of the machine with the paths of some points and the loads at the first instant.

    has_point_names: whether the paths have labels
    """
    first = _draw_first_instant(posed_machine, loads.names)
    n_instants = len(posed_machine.poses.times)
    later = [item for k in range(n_instants - 1, 0, -1) for item in _draw_later_instant(posed_machine, k)]
    machine_window = _choose_machine_window(posed_machine, point_paths)
    per_si, side = posed_machine.per_si, machine_window.side
    loads = loads.drop_slight_moments(side / per_si)
    drawing = scale_loads(loads, posed_machine.view, per_si, side)
    load_items = list(draw_loads(drawing, machine_window))
    arrows = [item for item in load_items if isinstance(item, Arrow)]
    window = machine_window.extend_to_arrows(arrows)
    labels = make_labels(posed_machine.spec)
    load_labels = list(label_loads(drawing, labels, units)) if posed_machine.has_names else []
    names = [
        *make_machine_labels(posed_machine, 0, labels, {label.letter for label in load_labels}),
        *make_mark_labels(posed_machine, 0),
        *(label_paths(posed_machine, point_paths, labels) if has_point_names else ()),
    ]
    place_labels, numbers = choose_labels(load_labels, names, side)
    items: list[Item] = [
        *clip_items(later, window),
        *draw_paths(posed_machine, point_paths),
        *clip_items(first, window),
        *load_items,
        *place_labels,
        *label_instants(posed_machine),
    ]
    key = _make_key(posed_machine, window, units, [*iter_key_arrows(drawing, arrows, units)], numbers)
    panel = _make_space_panel(posed_machine, window, units, items, name)._replace(key=key)
    notes = [*window.notes, *_make_notes(posed_machine, loads)]
    words = [describe_instants(posed_machine, None, units)]
    return Figure(posed_machine.spec.title, words, [panel], (), ["; ".join(notes)] if notes else [])


def _choose_machine_window(posed_machine: PosedMachine, point_paths: Sequence[PointPath]) -> Window:
    """Choose the window that shows the machine, its ropes and marks, and the paths of points."""
    paths = [project_path(posed_machine, point_path) for point_path in point_paths]
    ropes = [line.ends.reshape(-1, 2) for line in machine_items.draw_ropes(posed_machine, 0)]
    return choose_window(posed_machine, [*paths, *ropes, *machine_items.iter_mark_places(posed_machine)])


def _make_space_panel(
    posed_machine: PosedMachine, window: Window, units: Units, items: Sequence[Item], title: str
) -> Panel:
    """Make a panel with equal scales of both directions of the view, and without axes."""
    unit = units.find("m")[0]
    x, y = (
        Scaling(f"{axis} [{unit}]", low, high)
        for axis, low, high in zip(
            posed_machine.view.format_axes(), window.low.tolist(), window.high.tolist(), strict=True
        )
    )
    return Panel(x, y, tuple(items), HEIGHT, has_equal_scales=True, is_bare=True, title=title, is_layered=True)


def _draw_first_instant(posed_machine: PosedMachine, drawn_names: Collection[str]) -> list[Item]:
    """Draw the first instant; drawn_names: of loads that have an arrow."""
    items = [*machine_items.draw_bodies(posed_machine, 0), *machine_items.draw_mass_marks(posed_machine, 0)]
    items += [
        item for line in posed_machine.machine.lines for item in machine_items.draw_force_line(posed_machine, line, 0)
    ]
    items += machine_items.draw_ropes(posed_machine, 0)
    items += machine_items.draw_belt_strands(posed_machine, 0)
    items += machine_items.draw_joint_actions(posed_machine, 0, drawn_names)
    return [*items, *machine_items.draw_joints(posed_machine, 0), *machine_items.draw_marks(posed_machine, 0)]


def _draw_later_instant(posed_machine: PosedMachine, k: int) -> list[Item]:
    """Draw a later instant in thin, pale lines."""
    items = machine_items.draw_bodies(posed_machine, k)
    items += [
        item for line in posed_machine.machine.lines for item in machine_items.draw_force_line(posed_machine, line, k)
    ]
    items += machine_items.draw_ropes(posed_machine, k)
    return items + machine_items.draw_joints(posed_machine, k)


def _make_key(
    posed_machine: PosedMachine,
    window: Window,
    units: Units,
    arrows: Sequence[KeyArrow],
    numbers: tuple[tuple[str, str], ...],
) -> SpaceKey:
    """Make the key of a view: the world's axes, gravity if it is visible, a scale bar, the arrows of loads."""
    view = posed_machine.view
    axes = [(name, *to_pair(view.project(axis))) for name, axis in zip("xyz", np.eye(3), strict=True)]
    acceleration = np.array(posed_machine.spec.gravity)
    size = float(np.linalg.norm(acceleration))
    gravity = view.project(acceleration / size) if size > 0.0 else np.zeros(2)
    is_visible = float(np.hypot(*gravity)) > MIN_VISIBLE_GRAVITY
    length = round_down(2.0 * SCALE_SHARE * float(window.high[0] - window.low[0]))
    unit, per_metre = choose_prefix("m", length / posed_machine.per_si)
    if units.is_chosen("m"):
        unit, per_metre = units.find("m")
    words = f"{format_short(length / posed_machine.per_si * per_metre)} {unit}"
    return SpaceKey(tuple(axes), to_pair(gravity) if is_visible else None, (length, words), tuple(arrows), numbers)


def _make_notes(posed_machine: PosedMachine, loads: ActingLoads) -> Iterator[str]:
    """Yield notes on what is not drawn."""
    if not posed_machine.has_names:
        bodies, joints = len(posed_machine.machine.bodies), len(posed_machine.machine.joints)
        yield f"names not shown: too many bodies ({bodies}) and joints ({joints})"
    labels = make_labels(posed_machine.spec)
    if loads.indeterminate:
        yield f"indeterminate, without arrows: {_list_names('joints', loads.indeterminate, labels)}"
    acting = [own.name for own in posed_machine.machine.joint_symbols if own.name not in loads.names]
    if acting and posed_machine.has_names:
        yield f"acting in joints: {_list_names('forces', acting, labels)}"


def _list_names(kind: str, names: Sequence[str], labels: Labels) -> str:
    """List names, of many the first ones."""
    listed = ", ".join(describe_object(kind, name, labels) for name in names[:MAX_LISTED])
    return listed if len(names) <= MAX_LISTED else f"{listed} and {len(names) - MAX_LISTED} more"


class PointPath(NamedTuple):
    """A named point and its positions over the run, (n, 3), world axes."""

    name: str
    body: str
    positions: Array


def make_paths(source: FigureSource, names: Sequence[str]) -> list[PointPath]:
    """Make the paths of points, `body.point`, over the run up to its horizon."""
    study = source.study
    if not names or study.has_one_instant:
        return []
    poses = compute_poses(study, choose_instants(study))
    centers = {body.name: np.asarray(body.center) for body in study.setup.scene.mechanism.bodies}
    paths = []
    for name in names:
        body, _, point = name.partition(".")
        named_points = study.spec.bodies[body].points
        place = np.array(named_points[point]) if point in named_points else centers[body]
        paths.append(
            PointPath(name, body, np.array([poses.locate_points(body, place, k) for k in range(len(poses.times))]))
        )
    return paths


def make_reported_paths(source: FigureSource) -> list[PointPath]:
    """Make the paths of the points that the spec reports and that move: each path once, and of many the first ones."""
    spec = source.study.spec
    if "points" not in (spec.report.results or ()):
        return []
    paths: list[PointPath] = []
    for path in make_paths(
        source, [f"{body}.{point}" for body, body_spec in spec.bodies.items() for point in body_spec.points]
    ):
        size = float(np.ptp(path.positions, axis=0).max())
        if size > 0.0 and not any(
            np.allclose(path.positions, other.positions, rtol=0.0, atol=SAME_PATH * size) for other in paths
        ):
            paths.append(path)
    return paths[:MAX_REPORTED]


def project_path(posed_machine: PosedMachine, path: PointPath) -> Array:
    """Project a path to the view, (n, 2) in the unit of the figure."""
    return np.asarray(posed_machine.per_si * posed_machine.view.project(path.positions))


def draw_paths(posed_machine: PosedMachine, paths: Sequence[PointPath]) -> Iterator[Trace]:
    """Draw the paths."""
    for path in paths:
        x, y = project_path(posed_machine, path).T
        yield Trace(path.name, x, y, posed_machine.pens[path.body], is_thin=True)


def label_paths(posed_machine: PosedMachine, paths: Sequence[PointPath], labels: Labels) -> Iterator[PlaceLabel]:
    """Yield the labels of the points at the beginning of their paths."""
    for path in paths:
        point = path.name.partition(".")[2]
        text = describe_object("points", path.name, labels)
        if point == CENTER and point not in posed_machine.spec.bodies[path.body].points:
            text = f"{describe_object('bodies', path.body, labels)}, centre of mass"
        yield PlaceLabel(*to_pair(project_path(posed_machine, path)[0]), text, text, posed_machine.pens[path.body])
