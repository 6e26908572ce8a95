"""Compile a model by MuJoCo itself, and name and locate its parts in the file.

Only MuJoCo's own reader knows defaults, includes, classes, frames, replicas, and the masses of meshes; any other reader
would read another machine. Its errors are reported as heun's. The compiled model holds arrays by kind: `jnt_axis` has
one row for each joint. Impure: reads the file and the files it names, and sets MuJoCo's handler of warnings, which
would otherwise write a file into the working folder.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from typing import Any

from heuncli.base.errors import Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.importers.mjcf.named_files import ModelFiles

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
