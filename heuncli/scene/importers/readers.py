"""Which reader a file needs, by its root element: a row each; what is read by none is refused by name.

A reader is found by its name when it is asked for, and with it what it needs:

    described(content, file, root, asked, sha256) -> DescribedMachine
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from heuncli.base.errors import Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import nearest
from heuncli.scene.importers.asked import ImportAsked
from heuncli.scene.importers.described import DescribedMachine
from heuncli.scene.importers.xml_elements import BEGINS, XACRO, XmlElement


class ModelReader(NamedTuple):
    """A format: its root element and name; the module of its reader; the fields of ImportAsked that it knows.

    repairs: the words of --repair.
    """

    root: str
    form: str
    module: str
    asks: frozenset[str]
    repairs: tuple[str, ...] = ()

    def described(
        self, content: bytes, file: str, root: XmlElement, asked: ImportAsked, sha256: str
    ) -> DescribedMachine:
        """The machine that a file of this format describes. Raises SpecError."""
        read: Callable[..., DescribedMachine] = import_module(f"heuncli.scene.importers.{self.module}").described
        return read(content, file, root, asked, sha256)


READERS = (
    ModelReader(
        "robot",
        "URDF",
        "urdf.reader",
        frozenset({"free", "base_free", "limits", "density", "repair"}),
        ("massless", "negative", "right-angles", "triangle", "zero"),
    ),
    ModelReader("mujoco", "MJCF", "mjcf.reader", frozenset({"free", "limits", "keyframe"})),
)
ELSEWHERE = {  # root elements of formats that are not read, and what to do
    "sdf": "SDF is not read: export the model as URDF",
    "gazebo": "SDF is not read: export the model as URDF",
    "COLLADA": "this is a mesh: the URDF that names it is read",
    "collada": "this is a mesh: the URDF that names it is read",
    "OpenSimDocument": "OpenSim is not read",
    "mujocoinclude": "this is a part of a model: name the file that includes it",
}


def reader_of(root: XmlElement, file: str) -> ModelReader:
    """The reader of a file. Raises SpecError where there is none."""
    for reader in READERS:
        if root.tag == reader.root:
            return reader
    place = SourceLocation(file, root.line, root.column)
    known = {reader.root: reader for reader in READERS}
    meant = nearest(root.tag, known)
    hint = ELSEWHERE.get(root.tag) or (f"did you mean <{meant}>?" if meant else BEGINS)
    if root.tag.startswith("xacro:"):
        hint = XACRO
    forms = " or ".join(f"<{reader.root}> ({reader.form})" for reader in READERS)
    message = f"the root element is <{root.tag}>; read are {forms}"
    raise SpecError(Problem("import-format", message, place, hint))
