"""What is integrated: which scene, whether anything at all, and in which segments of time.

The scene is the given one, or a reduced one with the same motion (multibody/reduction/). A motion follows from the
drives alone where these and the closed chains leave no freedom: then it is solved instant by instant instead of
integrated. Within a segment no load or drive is discontinuous in time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.reduction.compose import ReducedScene
from heuncli.multibody.response import Workspace
from heuncli.multibody.tree.layout import Layout, find_speed_rows
from heuncli.results.results import Array, Block
from heuncli.scene.expressions.discontinuities import find_run_discontinuities

# Integrated scene

EMBEDDED_AT_ONCE = 65_536  # instants; whole blocks of those that BLAS multiplies together


@record
class IntegratedScene:
    """The scene whose motion is integrated, its work arrays, and the maps between its states and those of the full
    scene.

    embed: maps instants (n_t,) and reduced states (n_t, n') to full states (n_t, n)
    restrict: maps an instant and a full state (n,) to a reduced state
    """

    layout: Layout
    workspace: Workspace
    embed: Callable[[Array, Array], Array]
    restrict: Callable[[float, Array], Array]

    def embed_run(self, times: Array, states: Array) -> Array:
        """Map the reduced states of a whole run to full states, (n_t, n), in parts, because a reduction's map makes
        copies.
        """
        if len(times) <= EMBEDDED_AT_ONCE or self.embed is keep_states:
            return self.embed(times, states)
        first = self.embed(times[:EMBEDDED_AT_ONCE], states[:EMBEDDED_AT_ONCE])
        full_states = np.empty((len(times), first.shape[1]))
        full_states[:EMBEDDED_AT_ONCE] = first
        for begin in range(EMBEDDED_AT_ONCE, len(times), EMBEDDED_AT_ONCE):
            part = slice(begin, begin + EMBEDDED_AT_ONCE)
            full_states[part] = self.embed(times[part], states[part])
        return full_states

    def embed_state(self, t: float, state: Array) -> Array:
        """Return the full state of one reduced state."""
        full_state: Array = self.embed(np.array([t]), state[None, :])[0]
        return full_state

    def find_contact(self, row: int) -> int:
        """Return the number of the contact that a closure row of the integrated scene belongs to."""
        return next(i for i, contact in enumerate(self.layout.contacts) if contact.row == row)

    def find_rope(self, row: int) -> str:
        """Return the name of the rope that a closure row of the integrated scene belongs to."""
        return self.layout.mechanism.owner_path(self.layout.rows[row]).partition(".")[2]


def keep_states(times: Array, states: Array) -> Array:
    """Return the states of a scene that is integrated itself; times: unused."""
    return states


def integrate_itself(scene: Evaluator) -> IntegratedScene:
    """Integrate the scene without any reduction."""
    return IntegratedScene(scene.layout, scene.workspace, keep_states, lambda t, state: state)


def integrate_reduced(scene: Evaluator, reduction: ReducedScene) -> IntegratedScene:
    """Integrate a reduced scene, ready to run, in place of the one it was made from."""
    return IntegratedScene(scene.layout, scene.workspace, reduction.embed, reduction.restrict)


# Determined motion

BY_DRIVES = "motion fully prescribed: solved at each instant, nothing integrated"
BY_JOINTS = "nothing can move: the joints leave 0 degrees of freedom, nothing integrated"
SINGULAR = "integrated despite 0 degrees of freedom: the motion passes a singular position, such as a dead centre"
CONTACTS = "integrated despite 0 degrees of freedom: a contact may open or a rope slacken"
ROLLS = "integrated despite 0 degrees of freedom: rolling determines speeds at each instant, not positions"


@record
class DeterminedMotion:
    """The decision whether every instant follows from the drives.

    notes: sentences that state this, or explain why not where a reader might expect it
    """

    is_determined: bool
    notes: tuple[str, ...]

    def add_to_block(self, block: Block) -> Block:
        """Add the notes to the block `model`, next to those on reductions that were made or not made."""
        key = "reduced" if self.is_determined else "not_reduced"
        return block | ({key: [*block.get(key, ()), *self.notes]} if self.notes else {})


NOT_DETERMINED = DeterminedMotion(False, ())


def find_determined_motion(integrated_scene: IntegratedScene) -> DeterminedMotion:
    """Decide whether the motion can be followed from its start without integration.

    Redundantly closed chains may leave no freedom either. A singular start leaves one, so such a motion is integrated.
    """
    layout = integrated_scene.layout
    free = layout.tree_freedoms
    if free > len(layout.rows):
        return NOT_DETERMINED
    freedoms_left = free - integrated_scene.workspace.count_independent_rows(0.0, layout.y0) if layout.rows else free
    if freedoms_left:
        return NOT_DETERMINED
    if len(layout.tables["contacts"]):
        return DeterminedMotion(False, (CONTACTS,))
    if find_speed_rows(layout).any():
        return DeterminedMotion(False, (ROLLS,))
    return DeterminedMotion(True, (BY_DRIVES if layout.has_laws else BY_JOINTS,))


def note_fallback_to_integration(model: Block) -> Block:
    """Correct the block `model` after a motion could not be followed to its end and was integrated."""
    sentences = [sentence for sentence in model.get("reduced", ()) if sentence not in (BY_DRIVES, BY_JOINTS)]
    return {"reduced": sentences, "not_reduced": [*model.get("not_reduced", ()), SINGULAR]}


# Segments


class Segment(NamedTuple):
    """A part of a run without discontinuities: its begin, the last instant before its end, and its end."""

    begin: float
    before_end: float
    end: float


@record
class Segments:
    """The segments of a run, (n, 3): begin, before_end, end.

    They stay one array because a table given point by point makes a million of them.
    """

    rows: Array

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Segment]:
        return (Segment(*map(float, row)) for row in self.rows)

    @cached_property
    def ends(self) -> Array:
        """End of each segment, (n,)."""
        return self.rows[:, 2].copy()

    def find_segment(self, t: float) -> Segment:
        """Return the segment that contains an instant; at an end, the following one."""
        return Segment(*map(float, self.rows[np.searchsorted(self.ends, t, side="right")]))


NO_SEGMENTS = Segments(np.zeros((0, 3)))


def make_segments(last: float, jumps: Sequence[float]) -> Segments:
    """Split (0, last) into segments without discontinuities, which are at `jumps`.

    Each segment ends with the left limits of what jumps; the next one begins with the right limits.
    """
    if not len(jumps):
        return Segments(np.array([[0.0, just_before(last), last]]))
    instants = np.asarray(jumps, dtype=float)
    left, right = find_one_sided_limits(instants[(instants > 0.0) & (instants < last)])
    begins, ends = np.append(0.0, right), np.append(left, just_before(last))
    segments = np.column_stack([begins, ends, np.nextafter(ends, np.inf)])
    # a discontinuity at t = 0 makes a first segment without length
    non_empty = segments[ends > begins] if (ends > begins).any() else segments[-1:]
    # where a discontinuity is the double before the last instant, no segment follows it
    non_empty[-1, 2] = max(non_empty[-1, 2], last)
    return Segments(non_empty)


def find_one_sided_limits(jumps: Sequence[float] | Array) -> tuple[Array, Array]:
    """Return the last instants before discontinuities, ascending, and the first after them, as `pair_adjacent_instants`
    does.
    """
    instants = np.asarray(jumps, dtype=float)
    before = np.nextafter(instants, -np.inf)
    # neighbouring doubles are one discontinuity
    is_separate = np.append(True, instants[:-1] < before[1:])[: len(instants)]
    return before[is_separate], instants[np.append(is_separate[1:], True)[: len(instants)]]


def just_before(t: float) -> float:
    """Return the last instant before t, where the left limit at a jump is taken."""
    return math.nextafter(t, -math.inf)


def just_after(t: float) -> float:
    """Return the first instant after t."""
    return math.nextafter(t, math.inf)


def find_discontinuities(mechanism: Mechanism, last: float) -> list[float]:
    """Find the instants in (0, last] of impulses at a given time, and where a load, a drive or a derivative is
    discontinuous.

    For a discontinuity at the end of the run, the instants after it are included, up to the first one at which the new
    branch holds.
    """
    expressions = set(mechanism.iter_expressions())
    blows = {blow.time for blow in mechanism.impulses if blow.when is None and 0.0 < blow.time < last}
    return sorted({t for e in expressions if e.time_dependent for t in find_run_discontinuities(e, last)} | blows)
