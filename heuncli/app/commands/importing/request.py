"""Options and arguments of `heun import`."""

from typing import Annotated

from heuncli.app.cli.options import OUTPUT, QUIET, TIME_LIMIT, Option
from heuncli.base.named_tuples import NamedTuple


class ImportRequest(NamedTuple):
    """Make a spec of another program's model: of a robot in URDF, a scene of MuJoCo's."""

    file: Annotated[str, Option((), "The model; - reads standard input.", "FILE")]
    output: Annotated[str | None, OUTPUT] = None
    base: Annotated[
        str | None, Option(("--base",), "The root stands on the ground (default), or is free.", "fixed|free")
    ] = None
    free: Annotated[bool, Option(("--free",), "Let the joints go; by default drives hold them.")] = False
    limits: Annotated[bool, Option(("--limits",), "With --free: limits of joints as stops.")] = False
    density: Annotated[
        str | None,
        Option(("--density",), "Of the shapes of what has no inertia, such as '2700 kg/m^3'.", "NUMBER"),
    ] = None
    repair: Annotated[
        str | None, Option(("--repair",), "Faults that are repaired, each named in a comment.", "FAULT,...")
    ] = None
    keyframe: Annotated[str | None, Option(("--keyframe",), "Of MJCF: the pose of the start.", "NAME")] = None
    strict: Annotated[bool, Option(("--strict",), "Fail where something has no counterpart.")] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
