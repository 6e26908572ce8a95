"""Search along cuts: extremes over the length of a series of cuts, and instants at which a joint passes a cut.

For a search, the series of cuts of a scene are replaced by stretches with corners (loads/kinetostatics/stretch.py). The
highest and the lowest of each quantity along a stretch are then two numbers over the instants, smooth but for kinks
where their place leaps, which are never extremes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.actions import list_whole_joint_actions
from heuncli.loads.kinetostatics.couplings import list_coupling_actions
from heuncli.loads.kinetostatics.cut_planes import list_attachments, list_distributed_loads
from heuncli.loads.kinetostatics.cuts import Cuts, PlaceableCuts
from heuncli.loads.kinetostatics.stretch import DEGREE, Stretch, StretchPeaks, find_peaks, make_cuts_at, make_stretch
from heuncli.results.results import BEFORE, BEYOND, SIDE_SIGNS, Array, Block, CutPosition, Extremes
from heuncli.results.results_schema import RESULTANTS
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.setup import Setup
from heuncli.study.search.grid import sort_distinct

SIGN_CHANGE_HALVINGS = (
    2  # halvings of pieces whose loads change their sign: stresses and reduction lines have kinks there
)


def replace_series_by_stretches(setup: Setup, is_nonlinear: bool) -> Setup:
    """Return the setup with its series of cuts replaced by stretches.

    is_nonlinear: whether they are for quantities that are no polynomial of the loads
    """
    mechanism, halved = setup.scene.mechanism, SIGN_CHANGE_HALVINGS if is_nonlinear else 0

    def make_whole(cuts: Cuts) -> PlaceableCuts:
        """Return a series of cuts through shapes as a stretch, all others as they are."""
        if cuts.s is None or cuts.form is None:
            return cuts
        points = [attachment.place for attachment in list_attachments(mechanism, cuts.body)]
        lines = [line.place for line in list_distributed_loads(mechanism, cuts.body)]
        return make_stretch(cuts, points, lines, min_halvings=halved)

    return replace(setup, cuts=tuple(map(make_whole, setup.cuts)))


def find_stretch(setup: Setup, name: str) -> Stretch:
    """Return the stretch of the series of cuts with that name."""
    placeable_cuts: tuple[PlaceableCuts, ...] = setup.cuts
    return next(cuts for cuts in placeable_cuts if isinstance(cuts, Stretch) and cuts.name == name)


def cut_at(setup: Setup, name: str, s: Array, ends: tuple[float, float]) -> Setup:
    """Return the setup with a stretch as cuts at distances (k,) [m] between the ends of one of its pieces."""
    return replace(setup, cuts=(make_cuts_at(find_stretch(setup, name).cuts, s, find_sides(s, ends)),))


def cut_at_places(setup: Setup, name: str, places: Sequence[CutPosition]) -> Setup:
    """Return the setup with only one series of cuts, cut at these places, on the sides that they name."""
    series = next(cuts for cuts in setup.cuts if cuts.name == name)
    side = np.array([SIDE_SIGNS[place.side] for place in places])
    return replace(setup, cuts=(make_cuts_at(series, np.array([place.s for place in places]), side),))


def find_sides(s: Array, ends: tuple[float, float]) -> Array:
    """Return on which side of what acts at the ends of a piece cuts there lie."""
    return np.where(s <= ends[0], BEYOND, np.where(s >= ends[1], BEFORE, 0.0))


def compute_envelope(values: Array) -> Array:
    """Return the lowest and the highest along a stretch, (n_t, 2), from the values at its nodes, (n_t, 9 m)."""
    low, high = find_peaks(values)
    return np.stack([-low.height, high.height], axis=1)


def find_impulse_extremes(setup: Setup, impulse: Block) -> dict[str, Extremes]:
    """Find the extremes of the section forces along each stretch at an impulse, which was solved with these cuts."""
    found: dict[str, Extremes] = {}
    for cuts in setup.cuts:
        if isinstance(cuts, Stretch):
            section = impulse["sections"][cuts.name]
            summits_of_quantities = [find_cut_extremes(cuts, section["s"], section[name]) for name in RESULTANTS]
            low, high = (np.array([one[side].value for one in summits_of_quantities]) for side in (0, 1))
            times, column = (
                np.full(len(summits_of_quantities), float(impulse["time"])),
                np.zeros(len(summits_of_quantities), dtype=np.intp),
            )
            places = tuple((low.place, high.place) for low, high in summits_of_quantities)
            paths = tuple(f"sections.{cuts.name}.{name}" for name in RESULTANTS)
            found[cuts.name] = Extremes(low, times, column, high, times, column, True, True, places, paths)
    return found


class CutExtreme(NamedTuple):
    """An extreme along a series of cuts, and its place."""

    value: float
    place: CutPosition


def find_cut_extremes(stretch: Stretch, s: Array, values: Array) -> tuple[CutExtreme, CutExtreme]:
    """Return the lowest and the highest value along a series of cuts, from the values (9 m,) at the nodes s of its m
    pieces.
    """
    low, high = find_peaks(values[None])
    peaks = [locate_peak(s, peak) for peak in (low, high)]
    places = [stretch.make_place(peak.s, peak.side) for peak in peaks]
    return CutExtreme(-float(low.height[0]) + 0.0, places[0]), CutExtreme(float(high.height[0]) + 0.0, places[1])


class SeriesPeak(NamedTuple):
    """The place of a peak along a series of cuts.

    s: position [m]
    side: whether the place is just before or just beyond what acts there: BEFORE, BEYOND; 0 inside of a piece
    piece: positions of both ends of the smooth piece that it lies on
    """

    s: float
    side: float
    piece: tuple[float, float]


def locate_summit(s: Array, values: Array, side: float) -> SeriesPeak:
    """Locate the highest (side 1) or the lowest (-1) of values at nodes s, (9 m,)."""
    return locate_peak(s, find_peaks(values[None])[side > 0.0])


def locate_peak(s: Array, top: StretchPeaks) -> SeriesPeak:
    """Locate a peak of one instant along pieces with nodes s."""
    k, x = int(top.piece[0]) * (DEGREE + 1), float(top.position[0])
    a, b = float(s[k]), float(s[k + DEGREE])
    if x in (-1.0, 1.0):
        return SeriesPeak(b, BEFORE, (a, b)) if x > 0.0 else SeriesPeak(a, BEYOND, (a, b))
    return SeriesPeak(a + 0.5 * (b - a) * (x + 1.0), 0.0, (a, b))


PARTS = 16  # a span with a passage is divided into so many
ROUNDS = 14  # divisions in turn: 16^14 parts are neighbouring doubles


def has_moving_joints(setup: Setup) -> bool:
    """Return whether any joint moves over a body that has a single cut; series of cuts are searched with the moving
    joint.
    """
    cut = {cuts.body for cuts in setup.cuts if cuts.s is None}
    return any(joint.a in cut and JOINTS[joint.kind].has_moving_contact for joint in setup.scene.mechanism.joints)


def find_passages(recover: Callable[[Array], Recovery], grid: Array) -> Array:
    """Return the last instants before passages and the first after them, as far as a grid shows them, ascending."""
    is_on_piece = find_points_on_pieces(recover(grid))
    k, j = np.nonzero(np.diff(is_on_piece, axis=0))
    a, b = grid[k], grid[k + 1]
    before_passage = is_on_piece[k, j]
    rows = np.arange(len(k))
    for _ in range(ROUNDS if len(k) else 0):
        probes = a[:, None] + (b - a)[:, None] * (np.arange(PARTS + 1) / PARTS)
        probes[:, -1] = b
        instants = sort_distinct(probes)
        probe_values = find_points_on_pieces(recover(instants))[np.searchsorted(instants, probes), j[:, None]]
        first = np.argmax(probe_values != before_passage[:, None], axis=1)
        a, b = probes[rows, np.maximum(first - 1, 0)], probes[rows, first]
        if (b - a <= 2.0 * tolerances.EPS * np.abs(b)).all():
            break
    return np.sort(np.concatenate([a, b]))


def find_points_on_pieces(recovery: Recovery) -> Array:
    """Return 1 where a point that moves over a body lies on the piece of a single cut of it, else 0, (n_t, m)."""
    from heuncli.loads.kinetostatics.piece_loads import find_attachments, mark_points_on_pieces

    actions = [
        *list_whole_joint_actions(recovery.joints),
        *recovery.applied_actions,
        *list_coupling_actions(recovery.couplings),
    ]
    columns = [
        mark_points_on_pieces(cuts, a.point)[:, 0]
        for cuts in recovery.setup.cuts
        if cuts.s is None
        for a in find_attachments(cuts.body, recovery.states, actions)
        if a.point.ndim == 2
    ]
    return np.stack(columns, axis=1) if columns else np.zeros((len(recovery.states.x), 0))
