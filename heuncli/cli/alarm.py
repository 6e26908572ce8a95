"""The time limit of a command, over all that it does: from before its spec is read until its first byte goes out.

Loops that look at the clock say themselves how far they have come; this is the net under all others. An interval timer
of the system interrupts whatever is going on; what that was is told by the modules at work. Where there is no such
timer (Windows) the loops' own looks remain, and one at the end. Impure: the process's alarm, and the clock.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from types import FrameType
from typing import TypeVar

from heuncli.errors import LimitError, Problem

GRACE = 0.2  # seconds beyond the limit: the loops, which know more, speak first
REPEAT = 0.1  # seconds from one alarm to the next: a destructor may swallow one
LONGEST = 1e8  # seconds that the timer is set to at most, three years; the system's clocks end somewhere
HINT = "a longer --time-limit, fewer samples, --only what is needed, or a shorter duration"
# What is being done, by the modules at work: the first row that has one of them tells, else the command's own words.
PHASES = (
    ("heuncli.spec", "while the spec was read"),
    ("heuncli.study.search.extremes", "while extremes between the samples were searched"),
    ("heuncli.study.search.passages", "while extremes between the samples were searched"),
    ("heuncli.rest", "on the way to the rest pose"),
    ("heuncli.redundancy.advice", "while advice on what is redundant was sought"),
    ("heuncli.integration.check.singular_poses", "while singular poses were searched"),
    ("heuncli.expressions.discontinuities", "while jumps in time were searched"),
    ("heuncli.integration.conditions", "while events were searched"),
    ("heuncli.integration.check.changes", "while events were searched"),
    ("heuncli.study.ask.events", "while events were searched"),
    ("heuncli.integration.check.estimate", "while the motion was integrated and checked"),
    ("heuncli.integration.check.runs", "while the motion was integrated and checked"),
    ("heuncli.assembly", "while the scene was assembled"),
    ("heuncli.redundancy", "while it was judged which reactions are open"),
    ("heuncli.study.model.setup", "while the scene was set up"),
    ("heuncli.study.compose.recovery", "while loads were computed"),
    ("heuncli.study.compose.blocks", "while loads were computed"),
    ("heuncli.kinetostatics", "while loads were computed"),
    ("heuncli.report", "while the results were written down"),
    ("heuncli.cli.files", "while the results were written down"),
)  # fmt: skip
UNTOLD = "before the work was done"  # of commands that have no words of their own
Answer = TypeVar("Answer")
IMPORTING = "importlib._bootstrap"


class TimeUp(BaseException):
    """The time is up; no Exception, for what handles errors on the way is not to take it for one of its own."""


class _Clock:
    """Until when the work may take; None: for as long as it wants."""

    deadline: float | None = None
    limit = 0.0
    phase = UNTOLD


def limited(work: Callable[[], Answer], seconds: float | None, grace: float = GRACE, phase: str = UNTOLD) -> Answer:
    """What the work gives. Raises LimitError [time-limit] where it takes longer; None: as long as it wants.

    grace [s]: how much later it is interrupted; phase: what it is doing where the modules at work do not tell.
    """
    if seconds is None:
        return work()
    _Clock.deadline, _Clock.limit, _Clock.phase = time.monotonic() + seconds, seconds, phase
    undo = _timer(min(seconds + grace, LONGEST))
    try:
        return _at_work(work)
    except TimeUp as up:
        raise _reached(str(up)) from None
    finally:
        _Clock.deadline = None
        undo()


def _at_work(work: Callable[[], Answer]) -> Answer:
    """The work; only within this call an alarm ends it, for what was begun may take a while to be cleared away."""
    return work()


def remaining() -> float | None:
    """How much of the limit is left [s], more than nothing; None where there is none."""
    return None if _Clock.deadline is None else max(_Clock.deadline - time.monotonic(), 1e-9)


def disarm(*, late: bool = False) -> None:
    """No alarm from here on: what goes out goes out whole. Raises LimitError where it comes too late, unless it may."""
    deadline, _Clock.deadline = _Clock.deadline, None
    if deadline is not None and time.monotonic() > deadline and not late:
        raise _reached("before the results were written")


def _reached(where: str) -> LimitError:
    return LimitError(Problem("time-limit", f"the time limit of {_Clock.limit:g} s was reached {where}", hint=HINT))


def _timer(seconds: float) -> Callable[[], None]:
    """Set the system's timer, where there is one and this is the thread it interrupts; returns what unsets it."""
    import signal  # 1 ms that only limits need
    import threading

    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        return lambda: None
    before, told = signal.signal(signal.SIGALRM, _ring), sys.unraisablehook

    def swallowed(what: sys.UnraisableHookArgs) -> None:
        """An alarm that came while an object was destroyed says nothing: the next one is on its way."""
        if not isinstance(what.exc_value, TimeUp):
            told(what)

    sys.unraisablehook = swallowed
    signal.setitimer(signal.ITIMER_REAL, seconds, REPEAT)

    def undo() -> None:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        sys.unraisablehook = told

    return undo


def _ring(number: int, frame: FrameType | None) -> None:
    """End the work, but not an import: what is half imported could not be imported again for the next spec."""
    frames = list(_frames(frame))
    modules = [str(each.f_globals.get("__name__", "")) for each in frames]
    working = any(each.f_code is _at_work.__code__ for each in frames)
    if not working or _Clock.deadline is None or any(IMPORTING in name for name in modules):
        return
    told = (text for prefix, text in PHASES if any(name == prefix or name.startswith(prefix + ".") for name in modules))
    raise TimeUp(next(told, _Clock.phase))


def _frames(frame: FrameType | None) -> Iterator[FrameType]:
    """The calls under way, the innermost first."""
    while frame is not None:
        yield frame
        frame = frame.f_back
