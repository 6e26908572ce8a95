"""The kernel's stepping loop with the arrays that it writes to, and the codes by which it ends."""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.kernel.choose import integration
from heuncli.kernel.choose import steps as kernel
from heuncli.motion.integration.methods.method import Method
from heuncli.multibody.mechanism.model import BushingLoad, JointLoad, Load, ThreadLoad
from heuncli.multibody.response import Workspace
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

REACHED, MORE, ROPE_SLACK, CHATTERING, STRUCK, LET_GO, TURNED, STIFF, HALF_TURN = (
    kernel.CODES[name]
    for name in ["reached", "more", "rope slack", "chattering", "struck", "let go", "turned", "stiff", "half turn"]
)
GOES_ON = (MORE, STRUCK, LET_GO, TURNED, STIFF)
UNSOLVED = kernel.CODES["unsolved"]
STIFF_AFTER = 15  # steps held short by stability, as in Hairer's DOP853 ...
EASY_AFTER = 6  # ... and steps on end that were not, after which their count begins anew
LOOK_AFTER = 1_000  # steps; then each time that they have doubled
UNWATCHED = {"stiff_after": 0, "easy_after": 0, "look_after": 0, "stable": 0.0}
# What is put down of each step: its end [s], whether its stages were settled on the closures, the least pivot of these,
# whether branches turned at its end.
PER_STEP = ("ends", "settled", "pivots", "turned")
SPAN = 3  # numbers beside a polynomial: whether it was left, begin and length of its step [s]


@record
class Start:
    """What a run sets out from, and what its steps are judged by.

    local: the tolerance of a step, or of a method of given steps their length; rate [1/s]: slower ones are judged as if
    that fast. following: its steps are given by their ends, and none is judged; late: events are met late by rounding,
    to see what that makes of the run; watched: it is noticed where stability holds its steps short.
    """

    state: Array
    local: float
    rate: float = 0.0
    following: bool = False
    late: bool = False
    watched: bool = False


class KernelLoop:
    """The kernel's loop over the asked instants, at most `most` steps at a time, with the arrays it writes to."""

    def __init__(
        self, layout: Layout, workspace: Workspace, method: Method, times: Array, most: int, start: Start,
        *, keeping: bool = False,
    ) -> None:  # fmt: skip
        """keeping: the polynomials of steps that make one are put down."""
        if method.foreign:
            raise ValueError(f"the kernel has no stages of {method.name}")
        n = self.n = layout.n_state
        self.method, self.start = method, start
        self.width = integration.record_width(workspace, n)
        self.most, self.per_step = most, np.zeros((len(PER_STEP), most))
        self.held = layout.pack.held
        self.branches = np.zeros(most * self.held)
        self.passed = np.empty(0 if start.following else most * self.width)
        self.count = len(times)
        self.samples = np.zeros(self.count * n)
        self.keeping = keeping
        self.spans = np.empty(SPAN * most if keeping else 0)
        self.courses = np.empty((4 + method.arrays["dense_rows"]) * n * most if keeping else 0)
        output = {
            "times": flat(times), "samples": self.samples, "passed": self.passed, "branches": self.branches,
            "spans": self.spans, "courses": self.courses,
        }  # fmt: skip
        output.update(zip(PER_STEP, self.per_step, strict=True))
        self.loop = integration.Integration(workspace, method.arrays, begin_with(start, method, layout), output)

    def put_down(self) -> Array:
        """What PER_STEP names of the steps just done, (count, 4); a view."""
        return self.per_step[:, : self.loop.done].T

    def records(self, every: int, offset: int) -> Array:
        """What the steps after those just done start from: of every so many, (count, width); a view."""
        done = self.loop.done
        return self.passed[: done * self.width].reshape(done, self.width)[offset::every]

    def keep_no_more(self) -> None:
        """Put down no polynomials any more."""
        self.keeping = False
        self.loop.keep_no_more()

    def put_down_courses(self) -> tuple[Array, Array]:
        """What the steps just done left of their polynomials, (count, .) each: where they hold, and their numbers."""
        done = self.loop.done
        return self.spans.reshape(self.most, -1)[:done], self.courses.reshape(self.most, -1)[:done]

    def held_branches(self) -> Array:
        """The branches that the steps just done held, (count, n); a view."""
        return self.branches[: self.loop.done * self.held].reshape(-1, self.held)

    def states(self) -> Array:
        """The states at the asked instants, (n_t, n)."""
        self.loop.fetch()
        return self.samples.reshape(self.count, self.n)


def flat(numbers: Array) -> array[float]:
    """Numbers one after the other, as the kernel's loop copies them fastest."""
    return array("d", np.asarray(numbers, dtype=float).tobytes())


def begin_with(start: Start, method: Method, layout: Layout) -> dict[str, Any]:
    """A start as the kernel's loop takes it (kernel/integration.py): its tolerance, or the step in its place."""
    return {
        "groups": layout.tables["groups"],
        "energy_group": layout.energy_group,
        "weights": flat(layout.weights),
        "state": flat(start.state),
        "tolerance": 1.0 if method.fixed else start.local,
        "step": start.local if method.fixed else 0.0,
        "rate": start.rate,
        "following": int(start.following),
        "late": int(start.late),
        **(stiffness_of(method, layout) if start.watched else UNWATCHED),
    }


def stiffness_of(method: Method, layout: Layout) -> dict[str, float]:
    """By what the kernel's loop notices stiffness (kernel/stiffness.py); an implicit method is not held by it."""
    if method.stable == 0.0:
        return UNWATCHED
    look = LOOK_AFTER if any(depends(load) for load in layout.mechanism.loads) else 0
    stable = tolerances.STIFF * method.stable
    return {"stiff_after": STIFF_AFTER, "easy_after": EASY_AFTER, "look_after": look, "stable": stable}


def depends(load: Load) -> bool:
    """Whether a load depends on where bodies are, or how fast: a spring, damper, friction, or by its expression."""
    resists = isinstance(load, BushingLoad | ThreadLoad) or (isinstance(load, JointLoad) and load.kind == "friction")
    return resists or not load.values or any(value.uses for value in load.values)
