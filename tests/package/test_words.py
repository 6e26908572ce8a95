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
PREPOSITIONS = set(
    [
        "of",
        "by",
        "at",
        "on",
        "to",
        "as",
        "over",
        "from",
        "in",
        "with",
        "within",
        "without",
        "beside",
        "besides",
        "beyond",
        "under",
        "above",
        "below",
        "between",
        "across",
        "along",
        "around",
        "behind",
        "among",
        "against",
        "into",
        "onto",
        "off",
        "out",
        "up",
        "down",
        "than",
        "through",
        "about",
        "after",
        "before",
        "during",
        "per",
        "for",
        "like",
        "near",
        "past",
        "since",
        "toward",
        "towards",
        "until",
        "upon",
        "via",
        "aside",
        "apart",
        "anew",
        "ahead",
    ]
)
PARTICIPLES = set(
    [
        "told",
        "asked",
        "kept",
        "given",
        "found",
        "made",
        "known",
        "seen",
        "met",
        "held",
        "taken",
        "left",
        "shown",
        "said",
        "written",
        "drawn",
        "solved",
        "begun",
        "gone",
        "done",
        "sent",
        "built",
        "bound",
        "felt",
        "got",
        "had",
        "heard",
        "hidden",
        "laid",
        "led",
        "lent",
        "lost",
        "meant",
        "paid",
        "sought",
        "sold",
        "shot",
        "spent",
        "stood",
        "struck",
        "taught",
        "thought",
        "understood",
        "won",
        "worn",
        "wound",
        "chosen",
        "driven",
        "fallen",
        "grown",
        "thrown",
        "torn",
        "swept",
        "spun",
        "counted",
    ]
)
PRIVATE_WORDS = set(
    [
        "told",
        "tell",
        "tells",
        "telling",
        "asked",
        "asker",
        "asking",
        "anew",
        "beside",
        "beyond",
        "happening",
        "happenings",
        "said",
        "say",
        "says",
        "lent",
        "lend",
        "lends",
        "stands",
        "standing",
        "hang",
        "hangs",
        "hung",
        "rub",
        "rubs",
        "rubbing",
        "astray",
        "aside",
        "apart",
    ]
)
ENDS_IN_ED = {"speed", "seed", "need", "embed", "exceed", "feed", "proceed"}  # and is no participle
# Keys that users see: of the file format, of JSON, of options, of the interface to Python.
KEYS: dict[str, set[str]] = {}


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
    is_participle = word in PARTICIPLES or (len(word) > 4 and word.endswith("ed") and word not in ENDS_IN_ED)
    return "a participle" if is_participle and kind != "class" else ""


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
    found = [(full or module, find_fault(name, kind)) for kind, name, full in named]
    return [f"{module}: {full} is {fault}" for full, fault in found if fault and full not in KEYS.get(module, ())]


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
