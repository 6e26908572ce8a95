"""The vocabulary of requests: the class of an option, and the options that many commands share.

A request is a named tuple, one per command. Each field is an option or argument; its annotation holds the words and the
help text. Two parsers fill it: app/cli/plain.py for plain command lines, and app/cli/app.py through typer for help and
usage errors. Named tuples, not dataclasses, because those take 0.6 ms each to define, and every command pays.
"""

from typing import Any, ClassVar, Protocol

from heuncli.base.named_tuples import NamedTuple


class Option(NamedTuple):
    """An option of a command.

    words: its words; none: an argument
    help: what it does
    metavar: the name of its value in the help
    completes: the key in app/cli/completion.py of its shell completion
    """

    words: tuple[str, ...]
    help: str
    metavar: str | None = None
    completes: str = ""


SET = Option(
    ("--set",), "Set a parameter, or a dotted key of the spec. May be repeated.", "NAME=VALUE", completes="set"
)
CASE = Option(("--case",), "In a load case of the spec; what --set says goes on top.", "NAME", completes="case")
OUTPUT = Option(("--output", "-o"), "Write there, whole or not at all.", "FILE")
QUIET = Option(("--quiet", "-q"), "No warnings on standard error.")
TIME_LIMIT = Option(("--time-limit",), "Give up after that long.", "SECONDS")
TIME_LIMIT_EACH = Option(("--time-limit",), "Give up on a spec after that long; the others go on.", "SECONDS")
UNITS = Option(("--units",), "Units of tables, such as kN,mm,deg,rpm; all other forms stay SI.", "UNIT,...")
VIEW = Option(
    ("--view",), "From where a scene is seen: along x, y, z, or azimuth, elevation [deg].", "x|y|z|A,E"
)  # fmt: skip
WIDTH = Option(("--width",), "Columns of a drawing in letters.", "COLUMNS")
METHOD = Option(("--method",), "The method of integration; `heun methods` lists them.", "NAME")
STEP = Option(("--step",), "The step of a method of fixed step.", "SECONDS")
TOLERANCE = Option(("--tolerance",), "Error of the motion, relative to the scene.", "NUMBER")
LEAST_NORM = Option(("--least-norm",), "Split what redundant supports leave open.")
WITHOUT = Option(
    ("--without",), "Leave out these forces, and hold these drives where they start. May be repeated.", "NAME,..."
)
NO_REDUCE = Option(("--no-reduce",), "Solve all of the scene, in full.")
FORMATS = ("table", "json", "csv")  # of most commands
FORMAT = Option(
    ("--format",), "How to write it. Default: by the name's end of -o FILE, else table.", "|".join(FORMATS)
)  # fmt: skip
SPEC = Option((), "The scene's YAML file; - reads standard input.", "SPEC", completes="spec")


class Request(Protocol):
    """A named tuple of options, such as RunRequest in app/commands/run/request.py; its docstring is the help."""

    _field_defaults: ClassVar[dict[str, Any]]

    def __init__(self, **values: Any) -> None: ...


class RequestField(NamedTuple):
    """One field of a request: its name, its type, and its option."""

    name: str
    type: object
    option: Option


def list_fields(request: type[Request]) -> list[RequestField]:
    """List the options and arguments of a command, in their order."""
    notes = request.__annotations__.items()
    return [RequestField(name, note.__origin__, note.__metadata__[0]) for name, note in notes]
