"""The result object of the Python API: signals by path, measures, tables, data frames and diagrams.

A thin layer: the study below computes everything, and names and formats are those of the command line. Rarely used
modules are imported where they are used. Impure: keeps signals that were requested.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from heuncli.app.python.arguments import (
    BOOLEAN,
    CAPTIONS,
    FILE,
    INTEGER,
    NUMBER,
    NUMBER_OR_TEXT,
    NUMBERS,
    TEXT,
    TEXTS,
    check_arguments,
)
from heuncli.app.python.locked_run import LockedRun, emit_warnings, find_distinct_instants
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.models import Spec
from heuncli.study.queries.study import Study

if TYPE_CHECKING:
    import os

    import pandas as pd

    from heuncli.analyses.load_cases.model import LoadCases
    from heuncli.app.python.locked_run import Number
    from heuncli.app.python.result_export import Diagram
    from heuncli.app.python.signals import Signal
    from heuncli.study.load_collectives import Collective


class Solved(Mapping[str, "Signal"]):
    """A solved scene: a mapping from paths of the results, as the JSON names them, to their signals.

        study["joints.main.force"].values            (n_t, 3) [N]
        study.measure("max abs sections.web.M1")      searched between the samples, with its instant

    `heuncli.solve` returns it; it does not change afterwards. All values are in SI. Several threads may use it.
    """

    def __init__(self, run: LockedRun) -> None:
        self._run = run
        self._signals: dict[str, Signal] = {}

    # -- numbers by their paths

    def __getitem__(self, path: str) -> Signal:
        """Return the signal at a path, such as "joints.main.force.z". Raises UnknownPath."""
        from heuncli.app.python.signals import make_signal

        if not isinstance(path, str):
            return make_signal(self._run, path)  # raises UnknownPath
        if path not in self._signals:
            self._signals[path] = make_signal(self._run, path)
        return self._signals[path]

    def __iter__(self) -> Iterator[str]:
        return iter(self.paths())

    def __len__(self) -> int:
        return len(self.paths())

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)

    def paths(self, under: str = "") -> list[str]:
        """List the paths of all numbers, or of those that begin with the words `under`, such as "joints.main"."""
        from heuncli.app.python.signals import list_paths

        check_arguments(("under", under, TEXT), optional=False)
        return [path for path in list_paths(self.results) if not under or f"{path}.".startswith(f"{under}.")]

    def _ipython_key_completions_(self) -> list[str]:
        """Return what a notebook proposes as key."""
        return self.paths()

    # -- information on the run

    @property
    def title(self) -> str:
        """The title of the spec."""
        return self.results.title

    @property
    def time(self) -> Array:
        """Instants of the results, (n_t,) [s]. Read-only."""
        return self._run.times

    @property
    def status(self) -> str:
        """How the run ended, in words: "completed", or the reason why it stopped."""
        status = self.results.status
        return " ".join(
            filter(None, (f"{status['code']}:" if status["message"] else status["code"], status["message"]))
        )

    @property
    def horizon(self) -> float | None:
        """The instant [s] from which on no result is claimed, or None if all are."""
        return self._run.horizon

    @property
    def warnings(self) -> list[str]:
        """Warnings of reading, of solving and of all later requests, each sentence once."""
        return self._run.warnings()

    @property
    def model(self) -> dict[str, Any]:
        """The block `model` of the JSON: what was solved and why, in words and counts."""
        model: dict[str, Any] = self.as_dict()["model"]
        return model

    @property
    def spec(self) -> Spec:
        """The scene as it was read."""
        return self._run.study.spec

    @property
    def study(self) -> Study:
        """heun's internal study, which computes the results. It may change between versions; only one thread may use it
        at a time.
        """
        return self._run.study

    @property
    def results(self) -> Results:
        """heun's internal results: blocks of arrays."""
        return self._run.results

    # -- further results

    def measure(self, words: str) -> Number:
        """Return one number, in the words of `--measure`: "max abs sections.web.M1", "at 0.5 energy.kinetic", "final
        PATH".

        Extremes include those between the samples, up to the horizon. nan means indeterminate, or not claimed. Raises
        UsageError.
        """
        check_arguments(("words", words, TEXT), optional=False)
        return self._run.measure(words)

    def at(self, times: float | Sequence[float] | Array) -> Solved:
        """Return the same run with its results at other instants [s] of it, in ascending order; nothing is solved
        again.

        Raises UsageError for instants outside the run.
        """
        check_arguments(("times", times, NUMBERS), optional=False)
        return Solved(self._run.resample(find_distinct_instants(times)[1]))

    def collective(
        self,
        path: str,
        *,
        slopes: float | Sequence[float] = (),
        cycles: float | None = None,
        bins: int = 10,
        repeat: int = 1,
        closed: bool = False,
    ) -> Collective:
        """Count the load collective of a number over the motion, as `--collective` does; of a vector that of its
        magnitude.

        slopes: slopes of Wöhler lines; each gives a damage-equivalent range in `equivalents`
        cycles: number of cycles of the equivalents; None: one for each repetition of the motion
        bins: classes of ranges and means
        repeat: how often the motion is repeated
        closed: whether it is repeated for ever

        Ranges and levels are in SI. Raises HeunError for a number that has no collective.
        """
        from heuncli.output.tables.collective_tables import count_collective

        check_arguments(("path", path, TEXT), ("slopes", slopes, NUMBERS), ("bins", bins, INTEGER), optional=False)
        check_arguments(("repeat", repeat, INTEGER), ("closed", closed, BOOLEAN), optional=False)
        check_arguments(("cycles", cycles, NUMBER))
        slope_values = tuple(np.atleast_1d(np.asarray(slopes, dtype=np.float64)).tolist())
        with self._run.hold_lock():
            return count_collective(
                self.study, path, slopes=slope_values, cycles=cycles, bins=bins, repeat=repeat, is_closed=closed
            )

    def load_cases(self, body: str, at: float | str) -> LoadCases:
        """Return the self-balanced load cases of a body, as `heun export loads` writes them, in SI and in the body's
        axes.

        at: instants, as `--at` of that command takes them: 0.31, "first,last", "peak:joints.main.force,impulse:0"

        Raises HeunError for invalid instants, and for indeterminate loads.
        """
        from heuncli.analyses.load_cases.assembly import assemble_load_cases
        from heuncli.study.model.options import require_choice
        from heuncli.study.queries.at_option import parse

        check_arguments(("body", body, TEXT), ("at", at, NUMBER_OR_TEXT), optional=False)
        require_choice("load_cases", body, list(self.spec.bodies))
        with self._run.hold_lock():
            return assemble_load_cases(self.study, body, parse(str(at)))

    # -- export

    def to_json(self) -> str:
        """Return the results as `heun run --format json` writes them."""
        from heuncli.output.tables.export import to_json

        return to_json(self.results)

    def to_csv(self) -> str:
        """Return the results as `heun run --format csv` writes them."""
        from heuncli.output.tables.export import to_csv
        from heuncli.study.quantities.labels import make_labels

        return to_csv(self.results, make_labels(self.spec))

    def as_dict(self) -> dict[str, Any]:
        """Return the results as the JSON has them, as lists and numbers; None is indeterminate."""
        data: dict[str, Any] = json.loads(self.to_json())
        return data

    def tables(self, *, units: str | None = None, only: str | Sequence[str] | None = None) -> str:
        """Return the tables of `heun run`, with extremes searched between the samples; after `at(...)` those at its
        instants.

        units: "kN,mm,deg,rpm"
        only: reports or entries, as in `solve`

        Raises UsageError.
        """
        from heuncli.app.python.result_export import format_text

        check_arguments(("units", units, TEXT), ("only", only, TEXTS))
        with self._run.hold_lock():
            return format_text(self.study, self._run.instants, units, only)

    def frame(self, *paths: str, units: bool = False) -> pd.DataFrame:
        """Return numbers over time as a pandas.DataFrame: one column per number, index `time` [s].

        paths: the numbers, vectors by component; default: all
        units: whether column names contain the units

        Units also stand in `frame.attrs["units"]`, errors in `frame.attrs["errors"]`. nan is indeterminate or beyond
        the horizon. Raises UsageError if pandas is not installed, or if a path has no instants.
        """
        from heuncli.app.python.result_export import make_frame

        check_arguments(("units", units, BOOLEAN), ("paths", paths, TEXTS), optional=False)
        return make_frame(self._run, [self[path] for path in paths or self.paths()], units, is_explicit=bool(paths))

    def plot(
        self,
        *paths: str,
        over: str | None = None,
        units: str | None = None,
        title: str | None = None,
        labels: Mapping[str, str] | None = None,
    ) -> Diagram:
        """Draw numbers over time, or over another number, as `heun plot SPEC PATH...` does; a notebook shows the
        diagram.

        units: "kN,mm"
        title, labels: words in place of those of the spec, `{"joints.main": "Main bearing"}`

        Raises HeunError for what cannot be drawn.
        """
        from heuncli.app.python.result_export import make_diagram

        check_arguments(
            ("paths", paths, TEXTS), ("over", over, TEXT), ("units", units, TEXT), ("title", title, TEXT),
            ("labels", labels, CAPTIONS),
        )  # fmt: skip
        with self._run.hold_lock():
            return make_diagram(self.study, paths, over, units, title, labels or {})

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write the results into a file, in the format of its ending: .json or .csv. Raises UsageError, OSError."""
        from heuncli.app.python.result_export import write_results

        check_arguments(("file", file, FILE), optional=False)
        write_results(file, {".json": self.to_json, ".csv": self.to_csv})

    def __str__(self) -> str:
        return self.tables()

    def __repr__(self) -> str:
        times = self.results.time
        run = (
            f"t = {times[0]:.6g} s"
            if len(times) == 1
            else f"{times[0]:.6g} to {times[-1]:.6g} s, {len(times)} instants"
        )
        return f"<heuncli.Solved {self.title!r}: {run}; {self.status}>"

    def _repr_html_(self) -> str:
        """Return the tables as an HTML fragment, which a notebook shows."""
        from heuncli.app.python.result_export import render_html

        with self._run.hold_lock():
            return render_html(self.study, self._run.instants)

    def __copy__(self) -> Solved:
        return self

    def __deepcopy__(self, memo: object) -> Solved:
        return self

    def __reduce__(self) -> NoReturn:
        raise TypeError("a solved model cannot be pickled: send to_json(), or send the spec and solve it there")


def make_solved(study: Study, instants: float | Sequence[float] | None) -> Solved:
    """Wrap a study that was just solved, at its own instants or at others, and emit its warnings."""
    run = LockedRun(study)
    emit_warnings(run.warnings())
    solved = Solved(run)
    return solved if instants is None else solved.at(instants)
