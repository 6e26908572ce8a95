"""An error of a spec is a rule with its code and a broken spec."""

from __future__ import annotations

from pathlib import Path

from tests.contributing.addition import Addition, Edit, heun

LONG_TITLE = Addition(
    "An error",
    {
        "heuncli/scene/file_format/rules/every.py": (Edit("    stops,\n)\n", "    stops,\n    titles,\n)\n"),),
    },
    {
        "heuncli/scene/file_format/rules/titles.py": '''"""Titles."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule

MOST = 60  # letters: with what stands before it a title is a line of a page


@rule("long-title")
def long_title(draft: DraftDocument) -> Iterator[Violation]:
    """A title is one line."""
    if len(draft.document.head.title) > MOST:
        yield Violation(("title",), f"the title has more than {MOST} letters", "say the rest in a comment")
''',
        "long-title.yaml": f"""\
# code: long-title at 4:8
# see: titles are one line
heun: 1
title: {"a crank, " * 10}
bodies: {{a: {{mass: 4, center: [0, 0, 0], inertia: [1, 1, 1]}}}}
# cure: {"a crank, " * 10} => a crank
""",
    },
)


def test_an_error(tmp_path: Path) -> None:
    """It is told at its place, with its code and its hint, and ends the command with the exit code of a wrong spec."""
    done = heun(LONG_TITLE.made_in(tmp_path), "validate", "long-title.yaml")
    assert done.returncode == 2
    assert "long-title.yaml:4:8: title: the title has more than 60 letters [long-title]" in done.stderr
    assert "hint: say the rest in a comment" in done.stderr


def test_its_list() -> None:
    assert LONG_TITLE.is_as_listed()
