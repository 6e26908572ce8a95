"""The files that a model of MuJoCo's names, and the counts in it, looked at before MuJoCo acts on them.

Models that it includes or attaches are read here, by the same reader of XML as the model itself, and handed over as
text; meshes, height fields and textures MuJoCo opens itself, once they are seen to be files of a size that can be read.
What is no regular file (a pipe, a device) is refused: it may have no end. So is what makes millions of parts by a
count. Impure: reads files.
"""

from __future__ import annotations

import stat
from collections.abc import Iterator
from pathlib import Path

from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.foreign_text import shown
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.scene.importers.xml_elements import LARGEST, XmlElement, read_elements

MODELS = frozenset({"include", "model"})  # elements that name a file of the same kind
FOLDERS = ("meshdir", "texturedir", "assetdir")
MOST_FILES = 1000
MOST = 10_000_000  # parts, points or pixels that one count may ask for
COUNTS = {  # elements, and the attributes whose numbers count what is made of them
    "replicate": ("count",), "composite": ("count",), "flexcomp": ("count",), "hfield": ("nrow", "ncol"),
    "texture": ("width", "height"), "numeric": ("size",),
    "size": ("nkey", "njmax", "nconmax", "nuserdata", "nuser_body", "nuser_jnt", "nuser_geom", "nuser_site",
             "nuser_cam", "nuser_tendon", "nuser_actuator", "nuser_sensor"),
}  # fmt: skip
MANY = "MuJoCo makes them all before anything is said of them"


class ModelFiles(NamedTuple):
    """folder: where names of files are looked up; included: texts of models by their names."""

    folder: str
    included: dict[str, bytes]


def named_files(root: XmlElement, file: str) -> ModelFiles:
    """The files that a model names. Raises SpecError: no regular file, too large, no XML, a count too large."""
    folder = Path() if file == STANDARD_INPUT else Path(file).parent
    included: dict[str, bytes] = {}
    waiting = [(root, file, folder)]
    for element, its_file, its_folder in waiting:  # which grows as it is walked
        folders = [folder, its_folder, *(place / name for place in (folder, its_folder) for name in _folders(element))]
        for inner, makes in _all(element):
            _require_countable(inner, makes, its_file)
            name = inner.attributes.get("file")
            if not name:
                continue
            found = next((path for place in folders if (path := place / name).exists()), None)
            if found is None:
                continue  # MuJoCo says so, with the line
            _require_readable(found, inner, its_file)
            if inner.tag in MODELS and name not in included:
                if len(included) >= MOST_FILES:
                    raise _refused("too-large", inner, its_file, f"more than {MOST_FILES:,} files", MANY)
                included[name] = _content(found, inner, its_file)
                waiting.append((read_elements(included[name], str(found)), str(found), found.parent))
    return ModelFiles(str(folder.absolute()), included)


def _content(path: Path, element: XmlElement, file: str) -> bytes:
    """The text of a model, read as specs are: so it is known to the output, which must not go there."""
    try:
        return bytes(read_bytes(str(path), LARGEST))
    except Finding as finding:
        raise _refused(finding.code, element, file, finding.message, finding.hint) from None


def _all(root: XmlElement) -> Iterator[tuple[XmlElement, int]]:
    """All elements, and how many of each the replicas around it make."""
    waiting = [(root, 1)]
    for element, makes in waiting:
        own = makes * _product(element, COUNTS.get(element.tag, ()))
        yield element, own
        inside = own if element.tag == "replicate" else makes
        waiting += [(inner, inside) for inner in element.inner]


def _product(element: XmlElement, attributes: tuple[str, ...]) -> int:
    """The largest, or for two sides the product, of the counts; what is no number MuJoCo refuses by itself."""
    numbers = []
    for attribute in attributes:
        of_one = 1
        for word in element.attributes.get(attribute, "").split():
            of_one *= max(1, int(float(word))) if _is_number(word) else 1
        numbers.append(of_one)
    if element.tag == "size":
        return max(numbers, default=1)
    product = 1
    for number in numbers:
        product *= number
    return product


def _is_number(word: str) -> bool:
    try:
        return abs(float(word)) < 1e300
    except ValueError:
        return False


def _folders(root: XmlElement) -> Iterator[str]:
    for compiler in root.all("compiler"):
        yield from (compiler.attributes[name] for name in FOLDERS if name in compiler.attributes)


def _require_countable(element: XmlElement, makes: int, file: str) -> None:
    if makes > MOST:
        message = f"<{element.tag}> asks for {makes:,}; at most {MOST:,} are made"
        raise _refused("too-large", element, file, message, MANY)


def _require_readable(path: Path, element: XmlElement, file: str) -> None:
    try:
        found = path.stat()
    except (OSError, ValueError):
        return
    name = shown(element.attributes["file"])
    if not stat.S_ISREG(found.st_mode):
        raise _refused("import-file", element, file, f"{name} is no regular file", "name a file")
    if found.st_size > LARGEST:
        raise _refused("too-large", element, file, f"{name} has more than {LARGEST:,} bytes", "a coarser mesh will do")


def _refused(code: str, element: XmlElement, file: str, message: str, hint: str) -> SpecError:
    return SpecError(Problem(code, message, SourceLocation(file, element.line, element.column), hint))
