"""What `heun sweep` is asked for: its options and arguments."""

from typing import Annotated

from heuncli.cli.options import NO_REDUCE, OUTPUT, QUIET, SET, UNITS, Option
from heuncli.named_tuples import NamedTuple

FORMATS = ("table", "json", "csv")


class SweepRequest(NamedTuple):
    """Solve a scene with other values, one variant after the other, and list a measure of each."""

    words: Annotated[
        tuple[str, ...],
        Option(
            (),
            "The scene's YAML file, and what is varied: n=1000:6000/51rpm, L=0.1,0.12,0.15, c=1:1000/31log, case=all, "
            "d=normal(100,0.1)mm.",
            "SPEC NAME=VALUES...",
            completes="spec",
        ),
    ]
    measure: Annotated[
        tuple[str, ...],
        Option(
            ("--measure",),
            "What is listed of each: 'max abs sections.middle.M1', 'final energy.kinetic'. May be repeated.",
            "WHAT",
            completes="measure",
        ),
    ] = ()
    zip: Annotated[bool, Option(("--zip",), "The values of one place together, not all combinations.")] = False
    format: Annotated[
        str | None,
        Option(
            ("--format",),
            "How to write the rows. Default: by the name's end of -o FILE, else table.",
            "|".join(FORMATS),
        ),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    method: Annotated[
        str | None, Option(("--method",), "The method of integration; `heun methods` lists them.", "NAME")
    ] = None
    step: Annotated[float | None, Option(("--step",), "The step of a method of fixed step.", "SECONDS")] = None
    tolerance: Annotated[
        float | None, Option(("--tolerance",), "Error of the motion, relative to the scene.", "NUMBER")
    ] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    least_norm: Annotated[bool, Option(("--least-norm",), "Split what redundant supports leave open.")] = False
    dask: Annotated[
        str | None,
        Option(
            ("--dask",),
            "The scheduler of a Dask cluster whose workers solve the variants; takes heuncli[dask].",
            "tcp://HOST:PORT",
        ),
    ] = None
    units: Annotated[str | None, UNITS] = None
    strict: Annotated[bool, Option(("--strict",), "Leave with 1 if a variant could not be solved.")] = False
    quiet: Annotated[bool, QUIET] = False
