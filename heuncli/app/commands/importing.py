"""`heun import FILE`: convert another program's model to a spec, validate it, and write it."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Annotated

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import OUTPUT, QUIET, TIME_LIMIT, Option
from heuncli.app.cli.output import emit, print_stderr
from heuncli.app.cli.target import require_other_file
from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.files import STDOUT
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import reset_effort, suggest
from heuncli.base.text_safety import escape
from heuncli.base.units import DENSITY
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.quantity import Scope, read_number
from heuncli.scene.file_format.reading import STANDARD_INPUT, digest, read_bytes
from heuncli.scene.importers.description import ImportOptions
from heuncli.scene.importers.readers import ModelReader, find_reader
from heuncli.scene.importers.spec_text import format_spec
from heuncli.scene.importers.xml_elements import MAX_SIZE, parse_xml


class ImportRequest(NamedTuple):
    """The options and arguments of `heun import`."""

    file: Annotated[str, Option((), "Model file; - reads standard input.", "FILE")]
    output: Annotated[str | None, OUTPUT] = None
    base: Annotated[
        str | None, Option(("--base",), "Root body fixed to the ground (default), or free.", "fixed|free")
    ] = None
    free: Annotated[bool, Option(("--free",), "Leave the joints free; by default drives lock them.")] = False
    limits: Annotated[bool, Option(("--limits",), "With --free: convert joint limits to stops.")] = False
    density: Annotated[
        str | None,
        Option(("--density",), "Density of the shapes of bodies without inertia, such as '2700 kg/m^3'.", "NUMBER"),
    ] = None
    repair: Annotated[str | None, Option(("--repair",), "Faults to repair, each noted in a comment.", "FAULT,...")] = (
        None
    )
    keyframe: Annotated[
        str | None, Option(("--keyframe",), "MuJoCo: keyframe that gives the start position.", "NAME")
    ] = None
    model: Annotated[str | None, Option(("--model",), "SDF: model of a world with several.", "NAME")] = None
    strict: Annotated[bool, Option(("--strict",), "Fail if something has no counterpart.")] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


BASES = ("fixed", "free")
OPTION_WORDS = {  # option of each field of ImportAsked
    "free": "--free", "base_free": "--base", "limits": "--limits", "density": "--density", "repair": "--repair",
    "keyframe": "--keyframe", "model": "--model",
}  # fmt: skip
FAILED = 1


def main(request: ImportRequest) -> int:
    """Run the command; returns the exit code."""
    options = _parse_options(request)
    target = request.output
    if target is not None and target != STDOUT:
        from heuncli.app.cli.target import require_writable  # with NumPy, which is not needed to read a model

        require_writable(target)
    require_other_file(target, [request.file], kind="model")
    content = _read_content(request.file)
    require_other_file(target, [request.file], kind="model")  # again by its identity, now that it is open
    reset_effort()
    root = parse_xml(content, request.file)
    reader = find_reader(root, request.file)
    _require_supported(request, options, reader)
    machine = reader.read_machine(content, request.file, root, options, digest(content))
    require_other_file(target, [request.file], kind="model")  # nor one of the files that it includes
    for problem in () if request.quiet and not request.strict else machine.left_out:
        print_stderr(f"warning: {problem}")
    if request.strict and machine.left_out:
        print_stderr(f"heun: --strict: {len(machine.left_out)} without a counterpart; nothing is written")
        return FAILED
    name = _choose_name(target, request.file)
    text = format_spec(machine, name)
    warnings = _validate_spec(text, name)
    for warning in () if request.quiet else warnings:
        print_stderr(f"warning: {warning}")
    emit(text, target)
    if target is not None and target != STDOUT and not request.quiet:
        print_stderr(f"heun: {escape(target)} written; next: heun run {escape(target)}")
    return 0


def _read_content(file: str) -> bytes:
    """Read the bytes of the model. Raises SpecError."""
    try:
        return bytes(read_bytes(file, MAX_SIZE))
    except Finding as finding:
        raise SpecError(Problem(finding.code, finding.message, SourceLocation(file, 1, 1), finding.hint)) from None


def _choose_name(target: str | None, file: str) -> str:
    """Return the name of the spec: its file, or on standard output a name derived from the model's."""
    if target is not None and target != STDOUT:
        return target
    stem = file.replace("\\", "/").rpartition("/")[2].rpartition(".")[0] if file != STANDARD_INPUT else ""
    return f"{stem or 'robot'}.yaml"


def _validate_spec(text: str, name: str) -> list[str]:
    """Validate the spec that was made; returns its warnings. Raises SpecError if its numbers exceed the range of
    computation.
    """
    try:
        return [*map(str, load(name, text=text).warnings)]
    except SpecError as error:
        if all(problem.code == "magnitude" for problem in error.problems):
            raise SpecError(*(problem._replace(location=None) for problem in error.problems)) from None
        raise RuntimeError(f"the converted spec is invalid: {error}") from None


def _parse_options(request: ImportRequest) -> ImportOptions:
    """Parse what is converted and how: base, freedoms, limits, density, repairs. Raises UsageError."""
    if request.base is not None and request.base not in BASES:
        hint = suggest(request.base, BASES, "values")
        raise UsageError(Problem("bad-option", f"--base {request.base}: accepted: {', '.join(BASES)}", hint=hint))
    if request.limits and not request.free:
        message = "--limits: a joint locked by a drive cannot reach a stop"
        raise UsageError(
            Problem("bad-option", message, hint="use it with --free; comments list the limits in any case")
        )
    words = [word.strip() for word in request.repair.split(",")] if request.repair is not None else []
    density = _parse_density(request.density) if request.density is not None else None
    return ImportOptions(
        request.free, request.base == "free", request.limits, density, frozenset(words), request.keyframe, request.model
    )


def _parse_density(text: str) -> float:
    """Parse a density [kg/m^3]. Raises UsageError."""
    hint = "for example --density 2700, in kg/m^3, or '2.7 g/cm^3'"
    try:
        value = read_number(text, DENSITY, Scope({}))
    except Finding as finding:
        raise UsageError(Problem("bad-option", f"--density: {finding.message}", hint=hint)) from None
    if not (math.isfinite(value) and value > 0.0):
        raise UsageError(Problem("bad-option", f"--density {text}: expected more than 0", hint=hint))
    return value


def _require_supported(request: ImportRequest, options: ImportOptions, reader: ModelReader) -> None:
    """Raise UsageError for options that this format does not support."""
    given_fields = {field for field, value in options._asdict().items() if value} | (
        {"base_free"} if request.base else set()
    )
    unsupported = [
        OPTION_WORDS[field] for field in OPTION_WORDS if field in given_fields and field not in reader.options
    ]
    if unsupported:
        message = f"{', '.join(unsupported)}: not available for {reader.form}"
        raise UsageError(Problem("bad-option", message, hint="leave it out"))
    _require_repairs(options.repair, reader.repairs)


def _require_repairs(words: Collection[str], supported: Collection[str]) -> None:
    """Raise UsageError for a repair that this format does not know."""
    for word in sorted(words):
        if word not in supported:
            hint = suggest(word, supported, "faults")
            raise UsageError(Problem("bad-option", f"--repair {word}: accepted: {', '.join(supported)}", hint=hint))
