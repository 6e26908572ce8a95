"""What no function, class, field, parameter or module may be called: prepositions, bare participles, private words.

The glossary of the page on developing has the words of the field. A function is a verb and its object, a parameter a
noun; a name such as `of`, `told` or `beside` says neither.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import heuncli

PACKAGE = Path(heuncli.__file__).parent
PREPOSITIONS = {
    "of", "by", "at", "on", "to", "as", "over", "from", "in", "with", "within", "without", "beside", "besides",
    "beyond", "under", "above", "below", "between", "across", "along", "around", "behind", "among", "against", "into",
    "onto", "off", "out", "up", "down", "than", "through", "about", "after", "before", "during", "per", "for", "like",
    "near", "past", "since", "toward", "towards", "until", "upon", "via", "aside", "apart", "anew", "ahead",
}  # fmt: skip
PARTICIPLES = {  # of functions also every other one in -ed
    "told", "asked", "kept", "given", "found", "made", "known", "seen", "met", "held", "taken", "shown", "said",
    "written", "drawn", "solved", "begun", "gone", "done", "sent", "built", "bound", "felt", "got", "had", "heard",
    "hidden", "laid", "led", "lent", "lost", "meant", "paid", "sought", "sold", "shot", "spent", "stood", "struck",
    "taught", "thought", "understood", "won", "worn", "wound", "chosen", "driven", "fallen", "grown", "thrown",
    "torn", "swept", "spun", "counted",
}  # fmt: skip
PRIVATE_WORDS = {
    "told", "tell", "tells", "telling", "ask", "asked", "asker", "asking", "anew", "beside", "happening",
    "happenings", "said", "say", "says", "lent", "lend", "lends", "stands", "standing", "hang", "hangs", "hung",
    "rub", "rubs", "rubbing", "astray", "aside", "apart",
}  # fmt: skip
ENDS_IN_ED = {"speed", "seed", "need", "embed", "exceed", "feed", "proceed"}  # and is no participle
# Fields of these files are names that users write or read: keys of specs, options, JSON; so are those of requests.
FILES_OF_KEYS = re.compile(
    r"scene/file_format/(format\w*|entries|fields|models|loads|couplings|segment_entries)\.py|app/python/\w+\.py"
    r"|analyses/(balancing/results|lagrange/study)\.py"
)
# Others that strings refer to, or whose name a protocol of Python's prescribes.
KEPT = {
    "analyses/load_cases/model.py": {"PointAction.at"},
    "analyses/tolerance_analysis.py": {"Contribution.below", "Contribution.above"},
    "app/api.py": {"solve(at)", "solve_cases(at)"},
    "app/commands/sweep/as_columns.py": {"ByteSink.tell"},
    "app/python/signals.py": {"Signal.computed", "Signal.beyond", "Signal.at"},
    "app/python/solved_scene.py": {"Solved.paths(under)", "Solved.at", "Solved.load_cases(at)", "Solved.plot(over)"},
    "base/named_tuples.py": {"named"},
    "kernel/scene.py": {"Freedom.driven"},
    "output/snapshots/golden_file.py": {"EventSnapshot.to"},
    "analyses/lagrange/coordinates.py": {"choose_coordinates(driven)", "group_coordinates(driven)"},
    "results/results.py": {"JointBlock.chosen"},
    "scene/expressions/scope.py": {"Scope.given"},
    "scene/file_format/entries.py": {"Entry.before"},
    "scene/file_format/format.py": {"ExpectEntry.before"},
    "scene/file_format/format_couplings.py": {"CamEntry.before"},
    "scene/importers/mjcf/reader.py": {"described"},
    "scene/importers/sdf/reader.py": {"described"},
    "scene/importers/urdf/reader.py": {"described"},
    "study/queries/curves.py": {"CurveComparison.at"},
    "study/compose/recovery.py": {"Recovery.resolution"},
}


def find_fault(name: str, kind: str) -> str:
    """What is wrong with a name; "" if nothing is."""
    parts = [part.lower() for part in re.split(r"_|(?<=[a-z])(?=[A-Z])", name) if part]
    if private := PRIVATE_WORDS & set(parts):
        return f"{private.pop()} is a private word"
    if len(parts) != 1:
        return ""
    word = parts[0]
    if word in PREPOSITIONS:
        return "a preposition"
    ends_in_ed = len(word) > 4 and word.endswith("ed") and word not in ENDS_IN_ED
    is_participle = (word in PARTICIPLES and kind != "class") or (ends_in_ed and kind == "function")
    return "a participle" if is_participle else ""


def iter_names(tree: ast.AST, owner: str = "") -> Iterator[tuple[str, str, str]]:
    """Kind, name, and the same with the names of what it is in."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef):
            full = f"{owner}{node.name}"
            yield "function", node.name, full
            parameters = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
            yield from (("parameter", one.arg, f"{full}({one.arg})") for one in parameters)
            yield from iter_names(node, f"{full}.")
        elif isinstance(node, ast.ClassDef):
            yield "class", node.name, f"{owner}{node.name}"
            yield from iter_names(node, f"{owner}{node.name}.")
        elif isinstance(node, ast.AnnAssign) and isinstance(tree, ast.ClassDef) and isinstance(node.target, ast.Name):
            yield "field", node.target.id, f"{owner}{node.target.id}"
        else:
            yield from iter_names(node, owner)


def faults(text: str, module: str) -> list[str]:
    """The names of a module that are none."""
    named = [("module", Path(module).stem, ""), *iter_names(ast.parse(text))]
    if FILES_OF_KEYS.fullmatch(module):
        named = [one for one in named if one[0] != "field"]
    if module.startswith("app/commands/"):
        named = [one for one in named if one[0] != "field" or "Request." not in one[2]]
    found = [(full or module, find_fault(name, kind)) for kind, name, full in named]
    return [f"{module}: {full} is {fault}" for full, fault in found if fault and full not in KEPT.get(module, ())]


@pytest.mark.parametrize("package", sorted(path.name for path in PACKAGE.iterdir() if (path / "__init__.py").exists()))
def test_names_are_words_of_the_field(package: str) -> None:
    files = sorted((PACKAGE / package).rglob("*.py"))
    assert len(files) > 5
    found = [
        line
        for path in files
        for line in faults(path.read_text(encoding="utf-8"), path.relative_to(PACKAGE).as_posix())
    ]
    assert found == []


def test_a_private_word_would_be_seen() -> None:
    text = (
        "class Told: ...\ndef beside(of: int, asked_rows: int) -> None: ...\ndef find_speed(speed: int) -> None: ...\n"
    )
    assert [line.split(": ")[1].split(" is ")[0] for line in faults(text, "telling/kept.py")] == [
        "telling/kept.py", "Told", "beside", "beside(of)", "beside(asked_rows)",
    ]  # fmt: skip
