"""Rules about members, as shapes and as properties of sections: known profiles, and measures that make a section."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from heuncli.base.errors import Finding
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.members import find_ends, find_member, find_section_measures, is_member
from heuncli.scene.file_format.profiles import find_profile
from heuncli.scene.file_format.rotations import are_parallel
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule


def iter_findings(draft: DraftDocument, code: str) -> Iterator[Violation]:
    """Yield what is wrong with the members, as far as it has this code."""
    checks: list[tuple[Path_, Callable[[], object]]] = []
    for name, body in draft.document.bodies.items():
        for i, shape in enumerate(body.shapes or ()):
            path: Path_ = ("bodies", name, "shapes", i)
            names = [key for key in ("profile", "to_profile") if getattr(shape, key, None) is not None]
            checks += [((*path, key), partial(find_profile, getattr(shape, key))) for key in names]
            if is_member(shape):
                checks.append((path, partial(find_member, shape)))
    for name, section in draft.document.sections.items():
        if section.properties is not None and not isinstance(section.properties, str):
            checks.append((("sections", name, "properties"), partial(find_section_measures, section.properties)))
    found: dict[Path_, Violation] = {}
    for path, check in checks:
        try:
            check()
        except Finding as finding:
            if finding.code == code and not any(earlier[: len(path)] == path for earlier in found):
                found[path] = Violation(path, finding.message, finding.hint)
    yield from found.values()


@rule("unknown-profile")
def check_profile_names(draft: DraftDocument) -> Iterator[Violation]:
    """A profile is in the tables, or has its measures in its name."""
    yield from iter_findings(draft, "unknown-profile")


@rule("member-form")
def check_member_form(draft: DraftDocument) -> Iterator[Violation]:
    """The walls and radii of a member fit into it, and its width is across its axis."""
    yield from iter_findings(draft, "member-form")
    for name, body in draft.document.bodies.items():
        for i, shape in enumerate(body.shapes or ()):
            if not isinstance(shape, fs.MemberShape | fs.ProfileShape) or shape.first_axis is None:
                continue
            start, end = find_ends(shape)
            axis = (end[0] - start[0], end[1] - start[1], end[2] - start[2])
            if not any(axis) or not any(shape.first_axis):
                continue
            if are_parallel(shape.first_axis, axis):
                hint = "give one across the member: only its component across is used"
                path = ("bodies", name, "shapes", i, "first_axis")
                yield Violation(path, "first_axis points along the member", hint)
