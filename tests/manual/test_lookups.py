"""What somebody new asks is found in two lookups: a word leads to a page, and the answer stands there."""

from __future__ import annotations

import re

import pytest

from heuncli.app.commands.explain.command import PAGES, find_in_index
from tests.shared.manual import TEXTS, below

QUESTIONS = [
    # the question, the word that is looked up, the page, the heading, the answer
    ("an inertia tensor with deviation moments?", "deviation", "format", "Bodies", "In a tensor the element is −D"),
    ("what does side do?", "side", "format", "Sections", "`before` cuts just before it"),
    ("how is a rope made?", "rope", "format", "Joints", "A rope is a `rod` with `tension_only`"),
    ("the unit of a torsion damper?", "torsion damper", "format", "damper", "N·m·s for rotation in a `ball`, `pin`"),
    ("one number into a shell variable?", "shell variable", "commands", "Measure", "load=$(heun run"),
    ("the sign of N?", "N", "signs", "Sections", "along n (> 0: tension)"),
    ("what is open?", "open", "open", "Open reactions", "heun prints `open`"),
    ("how to change a parameter?", "parameter", "commands", "heun run", '`--set n="3000 rpm"`'),
    ("bearing loads in the rotating ring's axes?", "ring", "signs", "Joints", "`--axes to` gives force and moment"),
    (
        "the exit code for a broken YAML?",
        "exit code",
        "commands",
        "Exit codes",
        "no YAML is a bad spec: 2",
    ),
    ("what is ? in a table?", "?", "accuracy", "Digits", "`?` is what the error reaches"),
    ("the torque of a motor?", "motor", "results", "Paths", "`joints.JOINT.drive`"),
    ("how to start with an angle?", "initial angle", "format", "Initial", "as assembled"),
    ("how to end at an event?", "until", "format", "Conditions", "`until`** ends the motion"),
    ("a hinge?", "revolute", "format", "Joints", "rotation about `axis`"),
    ("a dashpot between two points?", "dashpot", "format", "spring", "`damping`"),
    ("the default tolerance?", "tolerance", "format", "Analysis", "1e-9"),
    ("which way does e1 point?", "first_axis", "format", "Sections", "Of a bar along x it is y"),
    ("where is the coefficient of friction?", "mu", "format", "friction", "Coulomb's friction"),
    ("a load of wind?", "wind", "format", "distributed", "linear between"),
]


@pytest.mark.parametrize(
    ("word", "topic", "heading", "answer"), [row[1:] for row in QUESTIONS], ids=[row[0] for row in QUESTIONS]
)
def test_two_lookups_find_the_answer(word: str, topic: str, heading: str, answer: str) -> None:
    assert word in PAGES or re.search(rf"heun explain {topic} \([^)]*\b{re.escape(heading)}\b", find_in_index(word)), (
        find_in_index(word)
    )
    start, end = below(TEXTS[topic], heading)
    assert answer in " ".join(TEXTS[topic][start:end].split())
