"""A format of models is a reader in a folder of its own, and a row."""

from __future__ import annotations

from pathlib import Path

from tests.contributing.addition import Addition, after, heun

BOBS = Addition(
    "An importer",
    {
        "heuncli/scene/importers/readers.py": (
            after("READERS = (\n", '    ModelReader("bobs", "Bobs", "bobs.reader", frozenset()),\n'),
        ),
    },
    {
        "heuncli/scene/importers/bobs/__init__.py": "",
        "heuncli/scene/importers/bobs/reader.py": '''"""Bobs on strings, each about a hook -> a described machine."""

from __future__ import annotations

from heuncli.scene.importers.description import ImportOptions
from heuncli.scene.importers.description import DescribedBody, DescribedEntry, DescribedMachine, DescribedPoint
from heuncli.scene.importers.description import format_original_name, assign_names
from heuncli.scene.importers.xml_elements import XmlElement
from heuncli.base.errors import Problem, SourceLocation
from heuncli.scene.file_format.models import ZERO

NONE = (ZERO, ZERO, ZERO)


def read_model(_content: bytes, file: str, root: XmlElement, _asked: ImportOptions, sha256: str) -> DescribedMachine:
    """The machine that a file of bobs describes."""
    wanted = [bob.attributes["name"] for bob in root.children]
    names = assign_names("bob", wanted)
    bodies, joints, left_out = [], [], []
    for bob, name, its in zip(root.children, names, wanted, strict=True):
        mass, length = (float(bob.attributes[key]) for key in ("mass", "length"))
        points = (DescribedPoint("hook", ZERO),)
        remark = format_original_name("bob", name, its)
        bodies.append(DescribedBody(name, mass, (0.0, 0.0, -length), NONE, points, remark=remark))
        joints.append(DescribedEntry(name, {"type": "ball", "from": "ground.hook", "to": f"{name}.hook"}))
        if "colour" in bob.attributes:
            place = SourceLocation(file, bob.line, bob.column, f"bob {its}")
            left_out.append(Problem("import-left-out", "its colour is not taken over", place, "delete it"))
    return DescribedMachine(
        "Bobs", "Bobs", file, sha256, (0.0, 0.0, -9.81), tuple(bodies), (DescribedPoint("hook", ZERO),),
        joints=tuple(joints), left_out=tuple(left_out),
    )  # fmt: skip
''',
        "two.xml": """\
<bobs>
  <bob name="a b" mass="2" length="1" colour="red"/>
  <bob name="c" mass="1" length="2"/>
</bobs>
""",
    },
)


def test_a_format(tmp_path: Path) -> None:
    """What is read is written as a spec that runs; names are made valid; what is left out is told."""
    folder = BOBS.made_in(tmp_path)
    done = heun(folder, "import", "two.xml")
    assert done.returncode == 0
    assert done.stderr.startswith("warning: two.xml:2:3: bob a b: its colour is not taken over [import-left-out]\n")
    assert '  a_b: # bob "a b"\n    mass: 2\n' in done.stdout
    assert heun(folder, "run", "-", "--measure", "joints.a_b.force.z", text=done.stdout).stdout == "19.62\n"


def test_its_list() -> None:
    assert BOBS.is_as_listed()
