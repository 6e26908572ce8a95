"""Options and arguments of `heun sweep`."""

from typing import Annotated

from heuncli.app.cli.options import LEAST_NORM, METHOD, NO_REDUCE, OUTPUT, QUIET, SET, STEP, TOLERANCE, UNITS, Option
from heuncli.base.named_tuples import NamedTuple

FORMATS = ("table", "json", "csv", "parquet")


class SweepRequest(NamedTuple):
    """Solve a scene with other values, one variant after the other, and list a measure of each."""

    words: Annotated[
        tuple[str, ...],
        Option(
            (),
            "The scene's YAML file, and what is varied: n=1000:6000/51rpm, L=0.1,0.12,0.15, c=1:1000/31log, case=all, "
            "d=normal(100,0.1)mm, r=uniform(a,b), lhs(a,b), sobol(a,b).",
            "SPEC NAME=VALUES...",
            completes="spec",
        ),
    ] = ()
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
    variants: Annotated[
        str | None,
        Option(("--variants",), "A CSV table of variants: a column a parameter, a row a variant.", "FILE"),
    ] = None
    store: Annotated[
        str | None,
        Option(("--store",), "Keep every row there as it is done; what is there already is not solved again.", "FILE"),
    ] = None
    show: Annotated[
        str | None,
        Option(("--show",), "Print the last sweep of a store, or the one of that number; solves nothing.", "FILE[:N]"),
    ] = None
    shard: Annotated[
        str | None,
        Option(("--shard",), "One part of so many, such as 2/8: every eighth variant, from the second on.", "K/N"),
    ] = None
    jobs: Annotated[
        int | None, Option(("--jobs", "-j"), "Processes. Default: one a processor, from eight variants on.", "N")
    ] = None
    time_limit_each: Annotated[
        float | None, Option(("--time-limit",), "Give up on a variant after that long; the others go on.", "SECONDS")
    ] = None
    samples: Annotated[int | None, Option(("--samples",), "How many of what is drawn at random.", "N")] = None
    seed: Annotated[int | None, Option(("--seed",), "Of what is drawn at random. Default: 0.", "S")] = None
    indices: Annotated[
        bool, Option(("--indices",), "Sobol indices of what is drawn: N (d + 2) variants for d parameters.")
    ] = False
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
    method: Annotated[str | None, METHOD] = None
    step: Annotated[float | None, STEP] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    least_norm: Annotated[bool, LEAST_NORM] = False
    dask: Annotated[
        str | None,
        Option(
            ("--dask",),
            "The scheduler of a Dask cluster whose workers solve the variants; takes heuncli[dask].",
            "tcp://HOST:PORT",
        ),
    ] = None
    units: Annotated[str | None, UNITS] = None
    all: Annotated[bool, Option(("--all",), "Tables show all variants, however many.")] = False
    strict: Annotated[bool, Option(("--strict",), "Leave with 1 if a variant could not be solved.")] = False
    quiet: Annotated[bool, QUIET] = False
