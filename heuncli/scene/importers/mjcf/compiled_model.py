"""Compile a model by MuJoCo itself, and name and locate its parts in the file.

Only MuJoCo's own reader knows defaults, includes, classes, frames, replicas, and the masses of meshes; any other reader
would read another machine. Its errors are reported as heun's. The compiled model holds arrays by kind: `jnt_axis` has
one row for each joint. Impure: reads the file and the files it names, and sets MuJoCo's handler of warnings, which
would otherwise write a file into the working folder.

The files that a model names, and the counts in it, are checked before MuJoCo acts on them. Included or attached models
are read here, by the same XML parser as the model itself, and passed on as text. MuJoCo itself opens meshes, height
fields and textures, after this module has checked that they are regular files of acceptable size. Anything else (a
pipe, a device) is refused, as it may have no end. So are counts that would make millions of parts. Impure: reads files.
"""

from __future__ import annotations

import re
import stat
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.scene.importers.xml_elements import MAX_SIZE, XmlElement, parse_xml

# Named files

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
    """What a model's text may name.

    folder: where file names are looked up
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
    paths: dict[str, Path] = {}
    queue = [(root, file, folder)]
    for element, current_file, current_folder in queue:  # the list grows during the loop
        model_folders = [folder, current_folder]  # in MuJoCo's order
        asset_folders = [place / name for place in model_folders for name in _iter_folders(element)]
        for inner, count in _iter_elements(element):
            _require_countable(inner, count, current_file)
            name = inner.attributes.get("file")
            if not name:
                continue
            folders = model_folders if inner.tag in MODEL_ELEMENTS else [*model_folders, *asset_folders]
            found_path = next((path for place in folders if (path := place / name).exists()), None)
            if found_path is None:
                continue  # MuJoCo reports a missing file, with the line
            _require_readable(found_path, inner, current_file)
            if paths.setdefault(name, found_path).resolve() != found_path.resolve() and inner.tag in MODEL_ELEMENTS:
                message = f"{escape(name)} is the name of two files: {paths[name]} and {found_path}"
                raise _make_error("import-file", inner, current_file, message, "rename one of them, and its <include>")
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


# Compiled model

MIN_VERSION = (3, 3)  # the first version whose MjSpec accepts included models as texts
INSTALL_COMMAND = 'pip install "heuncli[mujoco]"'
LINE_NUMBER = re.compile(r"\bline(?: number)?[ =](\d+)", re.IGNORECASE)
PART_KINDS = {  # names of a kind: in MuJoCo's arrays, in MjSpec, in mjtObj
    "body": ("body", "bodies", "mjOBJ_BODY"),
    "joint": ("jnt", "joints", "mjOBJ_JOINT"),
    "site": ("site", "sites", "mjOBJ_SITE"),
    "geom": ("geom", "geoms", "mjOBJ_GEOM"),
    "equality": ("eq", "equalities", "mjOBJ_EQUALITY"),
    "tendon": ("tendon", "tendons", "mjOBJ_TENDON"),
    "actuator": ("actuator", "actuators", "mjOBJ_ACTUATOR"),
    "flex": ("flex", "flexes", "mjOBJ_FLEX"),
    "keyframe": ("key", "keys", "mjOBJ_KEY"),
}


class CompiledModel(NamedTuple):
    """A compiled model.

    lines: for each kind, the line in the file of each part, where MuJoCo reports it
    warning_texts: texts of MuJoCo's warnings
    """

    mujoco: Any
    model: Any
    file: str
    lines: dict[str, dict[int, int]]
    warning_texts: tuple[str, ...] = ()

    def count(self, kind: str) -> int:
        """Return the number of parts of a kind."""
        prefix = PART_KINDS[kind][0]
        return int(getattr(self.model, f"n{prefix}"))

    def name(self, kind: str, number: int) -> str:
        """Return the name of a part in the file, or an empty text."""
        return self.mujoco.mj_id2name(self.model, getattr(self.mujoco.mjtObj, PART_KINDS[kind][2]), number) or ""

    def describe_part(self, kind: str, number: int) -> str:
        """Name a part within a sentence: by its name, else by its number."""
        name = self.name(kind, number)
        return f"{kind} {name!r}" if name else f"{kind} number {number}"

    def location(self, kind: str, number: int) -> SourceLocation | None:
        """Return the location of a part in the file, if MuJoCo reports it."""
        line = self.lines.get(kind, {}).get(number)
        return None if line is None else SourceLocation(self.file, line, 1)

    def is_disabled(self, *flags: str) -> bool:
        """Return whether any of these flags of `option/flag` disables its part of the mechanics."""
        members = self.mujoco.mjtDisableBit.__members__
        bits = sum(int(members[f"mjDSBL_{flag}"]) for flag in flags if f"mjDSBL_{flag}" in members)
        return bool(self.model.opt.disableflags & bits)


def compile_model(content: bytes, file: str, named_files: ModelFiles) -> CompiledModel:
    """Compile a model. file: its name in messages. Raises SpecError [missing-extra, not-xml, import-mjcf]."""
    mujoco = _import_mujoco(file)
    warning_texts: list[str] = []
    mujoco.set_mju_user_warning(lambda text: warning_texts.append(str(text)))
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            spec = mujoco.MjSpec.from_string(_decode(content, file), include=dict(named_files.models))
            spec.modelfiledir = named_files.folder
            model = spec.compile()
    except (MemoryError, SpecError):
        raise
    except Exception as error:  # mostly ValueError; the bindings also raise their own types
        raise SpecError(_compile_problem(str(error), file)) from None
    warning_texts += [str(warning.message) for warning in caught]
    lines = {} if named_files.models else _find_lines(spec)  # with several files MuJoCo does not say which one
    return CompiledModel(mujoco, model, file, lines, tuple(dict.fromkeys(warning_texts)))


def _import_mujoco(file: str) -> Any:
    try:
        import mujoco
    except ImportError:
        message = f"{file} is a MuJoCo model; reading it needs the package mujoco, which is not installed"
        raise SpecError(Problem("missing-extra", message, hint=f"install it: {INSTALL_COMMAND}")) from None
    if tuple(map(int, str(mujoco.__version__).split(".")[:2])) < MIN_VERSION:
        oldest = ".".join(map(str, MIN_VERSION))
        message = f"{file}: the package mujoco has version {mujoco.__version__}; {oldest} or later is needed"
        raise SpecError(Problem("missing-extra", message, hint=f"upgrade it: {INSTALL_COMMAND} --upgrade"))
    return mujoco


def _decode(content: bytes, file: str) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        message = "the file is not in UTF-8, the only encoding that MuJoCo reads"
        raise SpecError(Problem("not-xml", message, SourceLocation(file, 1, 1), "save it as UTF-8")) from None


def _compile_problem(text: str, file: str) -> Problem:
    """Turn MuJoCo's error message into a problem: one sentence with its location."""
    found = LINE_NUMBER.search(text)
    reason = " ".join(text.split()).removeprefix("Error: ").removeprefix("XML Error: ").removeprefix("Error: ")
    reason = re.sub(r"Element name '', id \d+, |,? ?line \d+$", "", reason).rstrip(", ")
    line = max(int(found[1]), 1) if found else 1
    message = f"MuJoCo cannot compile it: {reason}"
    return Problem(
        "import-mjcf", message, SourceLocation(file, line, 1), "MuJoCo alone reports the same error for this file"
    )


def _find_lines(spec: Any) -> dict[str, dict[int, int]]:
    return {kind: dict(_iter_part_lines(getattr(spec, several, ()))) for kind, (_, several, _) in PART_KINDS.items()}


def _iter_part_lines(parts: Any) -> Iterator[tuple[int, int]]:
    for part in parts:
        found = LINE_NUMBER.search(str(getattr(part, "info", "")))
        if found and hasattr(part, "id"):  # some versions 3.3 have no id: then there is no line
            yield int(part.id), int(found[1])
