"""Options and arguments of `heun sweep`."""

from typing import Annotated

from heuncli.app.cli.options import OUTPUT, QUIET, SET, UNITS, Option, SolverRequest, make_format_option
from heuncli.base.named_tuples import NamedTuple

FORMATS = ("table", "json", "csv", "parquet")


class SweepRequest(NamedTuple):
    """The options and arguments of `heun sweep`."""

    words: Annotated[
        tuple[str, ...],
        Option(
            (),
            "YAML file of the spec, and the varied parameters: n=1000:6000/51rpm, L=0.1,0.12,0.15, c=1:1000/31log, "
            "case=all, d=normal(100,0.1)mm, r=uniform(a,b), lhs(a,b), sobol(a,b).",
            "SPEC NAME=VALUES...",
            completes="spec",
        ),
    ] = ()
    measure: Annotated[
        tuple[str, ...],
        Option(
            ("--measure",),
            "Result to list: 'max abs sections.middle.M1', 'final energy.kinetic'. May be repeated.",
            "WHAT",
            completes="measure",
        ),
    ] = ()
    zip: Annotated[
        bool, Option(("--zip",), "Vary the parameters together, value by value, not in all combinations.")
    ] = False
    variants: Annotated[
        str | None,
        Option(("--variants",), "CSV table of variants: one column per parameter, one row per variant.", "FILE"),
    ] = None
    store: Annotated[
        str | None,
        Option(("--store",), "Store every row as soon as it is solved; stored variants are not solved again.", "FILE"),
    ] = None
    show: Annotated[
        str | None,
        Option(("--show",), "Print the last sweep of a store, or sweep number N; nothing is solved.", "FILE[:N]"),
    ] = None
    shard: Annotated[
        str | None,
        Option(("--shard",), "Solve part K of N, such as 2/8: every eighth variant, starting with the second.", "K/N"),
    ] = None
    jobs: Annotated[
        int | None,
        Option(("--jobs", "-j"), "Number of processes. Default: one per processor for eight or more variants.", "N"),
    ] = None
    time_limit_each: Annotated[
        float | None,
        Option(("--time-limit",), "Stop each variant after this computing time; the others continue.", "SECONDS"),
    ] = None
    samples: Annotated[int | None, Option(("--samples",), "Number of random samples.", "N")] = None
    seed: Annotated[int | None, Option(("--seed",), "Seed of the random samples. Default: 0.", "S")] = None
    indices: Annotated[
        bool,
        Option(("--indices",), "Compute Sobol indices of the random parameters: N (d + 2) variants for d parameters."),
    ] = False
    format: Annotated[
        str | None,
        make_format_option(FORMATS),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    solver: SolverRequest = SolverRequest()
    dask: Annotated[
        str | None,
        Option(
            ("--dask",),
            "Scheduler of a Dask cluster whose workers solve the variants; requires heuncli[dask].",
            "tcp://HOST:PORT",
        ),
    ] = None
    units: Annotated[str | None, UNITS] = None
    all: Annotated[bool, Option(("--all",), "Show all variants in tables.")] = False
    strict: Annotated[bool, Option(("--strict",), "Exit with 1 if a variant could not be solved.")] = False
    quiet: Annotated[bool, QUIET] = False
