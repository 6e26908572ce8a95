"""Select the reader of a model file by its root element. Known formats that have no reader are refused by name.

Each format is a row. Its reader module, and whatever that needs, is imported when it is used:

    read_model(content, file, root, options, sha256) -> DescribedMachine
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from heuncli.base.errors import Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import find_similar
from heuncli.scene.importers.description import DescribedMachine, ImportOptions
from heuncli.scene.importers.xml_elements import ROOT_HINT, XmlElement, make_xacro_hint


class ModelReader(NamedTuple):
    """A format that can be imported.

    root: the tag of the root element
    form: the name of the format
    module: the module of the reader, within this package
    options: the fields of ImportOptions that it supports
    repairs: the faults that --repair can name
    """

    root: str
    form: str
    module: str
    options: frozenset[str]
    repairs: tuple[str, ...] = ()

    def read_machine(
        self, content: bytes, file: str, root: XmlElement, options: ImportOptions, sha256: str
    ) -> DescribedMachine:
        """Read the machine from a file of this format. Raises SpecError."""
        read: Callable[..., DescribedMachine] = import_module(f"heuncli.scene.importers.{self.module}").read_model
        return read(content, file, root, options, sha256)


READERS = (
    ModelReader(
        "robot",
        "URDF",
        "urdf.reader",
        frozenset({"free", "base_free", "limits", "density", "repair"}),
        ("massless", "negative", "point", "right-angles", "shape", "triangle", "zero"),
    ),
    ModelReader(
        "sdf",
        "SDF",
        "sdf.reader",
        frozenset({"free", "base_free", "limits", "density", "repair", "model"}),
        ("massless", "negative", "right-angles", "triangle", "zero"),
    ),
    ModelReader("mujoco", "MJCF", "mjcf.reader", frozenset({"free", "limits", "keyframe"})),
)
UNREAD_FORMATS = {  # root elements of known formats without a reader, and a hint
    "gazebo": "this is SDF 1.0: convert it with gz sdf -p OLD > NEW",
    "COLLADA": "this is a mesh: give the URDF that uses it",
    "collada": "this is a mesh: give the URDF that uses it",
    "OpenSimDocument": "OpenSim models cannot be read",
    "mujocoinclude": "this is only a part of a model: give the file that includes it",
}


def find_reader(root: XmlElement, file: str) -> ModelReader:
    """Find the reader of a file by its root element. Raises SpecError [import-format]."""
    for reader in READERS:
        if root.tag == reader.root:
            return reader
    place = SourceLocation(file, root.line, root.column)
    known = {reader.root: reader for reader in READERS}
    suggestion = find_similar(root.tag, known)
    hint = UNREAD_FORMATS.get(root.tag) or (f"did you mean <{suggestion}>?" if suggestion else ROOT_HINT)
    if root.tag.startswith("xacro:"):
        hint = make_xacro_hint(file)
    forms = " or ".join(f"<{reader.root}> ({reader.form})" for reader in READERS)
    message = f"the root element is <{root.tag}>; readable are {forms}"
    raise SpecError(Problem("import-format", message, place, hint))
