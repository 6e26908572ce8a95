"""Options that change a spec once it is read: `--title` and `--label PATH=TEXT` for its readers, and `--without`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

from heuncli.base.errors import Finding, Problem, UsageError
from heuncli.base.spelling import suggest
from heuncli.scene.file_format.labels import check_plain_text
from heuncli.scene.file_format.models import Spec, format_case_title
from heuncli.study.quantities.captions import parse_path

if TYPE_CHECKING:
    from collections.abc import Iterator

EXAMPLE = "for example --label joints.main='Main bearing'"


class CaptionRequest(Protocol):
    """A request with the options of captions."""

    @property
    def title(self) -> str | None: ...
    @property
    def label(self) -> Sequence[str]: ...


def apply_captions(spec: Spec, request: CaptionRequest) -> Spec:
    """Return a spec with the title and the labels of the command line. Raises UsageError with all that is wrong."""
    if request.title is None and not request.label:
        return spec
    title = spec.title
    if request.title is not None:
        title = format_case_title(check_text("--title", request.title), spec.case, spec.cases)
    return spec._replace(title=title, labels={**spec.labels, **_parse_labels(request.label, spec)})


def apply_captions_to_cases(cases: Mapping[str, Spec], request: CaptionRequest) -> dict[str, Spec]:
    """Return load cases with the title and the labels of the command line. Raises UsageError."""
    return {name: apply_captions(spec, request) for name, spec in cases.items()}


def check_text(option: str, text: str) -> str:
    """Return the text of an option as it is shown. Raises UsageError."""
    try:
        return check_plain_text(text)
    except Finding as finding:
        raise UsageError(Problem("bad-option", f"{option}: {finding.message}", hint=finding.hint)) from None


def _parse_labels(words: Sequence[str], spec: Spec) -> dict[str, str]:
    """Parse the words PATH=TEXT. Raises UsageError with all that is wrong."""
    labels: dict[str, str] = {}
    problems: list[Problem] = []
    for word in words:
        path, equals, text = word.partition("=")
        if not equals:
            problems.append(Problem("bad-option", f"--label {word}: expected PATH=TEXT", hint=EXAMPLE))
            continue
        try:
            labels[_find_label_path(path.strip(), spec)] = check_text(f"--label {path}", text)
        except UsageError as error:
            problems += error.problems
    if problems:
        raise UsageError(*problems)
    return labels


def _find_label_path(path: str, spec: Spec) -> str:
    """Return the path under which a label is kept, for a path as users write it. Raises UsageError."""
    paths = dict(iter_label_paths(spec))
    found = paths.get(path)
    if found is not None:
        return found
    parts = parse_path(path)
    if parts is not None and (not parts.names or any(path.startswith(f"{known}.") for known in paths.values())):
        return path  # of one quantity
    same_names = [known for known in paths if known.endswith(f".{path}")]
    hint = f"did you mean {', or '.join(same_names)}?" if same_names else suggest(path, paths, "paths")
    raise UsageError(Problem("unknown-path", f"--label {path}: nothing in the spec has this name", hint=hint))


def iter_label_paths(spec: Spec) -> Iterator[tuple[str, str]]:
    """Yield everything that has a name: the path as users write it, and the path under which its label is kept.

    Points have two paths, as in the spec and as in the results.
    """
    from heuncli.scene.file_format.labels import BLOCKS, EVENTS, GROUND, POINTS
    from heuncli.scene.file_format.names import collect_scene_names

    names = collect_scene_names(spec)
    yield GROUND, GROUND
    for block, kept_block in {**BLOCKS, EVENTS: EVENTS}.items():
        yield from ((f"{block}.{name}", f"{kept_block}.{name}") for name in names.entries[block])
    for owner, points in names.points.items():
        prefix = GROUND if owner == GROUND else f"bodies.{owner}"
        for point in points:
            kept = f"{POINTS}.{owner}.{point}"
            yield from ((kept, kept), (f"{prefix}.{POINTS}.{point}", kept))


def find_excluded(spec: Spec, words: Sequence[str]) -> tuple[str, ...]:
    """Return the entries that the words name, as `forces.push`. Raises UsageError with every name that is unknown or
    ambiguous.
    """
    names = [name.strip() for word in words for name in word.split(",")]
    matches = [find_entries(spec, name) for name in names]
    problems = [
        make_problem(spec, name, entries) for name, entries in zip(names, matches, strict=True) if len(entries) != 1
    ]
    if problems:
        raise UsageError(*problems)
    return tuple(dict.fromkeys(entries[0] for entries in matches))


def list_excludable(spec: Spec) -> list[str]:
    """List all forces and drives, as `forces.push`."""
    return [*(f"forces.{name}" for name in spec.forces), *(f"drives.{name}" for name in spec.drives)]


def find_entries(spec: Spec, name: str) -> list[str]:
    """Return the entries with a name, given with or without its block."""
    return [entry for entry in list_excludable(spec) if name in (entry, entry.partition(".")[2])]


def make_problem(spec: Spec, name: str, matches: Sequence[str]) -> Problem:
    """Make the problem of a name that no entry has, or two."""
    if matches:
        message = f"--without {name}: {' and '.join(matches)} have this name"
        return Problem(
            "bad-option", message, hint=f"give {' or '.join(matches)}; or both: --without {','.join(matches)}"
        )
    if not list_excludable(spec):
        return Problem("bad-option", f"--without {name}: the model has no forces or drives", hint="leave it out")
    plain = [entry.partition(".")[2] for entry in list_excludable(spec)]
    hint = suggest(name, list_excludable(spec) if "." in name else plain, "forces and drives")
    return Problem("bad-option", f"--without {name}: no force or drive has this name", hint=hint or "")
