"""What a new user asks is found by one word: `heun explain WORD` leads to the section with the answer."""

from __future__ import annotations

import pytest

from heuncli.app.commands.explain.lookup import find_places
from heuncli.app.commands.explain.pages import PAGES, find_section
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
        "not YAML is a bad spec: 2",
    ),
    ("what is ? in a table?", "?", "accuracy", "Digits", "`?`: the error is as large as the number"),
    ("the torque of a motor?", "motor", "results", "Paths", "`joints.JOINT.drive`"),
    ("how to start with an angle?", "initial angle", "format", "Initial", "as assembled"),
    ("how to end at an event?", "until", "format", "Conditions", "`until`** ends the motion"),
    ("a hinge?", "revolute", "format", "Joints", "rotation about `axis`"),
    ("a dashpot between two points?", "dashpot", "format", "spring", "`damping`"),
    ("the default tolerance?", "tolerance", "format", "Analysis", "1e-9"),
    ("which way does e1 point?", "first_axis", "format", "Sections", "For a bar along x it is y"),
    ("where is the coefficient of friction?", "mu", "format", "friction", "Coulomb's friction"),
    ("a load of wind?", "wind", "format", "distributed", "linear between"),
]


@pytest.mark.parametrize(
    ("word", "topic", "heading", "answer"), [row[1:] for row in QUESTIONS], ids=[row[0] for row in QUESTIONS]
)
def test_one_lookup_finds_the_answer(word: str, topic: str, heading: str, answer: str) -> None:
    places = find_places(word)
    assert word in PAGES or heading in [place.heading for place in places if place.page == topic], places
    start, end = below(TEXTS[topic], heading)
    assert answer in " ".join(TEXTS[topic][start:end].split())


@pytest.mark.parametrize("word", sorted({row[1] for row in QUESTIONS} - {*PAGES}))
def test_each_place_that_is_shown_exists(word: str) -> None:
    for place in find_places(word):
        assert place.path or not place.heading or find_section(place.page, place.heading), place
