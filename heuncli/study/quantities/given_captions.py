"""The title and labels that a user gives at the command line or in Python, in place of those of a spec."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from heuncli.base.errors import Finding, Problem, UsageError
from heuncli.base.spelling import suggest
from heuncli.scene.file_format.labels import check_plain_text
from heuncli.scene.file_format.models import Spec, format_case_title
from heuncli.study.quantities.captions import parse_path

OPTIONS = ("--title", "--label")  # the words before what is wrong
ARGUMENTS = ("title", "labels")


def set_captions(
    spec: Spec, title: str | None, labels: Iterable[tuple[str, str]], names: tuple[str, str] = ARGUMENTS
) -> Spec:
    """Return a spec with another title, and with labels for paths as users write them.

    names: of title and labels, for messages

    Raises UsageError with all that is wrong.
    """
    problems: list[Problem] = []
    found: dict[str, str] = {}
    shown = spec.title
    try:
        if title is not None:
            shown = format_case_title(check_text(names[0], title), spec.case, spec.cases)
    except UsageError as error:
        problems += error.problems
    for path, text in labels:
        try:
            found[_find_label_path(path, spec, names[1])] = check_text(f"{names[1]} {path}", text)
        except UsageError as error:
            problems += error.problems
    if problems:
        raise UsageError(*problems)
    return spec._replace(title=shown, labels={**spec.labels, **found})


def check_text(option: str, text: str) -> str:
    """Return the text of an option as it is shown. Raises UsageError."""
    try:
        return check_plain_text(text)
    except Finding as finding:
        raise UsageError(Problem("bad-option", f"{option}: {finding.message}", hint=finding.hint)) from None


def _find_label_path(path: str, spec: Spec, option: str) -> str:
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
    raise UsageError(Problem("unknown-path", f"{option} {path}: nothing in the spec has this name", hint=hint))


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
