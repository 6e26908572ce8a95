"""The model as a note."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from heuncli.app.commands.model import make_document
from heuncli.output.documents.as_text import DEFAULT_WIDTH, render_text

MODEL = {
    "space": "spatial",
    "bodies": {"upper": "1 kg", "lower": "0.8 kg"},
    "joints": 2,
    "freedoms": 6,
    "grubler": 6,
    "loops": 0,
    "redundant": 0,
    "method": "DOP853",
    "reasons": ["a tree of two bodies"],
    "reduced": ["left out: third"],
    "not_reduced": ["not in the plane: gravity leaves it"],
    "cannot_tell": ["what is across the plane"],
    "integrates": ["14 numbers of state"],
    "chosen": ["lower starts as drawn " * 12],
    "moved": ["lower was moved by up to 0.02 m"],
    "notes": [],
}


def format_model(title: str, model: Mapping[str, Any]) -> str:
    return render_text(make_document(title, model))


def test_a_note_tells_the_counts_and_the_sentences() -> None:
    text = format_model("Two bars", MODEL)
    assert text.startswith("Two bars\n\n")
    for part in (
        "2: upper (1 kg), lower (0.8 kg)",
        "6 (Grübler's count: 6)",
        "no closed loops",
        "Why this model\n  - a tree of two bodies\n",
        "Simplifications\n  - left out: third\n",
        "Not simplified\n  - not in the plane: gravity leaves it\n",
        "Not covered by this model\n  - what is across the plane\n",
        "Integrated variables\n  - 14 numbers of state\n",
        "Initial values chosen by heun\n  - lower starts as drawn",
        "Moved from the given start position\n  - lower was moved by up to 0.02 m\n",
    ):
        assert part in text
    assert "Notes" not in text
    assert max(map(len, text.splitlines())) <= DEFAULT_WIDTH


def test_what_couplings_close_is_told_beside_the_loops_of_joints() -> None:
    assert "  loops      no closed loops of joints; 1 coupling\n" in format_model("", MODEL | {"couplings": 1})
    assert "  loops      2 closed loops of joints; 3 couplings" in format_model(
        "", MODEL | {"loops": 2, "couplings": 3}
    )


def test_names_are_not_listed_without_end() -> None:
    assert "... (88 more)" in format_model("", {"bodies": [f"b{i}" for i in range(100)]})
