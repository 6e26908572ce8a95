"""The commands and their options, as data: what is asked for, before anything heavy is imported.

Each command is a named tuple; a field is an option (or the arguments), its annotation holds the words and the help. Two
readers fill them in: cli/plain.py at once for plain command lines, cli/app.py through typer for help and usage errors.
Named tuples here and in report/, not dataclasses: those take 0.6 ms each to define, and every command pays.
"""

from typing import Annotated, NamedTuple

FORMATS = ("table", "json", "csv", "markdown")


class Option(NamedTuple):
    """The words of an option (none: an argument), what it does, and what stands for its value in the help."""

    words: tuple[str, ...]
    help: str
    metavar: str | None = None


SET = Option(("--set",), "Set a parameter, or a dotted key of the spec. May be repeated.", "NAME=VALUE")
OUTPUT = Option(("--output", "-o"), "Write there, whole or not at all.", "FILE")
QUIET = Option(("--quiet", "-q"), "No warnings on standard error.")
TIME_LIMIT = Option(("--time-limit",), "Give up after that long.", "SECONDS")
TIME_LIMIT_EACH = Option(("--time-limit",), "Give up on a spec after that long; the others go on.", "SECONDS")
NO_REDUCE = Option(("--no-reduce",), "Solve all of the scene, in full.")
SPEC = Option((), "The scene's YAML file; - reads standard input.", "SPEC")


class Run(NamedTuple):
    """Solve a scene and report its loads and motion."""

    spec: Annotated[str, SPEC]
    format: Annotated[
        str | None,
        Option(
            ("--format",),
            "How to write the results. Default: by the name's end of -o FILE, else table.",
            "|".join(FORMATS),
        ),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    only: Annotated[
        str | None,
        Option(
            ("--only",),
            "Only these: motion, points, foundation, joints, sections, forces, energy, impulses, events, shares; or "
            "entries: joints.NAME, sections.NAME, ...",
            "REPORT,...",
        ),
    ] = None
    set: Annotated[tuple[str, ...], SET] = ()
    at: Annotated[str | None, Option(("--at",), "Show these instants instead of the extremes.", "T,...")] = None
    all: Annotated[bool, Option(("--all",), "Show every instant, and every cut of a run of cuts.")] = False
    measure: Annotated[
        tuple[str, ...],
        Option(
            ("--measure",),
            "Print one number: 'max abs sections.middle.M1', 'final energy.kinetic', 'at 0.5 PATH'. May be repeated.",
            "WHAT",
        ),
    ] = ()
    method: Annotated[
        str | None, Option(("--method",), "The method of integration; `heun methods` lists them.", "NAME")
    ] = None
    step: Annotated[float | None, Option(("--step",), "The step of a method of fixed step.", "SECONDS")] = None
    tolerance: Annotated[
        float | None, Option(("--tolerance",), "Error of the motion, relative to the scene.", "NUMBER")
    ] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    least_norm: Annotated[bool, Option(("--least-norm",), "Split what redundant supports leave open.")] = False
    by_cause: Annotated[
        bool, Option(("--by-cause",), "Split every load by its causes: gravity, each force, drives, motion.")
    ] = False
    axes: Annotated[
        str | None,
        Option(("--axes",), "Joint loads in the axes of the one or the other body, as it turns.", "world|from|to"),
    ] = None
    units: Annotated[
        str | None,
        Option(("--units",), "Units of tables, such as kN,mm,deg,rpm; JSON, CSV and --measure stay SI.", "UNIT,..."),
    ] = None
    strict: Annotated[bool, Option(("--strict",), "Leave with 1 if there are warnings or open reactions.")] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
    verbose: Annotated[bool, Option(("--verbose", "-v"), "Tell on standard error where the time went.")] = False


class Validate(NamedTuple):
    """Read specs and report every error of every file."""

    specs: Annotated[tuple[str, ...], Option((), "YAML files; - reads standard input.", "SPEC...")]
    time_limit_each: Annotated[float | None, TIME_LIMIT_EACH] = None
    quiet: Annotated[bool, Option(("--quiet", "-q"), "Nothing but errors.")] = False


class Model(NamedTuple):
    """Tell which model is made of a scene, and why."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, Option(("--format",), "How to write it. Default: text.", "text|json")] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    no_reduce: Annotated[bool, NO_REDUCE] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


class Modes(NamedTuple):
    """Frequencies, damping and shapes of small oscillations about the pose at rest."""

    spec: Annotated[str, SPEC]
    format: Annotated[
        str | None,
        Option(
            ("--format",),
            "How to write them. Default: by the name's end of -o FILE, else table.",
            "table|json|csv",
        ),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


class Chart(NamedTuple):
    """Speed against accuracy: methods at several tolerances or steps, which ones fail, and where."""

    spec: Annotated[str, SPEC]
    format: Annotated[
        str | None,
        Option(
            ("--format",),
            "How to write it. Default: by the name's end of -o FILE, else table.",
            "table|json|csv",
        ),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    save: Annotated[
        str | None, Option(("--save",), "Draw it there, too: chart.svg; .png and .pdf by matplotlib.", "FILE")
    ] = None
    methods: Annotated[str | None, Option(("--methods",), "These alone; heun methods lists them.", "NAME,...")] = None
    tolerances: Annotated[
        str | None, Option(("--tolerances",), "Local tolerances of adaptive methods.", "NUMBER,...")
    ] = None
    steps: Annotated[str | None, Option(("--steps",), "Steps of methods of fixed step [s].", "NUMBER,...")] = None
    set: Annotated[tuple[str, ...], SET] = ()
    time_limit: Annotated[
        float | None, Option(("--time-limit",), "After that long no run is begun; what is left is told.", "SECONDS")
    ] = None
    quiet: Annotated[bool, QUIET] = False


class Probe(NamedTuple):
    """Where a motion comes near to what methods cannot bear, with a verdict."""

    spec: Annotated[str, SPEC]
    format: Annotated[
        str | None,
        Option(("--format",), "How to write it. Default: by the name's end of -o FILE, else table.", "table|json"),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


class Check(NamedTuple):
    """Run specs, and folders of specs, against what they `expect`."""

    paths: Annotated[
        tuple[str, ...],
        Option((), "YAML files, and folders: every *.yaml below, but for folders named broken.", "PATH..."),
    ]
    format: Annotated[str | None, Option(("--format",), "How to write it. Default: table.", "table|json")] = None
    output: Annotated[str | None, OUTPUT] = None
    golden: Annotated[str | None, Option(("--golden",), "Compare with whole results kept there.", "DIR")] = None
    update: Annotated[bool, Option(("--update",), "Write the kept results anew.")] = False
    junit: Annotated[str | None, Option(("--junit",), "Write a JUnit report.", "FILE")] = None
    time_limit_each: Annotated[float | None, TIME_LIMIT_EACH] = None
    quiet: Annotated[bool, QUIET] = False


class Methods(NamedTuple):
    """List the methods of integration, and what each is for."""

    format: Annotated[
        str | None,
        Option(("--format",), "How to write it. Default: by the name's end of -o FILE, else table.", "table|json"),
    ] = None
    output: Annotated[str | None, OUTPUT] = None


class Explain(NamedTuple):
    """Show a page of the manual, or the list of its pages."""

    topic: Annotated[str | None, Option((), "The name of a page; without it, the list of them.", "TOPIC")] = None
    output: Annotated[str | None, OUTPUT] = None


Request = Run | Validate | Model | Modes | Chart | Probe | Check | Methods | Explain
COMMANDS: dict[str, type[Request]] = {
    "run": Run, "validate": Validate, "model": Model, "modes": Modes, "chart": Chart, "probe": Probe, "check": Check,
    "methods": Methods, "explain": Explain,
}  # fmt: skip
WINGS = {"modes": "modes", "chart": "charting", "probe": "probing"}  # whose commands stand in folders of their own
# seconds that a command may go on beyond its limit, to tell what it has by then; others have nothing
GRACES: dict[type[Request], float] = {Chart: 0.8}
LATER_COMMANDS = ("balance", "lagrange", "schema", "new", "sweep", "plot")
LATER_OPTIONS = ("golden", "update", "junit")


class Row(NamedTuple):
    """One option of a command: the field's name, its type, and what is said of it."""

    name: str
    type: object
    option: Option


def rows(command: type[Request]) -> list[Row]:
    """The options and arguments of a command, in their order."""
    return [Row(name, note.__origin__, note.__metadata__[0]) for name, note in command.__annotations__.items()]
