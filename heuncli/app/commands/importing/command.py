"""`heun import FILE`: another program's model, said in the words of a spec; written once it is seen to be one."""

from __future__ import annotations

import math
from collections.abc import Collection

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit, say
from heuncli.app.commands.importing.request import ImportRequest
from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.files import STDOUT
from heuncli.base.foreign_text import shown
from heuncli.base.nearest import begin_file, did_you_mean
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.digest import digest
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.quantity import Scope, number
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.scene.importers.asked import ImportAsked
from heuncli.scene.importers.readers import ModelReader, reader_of
from heuncli.scene.importers.spec_text import spec_text
from heuncli.scene.importers.xml_elements import LARGEST, read_elements

BASES = ("fixed", "free")
OF_OPTIONS = {  # fields of ImportAsked, by the options that ask for them
    "free": "--free", "base_free": "--base", "limits": "--limits", "density": "--density", "repair": "--repair",
    "keyframe": "--keyframe",
}  # fmt: skip
FAILED = 1


def main(request: ImportRequest) -> int:
    """Run the command; returns the exit code."""
    asked = _asked(request)
    target = request.output
    if target is not None and target != STDOUT:
        from heuncli.app.cli.target import require_room  # with NumPy, which is not needed to read a model

        require_room(target)
    require_other_file(target, [request.file], are="model")
    content = _content(request.file)
    require_other_file(target, [request.file], are="model")  # by what it is, too, now that it is open
    begin_file()
    root = read_elements(content, request.file)
    reader = reader_of(root, request.file)
    _require_known(request, asked, reader)
    machine = reader.described(content, request.file, root, asked, digest(content))
    require_other_file(target, [request.file], are="model")  # nor into what it includes
    for problem in () if request.quiet and not request.strict else machine.left_out:
        say(f"warning: {problem}")
    if request.strict and machine.left_out:
        say(f"heun: --strict: {len(machine.left_out)} without a counterpart; nothing is written")
        return FAILED
    name = _name_of(target, request.file)
    text = spec_text(machine, name)
    warnings = _validated(text, name)
    for warning in () if request.quiet else warnings:
        say(f"warning: {warning}")
    emit(text, target)
    if target is not None and target != STDOUT and not request.quiet:
        say(f"heun: {shown(target)} written; next: heun run {shown(target)}")
    return 0


def _content(file: str) -> bytes:
    """The bytes of the model. Raises SpecError."""
    try:
        return bytes(read_bytes(file, LARGEST))
    except Finding as finding:
        raise SpecError(Problem(finding.code, finding.message, SourceLocation(file, 1, 1), finding.hint)) from None


def _name_of(target: str | None, file: str) -> str:
    """What the spec is called: as it is written; on standard output, as one would save it."""
    if target is not None and target != STDOUT:
        return target
    stem = file.replace("\\", "/").rpartition("/")[2].rpartition(".")[0] if file != STANDARD_INPUT else ""
    return f"{stem or 'robot'}.yaml"


def _validated(text: str, name: str) -> list[str]:
    """The warnings of the spec that was made. Raises SpecError where its numbers are beyond what is computed with."""
    try:
        return [*map(str, load(name, text=text).warnings)]
    except SpecError as error:
        if all(problem.code == "magnitude" for problem in error.problems):
            raise SpecError(*(problem._replace(location=None) for problem in error.problems)) from None
        raise RuntimeError(f"the spec that was made is none: {error}") from None


def _asked(request: ImportRequest) -> ImportAsked:
    """What the options ask for. Raises UsageError."""
    if request.base is not None and request.base not in BASES:
        hint = did_you_mean(request.base, BASES, "values")
        raise UsageError(Problem("bad-option", f"--base {request.base}: known: {', '.join(BASES)}", hint=hint))
    if request.limits and not request.free:
        message = "--limits: a joint that a drive holds runs against no stop"
        raise UsageError(Problem("bad-option", message, hint="with --free; the limits stand in comments either way"))
    words = [word.strip() for word in request.repair.split(",")] if request.repair is not None else []
    density = _density(request.density) if request.density is not None else None
    return ImportAsked(
        request.free, request.base == "free", request.limits, density, frozenset(words), request.keyframe
    )


def _density(text: str) -> float:
    """A density [kg/m^3]. Raises UsageError."""
    hint = "such as --density 2700, in kg/m^3, or '2.7 g/cm^3'"
    try:
        value = number(text, parse_unit("kg/m^3")[1], Scope({}))
    except Finding as finding:
        raise UsageError(Problem("bad-option", f"--density: {finding.message}", hint=hint)) from None
    if not (math.isfinite(value) and value > 0.0):
        raise UsageError(Problem("bad-option", f"--density {text}: expected more than 0", hint=hint))
    return value


def _require_known(request: ImportRequest, asked: ImportAsked, reader: ModelReader) -> None:
    """Raise UsageError for what this format knows nothing of."""
    given = {field for field, value in asked._asdict().items() if value} | ({"base_free"} if request.base else set())
    idle = [OF_OPTIONS[field] for field in OF_OPTIONS if field in given and field not in reader.asks]
    if idle:
        message = f"{', '.join(idle)}: not for {reader.form}"
        raise UsageError(Problem("bad-option", message, hint="leave it out"))
    _require_repairs(asked.repair, reader.repairs)


def _require_repairs(words: Collection[str], known: Collection[str]) -> None:
    for word in sorted(words):
        if word not in known:
            hint = did_you_mean(word, known, "faults")
            raise UsageError(Problem("bad-option", f"--repair {word}: known: {', '.join(known)}", hint=hint))
