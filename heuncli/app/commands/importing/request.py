"""Options and arguments of `heun import`."""

from typing import Annotated

from heuncli.app.cli.options import OUTPUT, QUIET, TIME_LIMIT, Option
from heuncli.base.named_tuples import NamedTuple


class ImportRequest(NamedTuple):
    """Convert a model of another program to a spec: a robot in URDF or SDF, or a MuJoCo model (MJCF)."""

    file: Annotated[str, Option((), "Model file; - reads standard input.", "FILE")]
    output: Annotated[str | None, OUTPUT] = None
    base: Annotated[
        str | None, Option(("--base",), "Root body fixed to the ground (default), or free.", "fixed|free")
    ] = None
    free: Annotated[bool, Option(("--free",), "Leave the joints free; by default drives lock them.")] = False
    limits: Annotated[bool, Option(("--limits",), "With --free: convert joint limits to stops.")] = False
    density: Annotated[
        str | None,
        Option(("--density",), "Density of the shapes of bodies without inertia, such as '2700 kg/m^3'.", "NUMBER"),
    ] = None
    repair: Annotated[str | None, Option(("--repair",), "Faults to repair, each noted in a comment.", "FAULT,...")] = (
        None
    )
    keyframe: Annotated[
        str | None, Option(("--keyframe",), "MuJoCo: keyframe that gives the start position.", "NAME")
    ] = None
    model: Annotated[str | None, Option(("--model",), "SDF: model of a world with several.", "NAME")] = None
    strict: Annotated[bool, Option(("--strict",), "Fail if something has no counterpart.")] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
