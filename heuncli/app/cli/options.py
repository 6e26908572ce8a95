"""The vocabulary of requests: the class of an option, and the options that many commands share.

A request is a named tuple, one per command. Each field is an option or argument; its annotation holds the words and the
help text. Options that several commands share are one field, a record of them (SolverRequest, CaptionRequest).
app/cli/entry.py fills a request from the words of a line. Named tuples, not dataclasses, because those take
0.6 ms each to define, and every command pays.
"""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, Protocol, get_type_hints

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


def make_format_option(formats: Sequence[str]) -> Option:
    """Make the option `--format` of a command that writes tables in these formats."""
    return Option(
        ("--format",), "Output format. Default: from the extension of -o FILE, else table.", "|".join(formats)
    )


SET = Option(
    ("--set",), "Set a parameter, or a dotted key of the spec. May be repeated.", "NAME=VALUE", completes="set"
)
TITLE = Option(("--title",), "Title in place of the spec's.", "TEXT")
LABEL = Option(
    ("--label",),
    "Text shown in place of a name, such as joints.main='Main bearing'. May be repeated.",
    "PATH=TEXT",
    completes="label",
)
CASE = Option(("--case",), "Solve this load case; --set is applied on top.", "NAME", completes="case")
OUTPUT = Option(("--output", "-o"), "Output file, written atomically.", "FILE")
QUIET = Option(("--quiet", "-q"), "Suppress warnings on standard error.")
TIME_LIMIT = Option(("--time-limit",), "Stop after this computing time.", "SECONDS")
TIME_LIMIT_EACH = Option(("--time-limit",), "Stop each spec after this time; the others continue.", "SECONDS")
UNITS = Option(("--units",), "Units of tables, such as kN,mm,deg,rpm; all other formats stay in SI.", "UNIT,...")
VIEW = Option(
    ("--view",), "Viewing direction: along x, y or z, or azimuth, elevation [deg].", "x|y|z|A,E"
)  # fmt: skip
WIDTH = Option(("--width",), "Width of a text drawing in columns.", "COLUMNS")
METHOD = Option(("--method",), "Integration method; `heun methods` lists them.", "NAME")
STEP = Option(("--step",), "Step size of a fixed-step method.", "SECONDS")
TOLERANCE = Option(("--tolerance",), "Allowed error of the motion, relative to the model size.", "NUMBER")
LEAST_NORM = Option(("--least-norm",), "Distribute indeterminate reactions by the minimum-norm solution.")
WITHOUT = Option(
    ("--without",),
    "Leave out these forces, and lock these drives at their start position. May be repeated.",
    "NAME,...",
)
NO_REDUCE = Option(("--no-reduce",), "Solve the full model without reduction.")
FORMATS = ("table", "json", "csv")  # of most commands
FORMAT = make_format_option(FORMATS)
REPORT_FORMATS = ("html", "pdf", "md")  # of client reports
PAPERS = ("a4", "letter")
SPEC = Option((), "YAML file of the spec; - reads standard input.", "SPEC", completes="spec")


class SolverRequest(NamedTuple):
    """The options of the solver; a request has them as one field."""

    method: Annotated[str | None, METHOD] = None
    step: Annotated[float | None, STEP] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    least_norm: Annotated[bool, LEAST_NORM] = False


class CaptionRequest(NamedTuple):
    """The options that change the words of a result; a request has them as one field."""

    title: Annotated[str | None, TITLE] = None
    label: Annotated[tuple[str, ...], LABEL] = ()


OPTION_RECORDS = (SolverRequest, CaptionRequest)
REQUIRED = object()  # the default of a field that has none


class Request(Protocol):
    """A named tuple of options, such as RunRequest in app/commands/run/request.py; its docstring is the help."""

    _fields: ClassVar[tuple[str, ...]]
    _field_defaults: ClassVar[dict[str, Any]]

    def __init__(self, **values: Any) -> None: ...


class RequestField(NamedTuple):
    """An option or argument of a request.

    type: of its value
    default: its value if it is not given, or REQUIRED
    record: the field of the request that holds it, if that is one of OPTION_RECORDS
    """

    name: str
    type: object
    option: Option
    default: object = REQUIRED
    record: str = ""

    def read_value(self, request: object) -> object:
        """Return its value in a request."""
        return getattr(getattr(request, self.record) if self.record else request, self.name)


def list_fields(request: type[Any]) -> list[RequestField]:
    """List the options and arguments of a command in their order, those of its records too."""
    fields: list[RequestField] = []
    notes = get_type_hints(request, include_extras=True)
    for name in request._fields:
        default = request._field_defaults.get(name, REQUIRED)
        if isinstance(default, OPTION_RECORDS):
            fields += (field._replace(record=name) for field in list_fields(notes[name]))
        else:
            fields.append(RequestField(name, notes[name].__origin__, notes[name].__metadata__[0], default))
    return fields


def make_request(request: type[Request], values: Mapping[str, Any]) -> Request:
    """Make the request of a command from the values of its options; its records take theirs."""
    records = {
        name: default for name, default in request._field_defaults.items() if isinstance(default, OPTION_RECORDS)
    }
    filled = {
        name: record._replace(**{key: values[key] for key in record._fields if key in values})
        for name, record in records.items()
    }
    return request(**{name: values[name] for name in request._fields if name in values}, **filled)
