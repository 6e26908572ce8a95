"""The time limit of a command, over all that it does: from before its spec is read until its first byte goes out.

Loops that look at the clock say themselves how far they have come; this is the net under all others. It has two stages:

    the ring      An interval timer of the system interrupts the work, and `TimeUp` is raised where heun's own code
                  runs and nothing but code that lets an exception through has called it. A library in the middle of
                  its work may wrap an exception, print it, or be left half made: it goes on until the next ring.
    the hard end  Where the work does not come back HARD_END seconds later, the process ends with exit code 4. A thread
                  does it, which also works while a library computes for long in one call. It waits while processes are
                  forked (a process with two threads is not to be); then the ring does it.

Where there is no such timer (Windows) the loops' own looks remain, one at the end, and the hard end. Impure: the
process's alarm, a thread, and the clock.
"""

from __future__ import annotations

import _thread
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import TypeVar

import heuncli
from heuncli.base import signals
from heuncli.base.errors import HeunError, LimitError, Problem

GRACE = 0.2  # seconds beyond the limit: the loops, which know more, speak first
NEXT_RING = 0.01  # seconds from one ring to the next
REPEAT = 0.1  # seconds from one exception to the next: what is under way is cleared away; a destructor may swallow one
HARD_END = 5.0  # seconds from the first ring until the process ends (manual/commands.md, "Time limit")
LONGEST = 1e8  # seconds that the timer is set to at most, three years; the system's clocks end somewhere
HINT = "a longer --time-limit, fewer samples, --only what is needed, or a shorter duration"
# What is being done, by the modules at work: the first row that has one of them tells, else the command's own words.
PHASES = (
    ("heuncli.scene.file_format", "while the spec was read"),
    ("heuncli.study.search.extremes", "while extremes between the samples were searched"),
    ("heuncli.study.search.passages", "while extremes between the samples were searched"),
    ("heuncli.loads.equilibrium", "on the way to the rest pose"),
    ("heuncli.loads.redundancy.advice", "while advice on what is redundant was sought"),
    ("heuncli.motion.integration.check.singular_poses", "while singular poses were searched"),
    ("heuncli.scene.expressions.discontinuities", "while jumps in time were searched"),
    ("heuncli.motion.integration.conditions", "while events were searched"),
    ("heuncli.motion.integration.check.changes", "while events were searched"),
    ("heuncli.study.ask.events", "while events were searched"),
    ("heuncli.motion.integration.check.estimate", "while the motion was integrated and checked"),
    ("heuncli.motion.integration.check.runs", "while the motion was integrated and checked"),
    ("heuncli.multibody.assembly", "while the scene was assembled"),
    ("heuncli.loads.redundancy", "while it was judged which reactions are open"),
    ("heuncli.study.model.setup", "while the scene was set up"),
    ("heuncli.study.compose.recovery", "while loads were computed"),
    ("heuncli.study.compose.blocks", "while loads were computed"),
    ("heuncli.loads.kinetostatics", "while loads were computed"),
    ("heuncli.output.tables", "while the results were written down"),
    ("heuncli.base.files", "while the results were written down"),
)  # fmt: skip
UNTOLD = "before the work was done"  # of commands that have no words of their own
Answer = TypeVar("Answer")
OWN = os.path.join(os.path.dirname(heuncli.__file__), "")  # noqa: PTH118, PTH120 - pathlib takes 3 ms
SHELTERED = (__file__, signals.__file__)  # what begins and ends the watch; what ends the process
# Libraries that let an exception of what they call through as it is. Not among them: what imports (a module half
# imported cannot be imported again for the next spec), pydantic, which wraps it, and SciPy, whose Fortran prints it.
TRANSPARENT = (sys.stdlib_module_names | {"heuncli", "numpy", "yaml"}) - {"importlib", "multiprocessing", "sqlite3"}


class TimeUp(BaseException):
    """The time is up; no Exception, for what handles errors on the way is not to take it for one of its own."""


class _Clock:
    """Until when the work may take; None: for as long as it wants."""

    deadline: float | None = None
    limit = 0.0
    phase = UNTOLD
    subject = ""  # the file at work, of several
    rung: str | None = None  # what was going on when the ring ended the work
    resting = 0.0  # no ring until then
    hard_end = 0.0
    ending = _thread.allocate_lock()  # held by who ends the process, or sees to it that nobody does
    silent = False  # of a process whose parent tells


def limited(
    work: Callable[[], Answer], seconds: float | None, grace: float = GRACE, phase: str = UNTOLD, subject: str = ""
) -> Answer:
    """What the work gives. Raises LimitError [time-limit] where it takes longer; None: as long as it wants.

    grace [s]: how much later it is interrupted; phase: what it is doing where the modules at work do not tell; subject:
    the file at work, where there are several.
    """
    if seconds is None:
        return work()
    now = time.monotonic()
    _Clock.deadline, _Clock.limit, _Clock.phase, _Clock.subject = now + seconds, seconds, phase, subject
    _Clock.rung, _Clock.resting, _Clock.hard_end = None, 0.0, now + seconds + grace + HARD_END
    undo = _timer(min(seconds + grace, LONGEST))
    try:
        with _watched():
            return interruptible(work)
    except TimeUp as up:
        raise _reached(str(up)) from None
    except HeunError:
        raise
    except Exception:
        if _Clock.rung is None:
            raise
        raise _reached(_Clock.rung) from None  # what became of the exception on its way
    finally:
        _Clock.deadline = None
        undo()


def interruptible(work: Callable[[], Answer]) -> Answer:
    """The work, within which the ring may raise TimeUp.

    Whoever is called by a library that an exception does not pass unharmed calls this, and handles TimeUp.
    """
    return work()


def remaining() -> float | None:
    """How much of the limit is left [s], more than nothing; None where there is none."""
    return None if _Clock.deadline is None else max(_Clock.deadline - time.monotonic(), 1e-9)


def disarm(*, late: bool = False) -> None:
    """No alarm from here on: what goes out goes out whole. Raises LimitError where it comes too late, unless it may."""
    with _Clock.ending:
        deadline, _Clock.deadline = _Clock.deadline, None
    if deadline is not None and time.monotonic() > deadline and not late:
        raise _reached("before the results were written")


def be_silent() -> None:
    """This process ends without a word, with exit code 4; its parent tells what became of the work."""
    _Clock.silent = True


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
    signal.setitimer(signal.ITIMER_REAL, seconds, NEXT_RING)

    def undo() -> None:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        sys.unraisablehook = told

    return undo


def _ring(number: int, frame: FrameType | None) -> None:
    """End the work, where that is possible at once."""
    now = time.monotonic()
    if _Clock.deadline is None or now < _Clock.resting:
        return
    frames = list(_frames(frame))
    if now > _Clock.hard_end:
        _end_at_once(frames)
    elif _is_interruptible(frames) and not _is_on_its_way(sys.exc_info()[1]):
        _Clock.rung, _Clock.resting = _at_work(frames), now + REPEAT
        raise TimeUp(_Clock.rung)


def _is_interruptible(frames: Sequence[FrameType]) -> bool:
    """Whether heun's own code is running (innermost first), called through nothing that an exception does not pass."""
    file = frames[0].f_code.co_filename if frames else ""
    if not file.startswith(OWN) or file in SHELTERED:
        return False
    for frame in frames:
        if frame.f_code is interruptible.__code__:
            return True
        package = str(frame.f_globals.get("__name__", "")).partition(".")[0]
        if not frame.f_code.co_filename.startswith(OWN) and package not in TRANSPARENT:
            return False
    return False


def _is_on_its_way(error: BaseException | None) -> bool:
    """Whether a ring's exception is being handled: what is cleared away because of it is not to be interrupted."""
    while error is not None and not isinstance(error, TimeUp):
        error = error.__context__
    return error is not None


def _at_work(frames: Sequence[FrameType]) -> str:
    """What is going on, by the modules at work."""
    modules = [str(each.f_globals.get("__name__", "")) for each in frames]
    told = (text for prefix, text in PHASES if any(name == prefix or name.startswith(prefix + ".") for name in modules))
    return next(told, _Clock.phase)


def _frames(frame: FrameType | None) -> Iterator[FrameType]:
    """The calls under way, the innermost first."""
    while frame is not None:
        yield frame
        frame = frame.f_back


class _Watch:
    """The thread that ends the process where the work does not come back; it is there between `begin` and `end`."""

    current: _Watch | None = None

    def __init__(self) -> None:
        import threading

        self.over = threading.Lock()
        self.over.acquire()
        self.main = threading.get_ident()
        self.thread = threading.Thread(target=self._wait, daemon=True)

    def begin(self) -> None:
        _Watch.current = self
        self.thread.start()

    def end(self) -> None:
        _Watch.current = None
        self.over.release()
        self.thread.join()

    def _wait(self) -> None:
        seconds = min(max(_Clock.hard_end - time.monotonic(), 0.0), LONGEST)
        if not self.over.acquire(timeout=min(seconds, _thread.TIMEOUT_MAX)) and _Watch.current is self:
            _end_at_once(list(_frames(sys._current_frames().get(self.main))))


@contextmanager
def _watched() -> Iterator[None]:
    """While this is under way the process ends at the hard end; it may not fork but `unwatched`."""
    import threading

    if threading.current_thread() is not threading.main_thread():
        yield  # one of several threads, of a program that is not to end for it
        return
    watch = _Watch()
    watch.begin()
    try:
        yield
    finally:
        if _Watch.current is not None:
            _Watch.current.end()


@contextmanager
def unwatched() -> Iterator[None]:
    """While this is under way processes are forked: no thread looks at the hard end, but the ring does."""
    watch = _Watch.current
    if watch is not None:
        watch.end()
    try:
        yield
    finally:
        if watch is not None and _Clock.deadline is not None:
            _Watch().begin()


def _end_at_once(frames: Sequence[FrameType]) -> None:
    """End the process with exit code 4 and leave nothing half written; not where the output goes out already."""
    if not _Clock.ending.acquire(blocking=False):
        return
    if _Clock.deadline is None:
        _Clock.ending.release()
        return
    label = f"{_Clock.subject}: " if _Clock.subject else "heun: "
    (problem,) = _reached(_at_work(frames)).problems
    late = f"{problem.message}, and the work did not stop; heun ended {HARD_END:g} s later"
    text = "" if _Clock.silent else f"{label}{problem._replace(message=late)}\n"
    signals.leave(LimitError.exit_code, text.encode())
