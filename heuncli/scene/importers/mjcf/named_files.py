"""Check the files that a model names, and the counts in it, before MuJoCo acts on them.

Included or attached models are read here, by the same XML parser as the model itself, and passed on as text. MuJoCo
itself opens meshes, height fields and textures, after this module has checked that they are regular files of acceptable
size. Anything else (a pipe, a device) is refused, as it may have no end. So are counts that would make millions of
parts. Impure: reads files.
"""

from __future__ import annotations

import stat
from collections.abc import Iterator
from pathlib import Path

from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.scene.importers.xml_elements import MAX_SIZE, XmlElement, parse_xml

MODEL_ELEMENTS = frozenset({"include", "model"})  # elements that name a file of the same kind
FOLDER_ATTRIBUTES = ("meshdir", "texturedir", "assetdir")
MAX_FILES = 1000
MAX_COUNT = 10_000_000  # parts, points or pixels that one count may ask for
COUNT_ATTRIBUTES = {  # elements, and their attributes that are counts
    "replicate": ("count",), "composite": ("count",), "flexcomp": ("count",), "hfield": ("nrow", "ncol"),
    "texture": ("width", "height"), "numeric": ("size",),
    "size": ("nkey", "njmax", "nconmax", "nuserdata", "nuser_body", "nuser_jnt", "nuser_geom", "nuser_site",
             "nuser_cam", "nuser_tendon", "nuser_actuator", "nuser_sensor"),
}  # fmt: skip
COUNT_HINT = "MuJoCo would create all of them before any check"


class ModelFiles(NamedTuple):
    """folder: where file names are looked up
    models: texts of included models by their names
    """

    folder: str
    models: dict[str, bytes]


def collect_model_files(root: XmlElement, file: str) -> ModelFiles:
    """Read the models that a model includes, and check all files that it names. Raises SpecError [import-file,
    too-large, not-xml].
    """
    folder = Path() if file == STANDARD_INPUT else Path(file).parent
    included: dict[str, bytes] = {}
    queue = [(root, file, folder)]
    for element, current_file, current_folder in queue:  # the list grows during the loop
        folders = [
            folder,
            current_folder,
            *(place / name for place in (folder, current_folder) for name in _iter_folders(element)),
        ]
        for inner, count in _iter_elements(element):
            _require_countable(inner, count, current_file)
            name = inner.attributes.get("file")
            if not name:
                continue
            found_path = next((path for place in folders if (path := place / name).exists()), None)
            if found_path is None:
                continue  # MuJoCo reports a missing file, with the line
            _require_readable(found_path, inner, current_file)
            if inner.tag in MODEL_ELEMENTS and name not in included:
                if len(included) >= MAX_FILES:
                    raise _make_error("too-large", inner, current_file, f"more than {MAX_FILES:,} files", COUNT_HINT)
                included[name] = _read_model(found_path, inner, current_file)
                queue.append((parse_xml(included[name], str(found_path)), str(found_path), found_path.parent))
    return ModelFiles(str(folder.absolute()), included)


def _read_model(path: Path, element: XmlElement, file: str) -> bytes:
    """Read the text of a model as specs are read, which also protects it from being overwritten by the output."""
    try:
        return bytes(read_bytes(str(path), MAX_SIZE))
    except Finding as finding:
        raise _make_error(finding.code, element, file, finding.message, finding.hint) from None


def _iter_elements(root: XmlElement) -> Iterator[tuple[XmlElement, int]]:
    """Yield all elements, each with the number of copies that the replicas around it make."""
    queue = [(root, 1)]
    for element, count in queue:
        own_count = count * _count_parts(element, COUNT_ATTRIBUTES.get(element.tag, ()))
        yield element, own_count
        inner_count = own_count if element.tag == "replicate" else count
        queue += [(inner, inner_count) for inner in element.children]


def _count_parts(element: XmlElement, attributes: tuple[str, ...]) -> int:
    """Return the product of an element's counts; of `size`, the largest. MuJoCo itself refuses what is no number."""
    counts = []
    for attribute in attributes:
        attribute_count = 1
        for word in element.attributes.get(attribute, "").split():
            attribute_count *= max(1, int(float(word))) if _is_number(word) else 1
        counts.append(attribute_count)
    if element.tag == "size":
        return max(counts, default=1)
    product = 1
    for count in counts:
        product *= count
    return product


def _is_number(word: str) -> bool:
    try:
        return abs(float(word)) < 1e300
    except ValueError:
        return False


def _iter_folders(root: XmlElement) -> Iterator[str]:
    for compiler in root.find_all("compiler"):
        yield from (compiler.attributes[name] for name in FOLDER_ATTRIBUTES if name in compiler.attributes)


def _require_countable(element: XmlElement, count: int, file: str) -> None:
    if count > MAX_COUNT:
        message = f"<{element.tag}> requests {count:,}; at most {MAX_COUNT:,} are allowed"
        raise _make_error("too-large", element, file, message, COUNT_HINT)


def _require_readable(path: Path, element: XmlElement, file: str) -> None:
    try:
        file_status = path.stat()
    except (OSError, ValueError):
        return
    name = escape(element.attributes["file"])
    if not stat.S_ISREG(file_status.st_mode):
        raise _make_error("import-file", element, file, f"{name} is not a regular file", "give the name of a file")
    if file_status.st_size > MAX_SIZE:
        raise _make_error("too-large", element, file, f"{name} has more than {MAX_SIZE:,} bytes", "use a coarser mesh")


def _make_error(code: str, element: XmlElement, file: str, message: str, hint: str) -> SpecError:
    return SpecError(Problem(code, message, SourceLocation(file, element.line, element.column), hint))
