"""A model of MuJoCo's as MuJoCo itself compiles it, and what its parts are called and where they stand in the file.

MuJoCo's own reader knows defaults, includes, classes, frames, replicas, and the masses of meshes; whoever read the file
without it would read another machine. Its errors are told as ours. Models stand in memory as arrays by kind: `jnt_axis`
has a row a joint. Impure: reads the file and what it names; sets MuJoCo's handler of warnings, which else writes a file
into the working folder.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from typing import Any

from heuncli.base.errors import Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.importers.mjcf.named_files import ModelFiles

OLDEST = (3, 3)  # whose specs take included models as texts
INSTALL = 'pip install "heuncli[mujoco]"'
LINE = re.compile(r"\bline(?: number)?[ =](\d+)", re.IGNORECASE)
KINDS = {  # what a part is called: in MuJoCo's arrays, in a MjSpec, in its list of kinds of objects
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


class Compiled(NamedTuple):
    """A compiled model. lines: of each kind the line of each part in the file, where MuJoCo tells it."""

    mujoco: Any
    model: Any
    file: str
    lines: dict[str, dict[int, int]]
    warned: tuple[str, ...] = ()

    def count(self, kind: str) -> int:
        """How many there are of a kind."""
        prefix = KINDS[kind][0]
        return int(getattr(self.model, f"n{prefix}"))

    def name(self, kind: str, number: int) -> str:
        """What the file calls it; empty if nothing."""
        return self.mujoco.mj_id2name(self.model, getattr(self.mujoco.mjtObj, KINDS[kind][2]), number) or ""

    def told(self, kind: str, number: int) -> str:
        """How a sentence speaks of it: by its name, else by its number."""
        name = self.name(kind, number)
        return f"{kind} {name!r}" if name else f"{kind} number {number}"

    def location(self, kind: str, number: int) -> SourceLocation | None:
        """Where it stands in the file, if MuJoCo tells it."""
        line = self.lines.get(kind, {}).get(number)
        return None if line is None else SourceLocation(self.file, line, 1)

    def switched_off(self, *flags: str) -> bool:
        """Whether one of the flags of `option/flag` that switch a part of the mechanics off is set."""
        members = self.mujoco.mjtDisableBit.__members__
        bits = sum(int(members[f"mjDSBL_{flag}"]) for flag in flags if f"mjDSBL_{flag}" in members)
        return bool(self.model.opt.disableflags & bits)


def compiled(content: bytes, file: str, named: ModelFiles) -> Compiled:
    """The model of a text. file: what messages call it. Raises SpecError: no mujoco, or what MuJoCo finds wrong."""
    mujoco = _package(file)
    warned: list[str] = []
    mujoco.set_mju_user_warning(lambda text: warned.append(str(text)))
    try:
        with warnings.catch_warnings(record=True) as seen:
            warnings.simplefilter("always")
            spec = mujoco.MjSpec.from_string(_text(content, file), include=dict(named.included))
            spec.modelfiledir = named.folder
            model = spec.compile()
    except (MemoryError, SpecError):
        raise
    except Exception as error:  # ValueError mostly; of the bindings also their own kinds
        raise SpecError(_problem(str(error), file)) from None
    warned += [str(warning.message) for warning in seen]
    lines = {} if named.included else _lines(spec)  # of several files MuJoCo does not say which
    return Compiled(mujoco, model, file, lines, tuple(dict.fromkeys(warned)))


def _package(file: str) -> Any:
    try:
        import mujoco
    except ImportError:
        message = f"{file} is a model of MuJoCo's, which the package mujoco reads; it is not installed"
        raise SpecError(Problem("missing-extra", message, hint=f"{INSTALL} installs it")) from None
    if tuple(map(int, str(mujoco.__version__).split(".")[:2])) < OLDEST:
        oldest = ".".join(map(str, OLDEST))
        message = f"{file}: the package mujoco is of version {mujoco.__version__}; the oldest understood is {oldest}"
        raise SpecError(Problem("missing-extra", message, hint=f"{INSTALL} --upgrade"))
    return mujoco


def _text(content: bytes, file: str) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        message = "not in UTF-8, which is what MuJoCo reads"
        raise SpecError(Problem("not-xml", message, SourceLocation(file, 1, 1), "save it as UTF-8")) from None


def _problem(text: str, file: str) -> Problem:
    """What MuJoCo says, in one sentence with its place."""
    found = LINE.search(text)
    said = " ".join(text.split()).removeprefix("Error: ").removeprefix("XML Error: ").removeprefix("Error: ")
    said = re.sub(r"Element name '', id \d+, |,? ?line \d+$", "", said).rstrip(", ")
    line = max(int(found[1]), 1) if found else 1
    message = f"MuJoCo does not compile it: {said}"
    return Problem("import-mjcf", message, SourceLocation(file, line, 1), "MuJoCo says so of the file by itself, too")


def _lines(spec: Any) -> dict[str, dict[int, int]]:
    return {kind: dict(_lines_of(getattr(spec, several, ()))) for kind, (_, several, _) in KINDS.items()}


def _lines_of(parts: Any) -> Iterator[tuple[int, int]]:
    for part in parts:
        found = LINE.search(str(getattr(part, "info", "")))
        if found and hasattr(part, "id"):  # which versions of 3.3 do not all have: no line is told
            yield int(part.id), int(found[1])
