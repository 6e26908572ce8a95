"""A form of load cases is a module that writes it, and a row."""

from __future__ import annotations

from pathlib import Path

from tests.contributing.addition import Addition, Edit, after, heun

PLAIN = Addition(
    "An FE deck",
    {
        "heuncli/output/fe_decks/decks.py": (
            after('    Deck("abaqus", "abaqus"),\n', '    Deck("plain", "plain"),\n'),
        ),
        "heuncli/app/commands/export.py": (Edit('"calculix", "abaqus")', '"calculix", "abaqus", "plain")'),),
    },
    {
        "heuncli/output/fe_decks/plain.py": '''"""Load cases as plain lines: the acceleration, a block a case."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.output.fe_decks.decks import DeckNames, DeckNodes
from heuncli.output.fe_decks.decks import format_exact, iter_header
from heuncli.analyses.load_cases.model import LoadCases

MARK = "!"


def write_plain(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """The text in pieces."""
    yield from iter_header(cases, DeckNodes(cases, names), MARK, "Points are tied by hand.", ("Field is g - a.",))
    for k, case in enumerate(cases.cases, start=1):
        yield f"Case {k}\\n"
        for axis, a in enumerate(case.field.linear.tolist(), start=1):
            yield f"  Field {axis} = {format_exact(-a)}\\n"
        yield "End\\n"


def list_plain_notes(cases: LoadCases, names: DeckNames) -> list[str]:
    """What no card says."""
    return ["turning is left out"]
''',
        "hanging.yaml": """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies: {bar: {mass: 2, center: [0, 0, -1], inertia: [1, 1, 0], points: {top: [0, 0, 0]}}}
joints: {top: {type: ball, from: ground.O, to: bar.top}}
""",
    },
)


def test_a_form(tmp_path: Path) -> None:
    """It is written, with what the deck says of itself, and its notes are told."""
    done = heun(PLAIN.made_in(tmp_path), "export", "loads", "hanging.yaml", "--format", "plain")
    assert done.returncode == 0
    assert done.stdout.startswith("! Load cases of the body bar\n")
    assert "Case 1\n  Field 1 = 0.0\n  Field 2 = 0.0\n" in done.stdout
    assert "  Field 3 = -9.81\nEnd\n" in done.stdout
    assert "heun: turning is left out" in done.stderr


def test_its_list() -> None:
    assert PLAIN.is_as_listed()
