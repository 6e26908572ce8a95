"""Errors as values: a Problem has a message, a location, a hint and a code; an exception carries one or more of them.

Problems are named tuples: importing dataclasses would take 10 ms, and `heun --version` needs no others.
"""

from __future__ import annotations

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape

# characters of a message that are shown: the longest expression, twice, and the text around it
MAX_MESSAGE_LENGTH = 5000


class SourceLocation(NamedTuple):
    """A place in a file: 1-based line and column, and the dotted path of the value; line 0 if the source is not a
    file.
    """

    file: str
    line: int
    column: int
    path: str = ""

    def __str__(self) -> str:
        return f"{escape(self.file)}:{self.line}:{self.column}" if self.line else escape(self.file)


class Problem(NamedTuple):
    """One error: a sentence, its code, a hint on what to do next and, where known, the location.

    entry_path: the path in a spec of the entry at fault, such as `joints.elbow`, set where names are known but
    locations are not
    """

    code: str
    message: str
    location: SourceLocation | None = None
    hint: str = ""
    entry_path: str = ""

    def __str__(self) -> str:
        path = f"{shorten_text(self.location.path)}: " if self.location and self.location.path else ""
        where = f"{self.location}: {path}" if self.location else ""
        hint = f"\n  hint: {shorten_text(self.hint)}" if self.hint else ""
        return f"{where}{shorten_text(self.message)} [{self.code}]{hint}"


def shorten_text(text: str) -> str:
    """Return part of a problem's text on one line; a text longer than MAX_MESSAGE_LENGTH loses its middle."""
    surplus = len(text) - MAX_MESSAGE_LENGTH
    if surplus <= 0:
        return escape(text)
    return (
        f"{escape(text[: MAX_MESSAGE_LENGTH // 2])} ... ({surplus} characters more) ... "
        f"{escape(text[-MAX_MESSAGE_LENGTH // 2 :])}"
    )


class Finding(ValueError):
    """A problem in a value, raised by code that does not know the value's location; the caller adds the location."""

    def __init__(self, code: str, message: str, hint: str) -> None:
        super().__init__(message)
        self.code, self.message, self.hint = code, message, hint

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle it by its attributes, not by the arguments of its class."""
        return restore_error, (type(self), self.args, self.__dict__)


class HeunError(Exception):
    """An error the user can act on; `exit_code` is the command's exit status (manual/commands.md, "Exit codes")."""

    exit_code = 70

    def __init__(self, *problems: Problem) -> None:
        super().__init__("\n".join(str(p) for p in problems))
        self.problems = problems

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the error by its attributes: some subclasses build the problem from other arguments."""
        return restore_error, (type(self), self.args, self.__dict__)

    def replace_problems(self, *problems: Problem) -> None:
        """Replace the problems of this error."""
        self.args, self.problems = ("\n".join(map(str, problems)),), problems


def restore_error(cls: type[BaseException], args: tuple[object, ...], attributes: dict[str, object]) -> BaseException:
    """Restore a pickled error without calling its constructor."""
    error = cls.__new__(cls, *args)
    error.args = args
    error.__dict__.update(attributes)
    return error


class UsageError(HeunError):
    """The request cannot be met: a wrong word on the command line, or a wrong argument in Python."""

    exit_code = 2


class SpecError(HeunError):
    """The spec is missing, unreadable, not YAML or not a valid scene."""

    exit_code = 2


class SolveError(HeunError):
    """The scene cannot be solved: its loops do not close, it is singular, or no acceleration exists."""

    exit_code = 3
    reached: float | None = None  # the instant up to which a motion went


class LimitError(HeunError):
    """A limit was exceeded: time, steps, memory or output size."""

    exit_code = 4


class OutputError(HeunError):
    """The output could not be written."""

    exit_code = 5
