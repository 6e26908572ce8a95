"""`heun plot`: draw a figure of solved scenes, modes, orders or sweeps.

Its words are files first, then a kind of figure and its paths; the kind decides which options apply.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path, PurePath

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.figure_output import render_text, require_figure_form, require_width
from heuncli.app.cli.options import list_fields
from heuncli.app.cli.output import emit, save
from heuncli.app.cli.target import parse_units, require_other_file
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import PlotTarget
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import find_similar
from heuncli.output.drawing.drawing_files import encode_drawing
from heuncli.output.drawing.figure import Figure
from heuncli.study.quantities.captions import check_text


def main(request: PlotRequest) -> int:
    """Run the command; returns the exit code."""
    target = parse_words(request.words)
    require_applicable_options(target.kind, request)
    require_other_file(request.output, target.files)
    form = require_figure_form(request.output, "-o") if request.output is not None else None
    require_width(request.width)
    parse_units(request.units)  # raises UsageError before the work
    module = import_module(f"heuncli.app.commands.plot.{KINDS[target.kind].module}")
    figure: Figure = getattr(module, f"draw_{target.kind}")(target, request)
    title = request.captions.title
    if title is not None:
        figure = figure._replace(title=check_text("--title", title))
    if form is None or request.output is None:
        emit(render_text(figure, request.width), None)
        return 0
    from heuncli.output.drawing.layout import lay_out

    save(encode_drawing(lay_out(figure), form), request.output)
    return 0


class FigureKind(NamedTuple):
    """A kind of figure.

    module: where the function that draws it is, `draw_` and its name
    what: its name in messages
    options: the fields of the request that apply to it, besides COMMON_OPTIONS
    """

    module: str
    what: str
    options: tuple[str, ...]


COMMON_OPTIONS = ("words", "output", "width", "title", "time_limit", "quiet")
SCENE_OPTIONS = ("set", "label", "case")
SOLVER_OPTIONS = (*SCENE_OPTIONS, "method", "step", "tolerance", "no_reduce", "least_norm")
KINDS = {
    "history": FigureKind("curves", "numbers over time", ("x", "measured", "axes", "units", *SOLVER_OPTIONS)),
    "sections": FigureKind("curves", "section diagrams", ("at", "tension_side", "units", *SOLVER_OPTIONS)),
    "polar": FigureKind("curves", "polar diagrams", ("axes", "view", "units", *SOLVER_OPTIONS)),
    "scene": FigureKind("machines", "scenes", ("at", "view", "units", *SOLVER_OPTIONS)),
    "modes": FigureKind("machines", "mode shapes", ("view", "without", *SCENE_OPTIONS)),
    "balance": FigureKind("machines", "harmonics by orders", ("units", *SCENE_OPTIONS)),
    "sweep": FigureKind("sweep", "sweeps", ("units",)),
}


def require_applicable_options(kind: str, request: PlotRequest) -> None:
    """Raise UsageError with every option that has no effect on this kind of figure."""
    problems = list(_iter_problems(kind, request))
    if problems:
        raise UsageError(*problems)


def _iter_problems(kind: str, request: PlotRequest) -> Iterator[Problem]:
    """Yield the problems of the given options."""
    figure_kind = KINDS[kind]
    for field in list_fields(PlotRequest):
        name = field.name
        if name in (*COMMON_OPTIONS, *figure_kind.options) or field.read_value(request) == field.default:
            continue
        others = [other.what for other in KINDS.values() if name in other.options]
        message = f"{field.option.words[0]} has no effect on {figure_kind.what}"
        yield Problem("bad-option", message, hint=f"leave it out: it applies to {', '.join(others)}")
    if request.output is not None and request.width is not None:
        yield Problem("bad-option", "--width applies to text drawings, not to files", hint="leave it out, or -o FILE")


SPECS, SWEEPS = (".yaml", ".yml"), (".sqlite", ".csv", ".db")
USAGE = "for example heun plot engine.yaml joints.main.force, or heun plot engine.yaml scene"
DEFLECTION_WORDS = 2  # of deflection.w1; a third is the number of a cut
PATH_KINDS, SWEEP_KIND = ("history", "sections"), "sweep"  # kinds that follow from the paths or files
NAMED_KINDS = tuple(kind for kind in KINDS if kind not in (*PATH_KINDS, SWEEP_KIND))


def parse_words(words: Sequence[str]) -> PlotTarget:
    """Split the words into files, the kind of figure, and paths. Raises UsageError."""
    files = [word for k, word in enumerate(words) if _is_file(word, first=k == 0)]
    others = [word for word in words if word not in files]
    if not files:
        raise _make_error("no spec is given", USAGE)
    if not all(words):
        raise _make_error("an empty argument", USAGE)
    sweep_files = [file for file in files if _find_ending(file) in SWEEPS]
    if sweep_files:
        if len(sweep_files) < len(files):
            raise _make_error(f"{', '.join(files)}: specs and sweeps cannot share one plot", "call it once for each")
        return PlotTarget(files, SWEEP_KIND, others)
    if not others:
        raise _make_error("no quantity or kind of plot is given", USAGE)
    kinds = [word for word in others if word in NAMED_KINDS]
    if len(kinds) > 1 or (kinds and kinds[0] != others[0]):
        raise _make_error(f"{', '.join(others)}: one kind of plot at a time", "call it once for each")
    return PlotTarget(files, kinds[0] if kinds else _choose_path_kind(others), others[len(kinds) :])


def _choose_path_kind(paths: Sequence[str]) -> str:
    """Return the kind for paths: diagrams for whole sections, histories for numbers over time. Raises UsageError."""
    entries = [path for path in paths if path.startswith("sections.") and _is_along_bar(path.split(".")[2:])]
    if entries and len(entries) < len(paths):
        other = next(path for path in paths if path not in entries)
        message = f"{entries[0]} is a diagram along a bar, {other} a number over time: one kind of plot at a time"
        raise _make_error(message, f"call it once for each; over time, for example, {entries[0]}.N")
    suggestion = find_similar(paths[0], NAMED_KINDS) if "." not in paths[0] else None
    if suggestion is not None:
        raise _make_error(f"'{paths[0]}' is not a kind of plot", f"did you mean {suggestion}?")
    return "sections" if entries else "history"


def _is_along_bar(words: Sequence[str]) -> bool:
    """Return whether the words of a path behind sections.NAME name curves along a bar: all, or of its deflection."""
    return not words or (words[0] == "deflection" and len(words) <= DEFLECTION_WORDS)


def _is_file(word: str, *, first: bool) -> bool:
    """Return whether a word names a file: by its ending, or for the first word also because the file exists."""
    return word == STDOUT or _find_ending(word) in (*SPECS, *SWEEPS) or (first and _exists(word))


def _find_ending(word: str) -> str:
    """Return the ending of a name; for one sweep of a store, such as sweep.sqlite:2, the store's ending."""
    name, colon, number = word.rpartition(":")
    return PurePath(name if colon and number.isdecimal() else word).suffix.lower()


def _exists(word: str) -> bool:
    """Return whether a file or folder of that name exists; False for an impossible name."""
    try:
        return word != "" and Path(word).exists()
    except (OSError, ValueError):
        return False


def _make_error(message: str, hint: str) -> UsageError:
    """Make the error of a wrong word."""
    return UsageError(Problem("bad-option", f"plot: {message}", hint=hint))
