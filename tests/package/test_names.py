"""A class name has one meaning in the whole package."""

from __future__ import annotations

import ast
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

import heuncli
from heuncli.multibody.reduction.compose import STEPS

pytestmark = pytest.mark.heavy  # texts alone, which are those of both kernels

ROOT = Path(heuncli.__file__).parent
# Names of structs of the kernel that are those of what they are rows of: the field's word for it, on both sides.
OF_THE_KERNEL = {
    "Body": "scene/file_format/models.py: a rigid body; kernel/scene.py: its row in the tree",
    "Contact": "multibody/tree/layout.py: a rope or limit that opens and closes; kernel/scene.py: its margin in a step",
    "Freedom": "multibody/tree/layout.py: a freedom of a joint, its place in the state; kernel/scene.py: its row",
    "Island": "multibody/tree/layout.py: loops that share bodies; kernel/scene.py: their rows and freedoms",
    "Method": "motion/integration/methods/method.py: a method by its coefficients; kernel/stepping.py: these in memory",
}


@cache
def classes() -> dict[str, list[str]]:
    """The files that define a class, by its name."""
    found = defaultdict(list)
    for path in sorted(ROOT.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if "class " in text else ():
            if isinstance(node, ast.ClassDef):
                found[node.name].append(path.relative_to(ROOT).as_posix())
    return found


def test_a_class_name_has_one_meaning() -> None:
    several = {name: files for name, files in classes().items() if len(files) > 1}
    assert {name: files for name, files in several.items() if name not in OF_THE_KERNEL} == {}


def test_what_two_classes_share_is_a_name_of_the_kernel() -> None:
    found = classes()
    for name, why in OF_THE_KERNEL.items():
        assert len(found[name]) == 2 and sum(file.startswith("kernel/") for file in found[name]) == 1, name
        assert all(file in why for file in found[name]), name


def test_the_steps_of_reduction_stand_where_they_are_looked_for() -> None:
    assert [
        name for name, _ in STEPS if not (ROOT / "multibody" / "reduction" / f"{name.replace('.', '/')}.py").exists()
    ] == []
