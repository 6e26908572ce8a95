"""`heun model`: describe which mechanical model is made of a scene, and why."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from heuncli.app.cli.documents import render_document
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import CASE, NO_REDUCE, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, VIEW, WIDTH, Option
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import load_spec, print_warnings
from heuncli.app.cli.target import choose_format, require_other_file
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import OutputDocument, Sentence
from heuncli.output.tables.run_description import make_description_parts
from heuncli.scene.file_format.models import Spec
from heuncli.study.workflow import describe


class ModelRequest(NamedTuple):
    """The options and arguments of `heun model`."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, Option(("--format",), "Output format. Default: text.", "text|json")] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    sketch: Annotated[bool, Option(("--sketch",), "Add a text drawing of the assembled machine.")] = False
    view: Annotated[str | None, VIEW] = None
    width: Annotated[int | None, WIDTH] = None
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


FORMATS = ("text", "json")


def main(request: ModelRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    require_sketch(request, form)
    spec = load_spec(request)
    require_other_file(request.output, [request.spec])
    model: Mapping[str, Any] = describe(spec, reduce=not request.no_reduce)
    pieces = [*render_document(make_document(spec.title, model), form, request.output)]
    if request.sketch:
        pieces += ["\n", render_sketch(spec, request)]
    emit(pieces, request.output)
    print_warnings(spec, None, request.quiet)
    return 0


def make_document(title: str, model: Mapping[str, Any]) -> OutputDocument:
    """Make the document of the model block."""
    parts = [Sentence(title or "untitled"), *make_description_parts(model, label_indent="  ")]
    return OutputDocument(parts=parts, make_block=lambda: dict(model))


def require_sketch(request: ModelRequest, form: str) -> None:
    """Raise UsageError before the work for options that do not go with a drawing, or only with one."""
    if request.sketch and form != "text":
        message = f"--sketch is a text drawing, not available in {form}"
        raise UsageError(
            Problem("bad-option", message, hint="heun plot SPEC scene -o x.svg draws the machine to a file")
        )
    drawing_options = [
        name for name, value in (("--view", request.view), ("--width", request.width)) if value is not None
    ]
    if drawing_options and not request.sketch:
        message = f"{', '.join(drawing_options)}: only for a drawing, which is not requested"
        raise UsageError(Problem("bad-option", message, hint="add --sketch"))
    if request.view is not None:
        from heuncli.app.cli.figure_output import require_view

        require_view(request.view)


def render_sketch(spec: Spec, request: ModelRequest) -> str:
    """Render the drawing of the assembled machine as text. Raises UsageError, and SolveError if it does not close."""
    from heuncli.app.cli.figure_output import render_text, require_width  # rarely used
    from heuncli.output.figures.scenes import make_assembly_figure
    from heuncli.study.model.setup import attach_locations

    require_width(request.width)
    with attach_locations(spec):
        figure = make_assembly_figure(spec, request.view)
    return render_text(figure._replace(title=""), request.width, request.output)
