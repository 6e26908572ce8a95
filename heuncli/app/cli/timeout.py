"""Enforce the time limit of a command over all that it does: from before its spec is read until its output is made.

Loops that check the clock report by themselves how far they have come; this module catches everything else. It has two
stages:

    the alarm     An interval timer of the system interrupts the work, and `TimeUp` is raised if heun's own code is
                  running and all its callers let an exception pass unchanged. A library in the middle of its work
                  may wrap an exception, print it, or be left in a broken state: it runs on until the next alarm.
    the hard end  If the work does not stop within HARD_END seconds, the process ends with exit code 4. A thread
                  does it, which also works while a library computes for long in one call. The thread is paused
                  while processes are forked (a process with two threads must not fork); then the alarm does it.

On systems without such a timer (Windows) there remain the clock checks of the loops, one check at the end, and the hard
end. Impure: the process's alarm, a thread, and the clock.
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

from heuncli.base import files, signals
from heuncli.base.errors import HeunError, LimitError, Problem

GRACE = 0.2  # seconds beyond the limit, so that the loops, which know more, report first
ALARM_INTERVAL = 0.01  # seconds from one alarm to the next
EXCEPTION_INTERVAL = 0.1  # seconds between exceptions, for cleanup; a destructor may swallow one
HARD_END = 5.0  # seconds from the first alarm until the process ends (manual/commands.md, "Time limit")
MAX_TIMER = 1e8  # seconds, three years: the systems' clocks have a limit
HINT = "use a longer --time-limit, fewer samples, --only for the results needed, or a shorter duration"
# Description of the work by the modules on the stack: the first row that matches, else the command's own phase.
PHASES = (
    ("heuncli.scene.file_format", "while the spec was read"),
    ("heuncli.study.search.extremes", "while extremes between the samples were searched"),
    ("heuncli.study.search.cuts", "while extremes between the samples were searched"),
    ("heuncli.loads.equilibrium", "while the rest position was searched"),
    ("heuncli.loads.redundancy.advice", "while redundant constraints were analysed"),
    ("heuncli.motion.integration.check.singular_poses", "while singular positions were searched"),
    ("heuncli.scene.expressions.discontinuities", "while jumps in time were searched"),
    ("heuncli.motion.integration.conditions", "while events were searched"),
    ("heuncli.motion.integration.check.changes", "while events were searched"),
    ("heuncli.study.queries.events", "while events were searched"),
    ("heuncli.motion.integration.check.estimate", "while the motion was integrated and checked"),
    ("heuncli.motion.integration.check.runs", "while the motion was integrated and checked"),
    ("heuncli.multibody.assembly", "while the model was being assembled"),
    ("heuncli.loads.redundancy", "while indeterminate reactions were identified"),
    ("heuncli.study.model.setup", "while the model was being set up"),
    ("heuncli.study.compose.recovery", "while loads were computed"),
    ("heuncli.study.compose.blocks", "while loads were computed"),
    ("heuncli.loads.kinetostatics", "while loads were computed"),
    ("heuncli.output.documents", "while the results were written"),
    ("heuncli.output.tables", "while the results were written"),
    ("heuncli.base.files", "while the results were written"),
)  # fmt: skip
DEFAULT_PHASE = "before the work was finished"  # of commands without a phase of their own
Answer = TypeVar("Answer")
OWN_CODE = os.path.join(files.PACKAGE_FOLDER, "")  # noqa: PTH118 - the beginning of the paths of heun's modules
PROTECTED_FILES = (__file__, signals.__file__)  # an alarm never interrupts code in these files
# Libraries that let an exception of their callbacks pass unchanged. Not among them: the import system (a half
# imported module cannot be imported again for the next spec), pydantic, which wraps it, and SciPy, whose Fortran
# prints it.
TRANSPARENT = (sys.stdlib_module_names | {"heuncli", "numpy", "yaml"}) - {"importlib", "multiprocessing", "sqlite3"}


class TimeUp(BaseException):
    """The time limit was reached. Not an Exception, so that error handlers on the way do not catch it."""


class _Clock:
    """State of the time limit.

    deadline: when the work must end; None: no limit
    limit: how long it may take [s]
    phase: what the work does, if the modules at work do not say
    subject: the file at work, if there are several
    interrupted_phase: what was being done when an alarm ended the work
    pause_end: no alarm acts before this time
    hard_end: when the process ends
    end_lock: held by the thread that ends the process, or that ends the limit
    silent: whether this is a worker process, whose parent reports the limit
    """

    deadline: float | None = None
    limit = 0.0
    phase = DEFAULT_PHASE
    subject = ""
    interrupted_phase: str | None = None
    pause_end = 0.0
    hard_end = 0.0
    end_lock = _thread.allocate_lock()
    silent = False


def run_with_limit(
    work: Callable[[], Answer],
    seconds: float | None,
    grace: float = GRACE,
    phase: str = DEFAULT_PHASE,
    subject: str = "",
) -> Answer:
    """Run the work and return its result. Raises LimitError [time-limit] if it takes longer than `seconds`; None: no
    limit.

    grace: how much later it is interrupted [s]
    phase: what the work does, if the modules at work do not say
    subject: the file at work, if there are several
    """
    if seconds is None:
        return work()
    now = time.monotonic()
    _Clock.deadline, _Clock.limit, _Clock.phase, _Clock.subject = now + seconds, seconds, phase, subject
    _Clock.interrupted_phase, _Clock.pause_end, _Clock.hard_end = None, 0.0, now + seconds + grace + HARD_END
    undo = _start_timer(min(seconds + grace, MAX_TIMER))
    try:
        with _watch_hard_end():
            return run_interruptible(work)
    except TimeUp as up:
        raise _make_limit_error(str(up)) from None
    except HeunError:
        raise
    except Exception:
        if _Clock.interrupted_phase is None:
            raise
        raise _make_limit_error(_Clock.interrupted_phase) from None  # TimeUp, wrapped by a library
    finally:
        _Clock.deadline = None
        undo()


def run_interruptible(work: Callable[[], Answer]) -> Answer:
    """Run work that an alarm may interrupt with TimeUp.

    Code that is called by a library which an exception would harm calls this, and handles TimeUp.
    """
    return work()


def remaining_time() -> float | None:
    """Return the time left until the limit [s], more than zero, or None without a limit."""
    return None if _Clock.deadline is None else max(_Clock.deadline - time.monotonic(), 1e-9)


def limit_seconds(longest: float) -> float:
    """Return how long another program may run [s]: `longest`, or what is left until the limit."""
    remaining = remaining_time()
    return longest if remaining is None else min(longest, remaining)


def disarm(*, late: bool = False) -> None:
    """End the time limit, so that output is not interrupted. Raises LimitError if the limit has passed, unless
    `late`.
    """
    with _Clock.end_lock:
        deadline, _Clock.deadline = _Clock.deadline, None
    if deadline is not None and time.monotonic() > deadline and not late:
        raise _make_limit_error("before the results were written")


def silence() -> None:
    """End without a message at the time limit, with exit code 4: the parent process reports it."""
    _Clock.silent = True


def _make_limit_error(where: str) -> LimitError:
    """Make the error of the time limit; where: what was being done."""
    return LimitError(Problem("time-limit", f"the time limit of {_Clock.limit:g} s was reached {where}", hint=HINT))


def _start_timer(seconds: float) -> Callable[[], None]:
    """Start the system's timer, if there is one and this is the thread that it interrupts; returns the function that
    undoes it.
    """
    import signal  # 1 ms that only limits need
    import threading

    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        return lambda: None
    previous_handler, previous_hook = signal.signal(signal.SIGALRM, _handle_alarm), sys.unraisablehook

    def ignore_unraisable(what: sys.UnraisableHookArgs) -> None:
        """Ignore an alarm that came while an object was destroyed: the next one will act."""
        if not isinstance(what.exc_value, TimeUp):
            previous_hook(what)

    sys.unraisablehook = ignore_unraisable
    signal.setitimer(signal.ITIMER_REAL, seconds, ALARM_INTERVAL)

    def undo() -> None:
        """Stop the timer, and restore the handlers of before."""
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, previous_handler)
        sys.unraisablehook = previous_hook

    return undo


def _handle_alarm(number: int, frame: FrameType | None) -> None:
    """Interrupt the work if that is safe now, or end the process after the hard end."""
    now = time.monotonic()
    if _Clock.deadline is None or now < _Clock.pause_end:
        return
    frames = list(_iter_frames(frame))
    if now > _Clock.hard_end:
        _end_process(frames)
    elif _is_interruptible(frames) and not _is_time_up_handled(sys.exc_info()[1]):
        _Clock.interrupted_phase, _Clock.pause_end = _describe_work(frames), now + EXCEPTION_INTERVAL
        raise TimeUp(_Clock.interrupted_phase)


def _is_interruptible(frames: Sequence[FrameType]) -> bool:
    """Return whether heun's own code is running (innermost frame first), called only through code that lets exceptions
    pass.
    """
    file = frames[0].f_code.co_filename if frames else ""
    if not file.startswith(OWN_CODE) or file in PROTECTED_FILES:
        return False
    for frame in frames:
        if frame.f_code is run_interruptible.__code__:
            return True
        package = str(frame.f_globals.get("__name__", "")).partition(".")[0]
        if not frame.f_code.co_filename.startswith(OWN_CODE) and package not in TRANSPARENT:
            return False
    return False


def _is_time_up_handled(error: BaseException | None) -> bool:
    """Return whether a TimeUp is being handled: the cleanup after it must not be interrupted."""
    while error is not None and not isinstance(error, TimeUp):
        error = error.__context__
    return error is not None


def _describe_work(frames: Sequence[FrameType]) -> str:
    """Return what is going on, by the modules at work."""
    modules = [str(each.f_globals.get("__name__", "")) for each in frames]
    phases = (
        text for prefix, text in PHASES if any(name == prefix or name.startswith(prefix + ".") for name in modules)
    )
    return next(phases, _Clock.phase)


def _iter_frames(frame: FrameType | None) -> Iterator[FrameType]:
    """Yield the frames of the calls under way, the innermost first."""
    while frame is not None:
        yield frame
        frame = frame.f_back


class _Watchdog:
    """The thread that ends the process if the work does not stop; it runs between `begin` and `end`."""

    current: _Watchdog | None = None

    def __init__(self) -> None:
        import threading

        self.over = threading.Lock()
        self.over.acquire()
        self.main = threading.get_ident()
        self.thread = threading.Thread(target=self._wait, daemon=True)

    def begin(self) -> None:
        """Start to watch."""
        _Watchdog.current = self
        self.thread.start()

    def end(self) -> None:
        """Stop watching, and wait until the thread has ended."""
        _Watchdog.current = None
        self.over.release()
        self.thread.join()

    def _wait(self) -> None:
        """Wait for the end of the work, or end the process at the hard end."""
        seconds = min(max(_Clock.hard_end - time.monotonic(), 0.0), MAX_TIMER)
        if not self.over.acquire(timeout=min(seconds, _thread.TIMEOUT_MAX)) and _Watchdog.current is self:
            _end_process(list(_iter_frames(sys._current_frames().get(self.main))))


@contextmanager
def _watch_hard_end() -> Iterator[None]:
    """End the process at the hard end while this context is open; forks in it need `pause_watch`."""
    import threading

    if threading.current_thread() is not threading.main_thread():
        yield  # another thread of a program that must not be ended
        return
    watch = _Watchdog()
    watch.begin()
    try:
        yield
    finally:
        if _Watchdog.current is not None:
            _Watchdog.current.end()


@contextmanager
def pause_watch() -> Iterator[None]:
    """Stop the watchdog thread while processes are forked; the alarm still enforces the hard end."""
    watch = _Watchdog.current
    if watch is not None:
        watch.end()
    try:
        yield
    finally:
        if watch is not None and _Clock.deadline is not None:
            _Watchdog().begin()


def _end_process(frames: Sequence[FrameType]) -> None:
    """End the process with exit code 4 and leave no half-written file; does nothing if output is already going out."""
    if not _Clock.end_lock.acquire(blocking=False):
        return
    if _Clock.deadline is None:
        _Clock.end_lock.release()
        return
    label = f"{_Clock.subject}: " if _Clock.subject else "heun: "
    (problem,) = _make_limit_error(_describe_work(frames)).problems
    late = f"{problem.message}, but the work did not stop; heun ended {HARD_END:g} s later"
    text = "" if _Clock.silent else f"{label}{problem._replace(message=late)}\n"
    signals.exit_after_cleanup(LimitError.exit_code, text.encode())
