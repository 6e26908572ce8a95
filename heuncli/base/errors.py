"""What can go wrong, as values: a Problem has a message, a location, a hint and a code; an error carries all of them.

Named tuples: to import dataclasses would take 10 ms, and `heun --version` needs no others.
"""

from __future__ import annotations

from heuncli.base.foreign_text import shown
from heuncli.base.named_tuples import NamedTuple

LONGEST = 5000  # characters of a message that are told: an expression of the longest, twice, and what is said of it


class SourceLocation(NamedTuple):
    """Where in a file: 1-based line and column, and the dotted path of the value; line 0 of what is no file."""

    file: str
    line: int
    column: int
    path: str = ""

    def __str__(self) -> str:
        return f"{shown(self.file)}:{self.line}:{self.column}" if self.line else shown(self.file)


class Problem(NamedTuple):
    """One thing wrong: a sentence and its code, what to do next, and, where known, the location.

    about: the path in a spec of the entry at fault, `joints.elbow`, where who finds it knows names, but no places.
    """

    code: str
    message: str
    location: SourceLocation | None = None
    hint: str = ""
    about: str = ""

    def __str__(self) -> str:
        path = f"{told(self.location.path)}: " if self.location and self.location.path else ""
        where = f"{self.location}: {path}" if self.location else ""
        hint = f"\n  hint: {told(self.hint)}" if self.hint else ""
        return f"{where}{told(self.message)} [{self.code}]{hint}"


def told(text: str) -> str:
    """A part of a problem on one line; of a word of a million letters its ends."""
    left_out = len(text) - LONGEST
    if left_out <= 0:
        return shown(text)
    return f"{shown(text[: LONGEST // 2])} ... ({left_out} characters more) ... {shown(text[-LONGEST // 2 :])}"


class Finding(ValueError):
    """A problem in a value, raised by code that does not know where the value stands; the caller adds the location."""

    def __init__(self, code: str, message: str, hint: str) -> None:
        super().__init__(message)
        self.code, self.message, self.hint = code, message, hint

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle it by its attributes, not by the arguments of its class."""
        return restore_error, (type(self), self.args, self.__dict__)


class HeunError(Exception):
    """A failure the user can act on; `exit_code` is the command's exit status (manual/commands.md, "Exit codes")."""

    exit_code = 70

    def __init__(self, *problems: Problem) -> None:
        super().__init__("\n".join(str(p) for p in problems))
        self.problems = problems

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle it by its attributes: some classes make the problem of other arguments."""
        return restore_error, (type(self), self.args, self.__dict__)

    def tell(self, *problems: Problem) -> None:
        """Tell these problems instead."""
        self.args, self.problems = ("\n".join(map(str, problems)),), problems


def restore_error(cls: type[BaseException], args: tuple[object, ...], attributes: dict[str, object]) -> BaseException:
    """Make an error that was pickled, without the arguments of its class."""
    error = cls.__new__(cls, *args)
    error.args = args
    error.__dict__.update(attributes)
    return error


class UsageError(HeunError):
    """What is asked for is not there: by a word of the command line, or by an argument in Python."""

    exit_code = 2


class SpecError(HeunError):
    """The spec is missing, unreadable, not YAML or not a scene."""

    exit_code = 2


class SolveError(HeunError):
    """The scene cannot be solved: it does not close, is singular, or no acceleration exists."""

    exit_code = 3
    reached: float | None = None  # the instant up to which a motion went


class LimitError(HeunError):
    """A limit was reached: time, steps, memory, output size."""

    exit_code = 4


class OutputError(HeunError):
    """The output could not be written."""

    exit_code = 5
