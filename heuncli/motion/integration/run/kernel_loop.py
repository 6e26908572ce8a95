"""The kernel's stepping loop with the arrays that it writes to, and the codes with which it ends."""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.kernel.choose import integration
from heuncli.kernel.choose import steps as kernel
from heuncli.motion.integration.methods.method import Method
from heuncli.multibody.mechanism.loads import Load
from heuncli.multibody.response import Workspace
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

REACHED, MORE, ROPE_SLACK, CHATTERING, STRUCK, LET_GO, TURNED, STIFF, HALF_TURN = (
    kernel.CODES[name]
    for name in ["reached", "more", "rope slack", "chattering", "struck", "let go", "turned", "stiff", "half turn"]
)
CONTINUE_CODES = (MORE, STRUCK, LET_GO, TURNED, STIFF)
UNSOLVED = kernel.CODES["unsolved"]
STIFF_AFTER = 15  # steps limited by stability, as in Hairer's DOP853 ...
EASY_AFTER = 6  # ... and consecutive others, after which their count restarts
FIRST_LOOK = 1_000  # steps; then each time that they have doubled
NO_STIFFNESS_WATCH = {"stiff_after": 0, "easy_after": 0, "look_after": 0, "stable": 0.0}
# Recorded for each step: its end [s], whether its stages were projected onto the closures, their smallest pivot,
# whether branches changed at its end.
PER_STEP = ("ends", "settled", "pivots", "turned")
SPAN_WIDTH = 3  # numbers per polynomial: whether it is stored, begin and length of its step [s]


@record
class LoopStart:
    """The start of a run, and the scales of its error test.

    local: tolerance of a step, or the step of a method of fixed step
    rate [1/s]: slower rates are judged as if they were this fast
    is_replay: the ends of its steps are given, and no error is tested
    late: events are reached late by rounding, to see its effect on the run
    watch_stiffness: notice where stability limits the steps
    """

    state: Array
    local: float
    rate: float = 0.0
    is_replay: bool = False
    late: bool = False
    watch_stiffness: bool = False


class KernelLoop:
    """The kernel's loop over the requested instants, at most `max_steps` at a time, with the arrays it writes to."""

    def __init__(
        self, layout: Layout, workspace: Workspace, method: Method, times: Array, max_steps: int, start: LoopStart,
        *, stores_polynomials: bool = False,
    ) -> None:  # fmt: skip
        """stores_polynomials: store the polynomials of steps that make one"""
        if method.scipy_name:
            raise ValueError(f"the kernel has no stages of {method.name}")
        n = self.n = layout.n_state
        self.method, self.start = method, start
        self.record_width = integration.record_width(workspace, n)
        self.max_steps, self.per_step = max_steps, np.zeros((len(PER_STEP), max_steps))
        self.branch_count = layout.pack.branch_count
        self.branches = np.zeros(max_steps * self.branch_count)
        self.record_buffer = np.empty(0 if start.is_replay else max_steps * self.record_width)
        self.count = len(times)
        self.samples = np.zeros(self.count * n)
        self.stores_polynomials = stores_polynomials
        self.spans = np.empty(SPAN_WIDTH * max_steps if stores_polynomials else 0)
        self.polynomials = np.empty((4 + method.arrays["dense_rows"]) * n * max_steps if stores_polynomials else 0)
        output = {
            "times": to_double_array(times),
            "samples": self.samples,
            "passed": self.record_buffer,
            "branches": self.branches,
            "spans": self.spans,
            "courses": self.polynomials,
        }
        output.update(zip(PER_STEP, self.per_step, strict=True))
        self.loop = integration.Integration(workspace, method.arrays, make_loop_input(start, method, layout), output)

    def read_steps(self) -> Array:
        """Return the PER_STEP values of the last steps, (count, 4); a view."""
        return self.per_step[:, : self.loop.last_step_count].T

    def read_records(self, every: int, offset: int) -> Array:
        """Return the start records of the steps after the last ones, every so many, (count, width); a view."""
        done = self.loop.last_step_count
        return self.record_buffer[: done * self.record_width].reshape(done, self.record_width)[offset::every]

    def stop_storing_polynomials(self) -> None:
        """Stop storing polynomials."""
        self.stores_polynomials = False
        self.loop.stop_recording()

    def read_polynomials(self) -> tuple[Array, Array]:
        """Return the polynomials of the last steps, (count, .) each: where they hold, and their numbers."""
        done = self.loop.last_step_count
        return self.spans.reshape(self.max_steps, -1)[:done], self.polynomials.reshape(self.max_steps, -1)[:done]

    def read_branches(self) -> Array:
        """Return the branches that the last steps held, (count, n); a view."""
        return self.branches[: self.loop.last_step_count * self.branch_count].reshape(-1, self.branch_count)

    def read_states(self) -> Array:
        """Return the states at the requested instants, (n_t, n)."""
        self.loop.fetch()
        return self.samples.reshape(self.count, self.n)


def to_double_array(numbers: Array) -> array[float]:
    """Copy numbers into one array, as the kernel's loop reads them fastest."""
    return array("d", np.asarray(numbers, dtype=float).tobytes())


def make_loop_input(start: LoopStart, method: Method, layout: Layout) -> dict[str, Any]:
    """Return a start as input of the kernel's loop (kernel/integration.py): its tolerance, or the fixed step
    instead.
    """
    return {
        "groups": layout.tables["groups"],
        "energy_group": layout.energy_group,
        "weights": to_double_array(layout.weights),
        "state": to_double_array(start.state),
        "tolerance": 1.0 if method.has_fixed_step else start.local,
        "step": start.local if method.has_fixed_step else 0.0,
        "rate": start.rate,
        "following": int(start.is_replay),
        "late": int(start.late),
        **(make_stiffness_limits(method, layout) if start.watch_stiffness else NO_STIFFNESS_WATCH),
    }


def make_stiffness_limits(method: Method, layout: Layout) -> dict[str, float]:
    """Return the limits by which the kernel's loop notices stiffness (kernel/stages.py); none for implicit
    methods.
    """
    if method.stable == 0.0:
        return NO_STIFFNESS_WATCH
    first_look = FIRST_LOOK if any(depends_on_state(load) for load in layout.mechanism.loads) else 0
    stable = tolerances.STIFF * method.stable
    return {"stiff_after": STIFF_AFTER, "easy_after": EASY_AFTER, "look_after": first_look, "stable": stable}


def depends_on_state(load: Load) -> bool:
    """Return whether a load depends on positions or velocities: a spring, damper, friction, or by its expression."""
    return load.row.depends_on_state or any(value.uses for value in load.values)
