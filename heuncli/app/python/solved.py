"""A solved scene as Python has it: numbers by their paths, measures, tables, frames, diagrams.

Thin: all of it is what the study below answers, in the words and the forms of the command line. What is seldom asked
for is imported where it is. Impure: keeps what it was asked for.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from heuncli.app.python.arguments import (
    FILE,
    NUMBER,
    NUMBER_OR_TEXT,
    NUMBERS,
    TEXT,
    TEXTS,
    TRUTH,
    WHOLE,
    check_arguments,
)
from heuncli.app.python.asked_run import AskedRun, distinct
from heuncli.app.python.warned import warn
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.models import Spec
from heuncli.study.ask.study import Study

if TYPE_CHECKING:
    import os

    import pandas as pd

    from heuncli.analyses.load_cases.model import LoadCases
    from heuncli.app.python.diagrams import Diagram
    from heuncli.app.python.measured import Number
    from heuncli.app.python.signals import Signal
    from heuncli.study.load_cycles.counted import Collective


class Solved(Mapping[str, "Signal"]):
    """A solved scene: a mapping from paths of the results, as the JSON has them, to their numbers.

        study["joints.main.force"].values            (n_t, 3) [N]
        study.measure("max abs sections.web.M1")      searched between the samples, with its instant

    Solved by `heuncli.solve`; nothing of it changes afterwards. All is in SI. It may be asked from several threads.
    """

    def __init__(self, run: AskedRun) -> None:
        self._run = run
        self._signals: dict[str, Signal] = {}

    # -- numbers by their paths

    def __getitem__(self, path: str) -> Signal:
        """The numbers at a path, such as "joints.main.force.z". Raises UnknownPath."""
        from heuncli.app.python.signals import signal_at

        if not isinstance(path, str):
            return signal_at(self._run, path)  # refused there
        if path not in self._signals:
            self._signals[path] = signal_at(self._run, path)
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
        """The paths of all numbers, or of those under the words with which a path begins: "joints.main"."""
        from heuncli.app.python.signals import paths_of

        check_arguments(("under", under, TEXT), optional=False)
        return [path for path in paths_of(self.results) if not under or f"{path}.".startswith(f"{under}.")]

    def _ipython_key_completions_(self) -> list[str]:
        return self.paths()

    # -- what the run tells of itself

    @property
    def title(self) -> str:
        """The title of the spec."""
        return self.results.title

    @property
    def time(self) -> Array:
        """The instants at which results are told, (n_t,) [s]. Read-only."""
        return self._run.times

    @property
    def status(self) -> str:
        """How the run ended, in words: "completed", or what stopped it."""
        told = self.results.status
        return " ".join(filter(None, (f"{told['code']}:" if told["message"] else told["code"], told["message"])))

    @property
    def horizon(self) -> float | None:
        """The instant [s] from which on nothing is claimed; None where all is."""
        return self._run.horizon

    @property
    def warnings(self) -> list[str]:
        """What reading and solving warned of, and all that was asked since: sentences, once each."""
        return self._run.warnings()

    @property
    def model(self) -> dict[str, Any]:
        """What was solved and why, in words and counts: the block `model` of the JSON."""
        model: dict[str, Any] = self.as_dict()["model"]
        return model

    @property
    def spec(self) -> Spec:
        """The scene as it was read."""
        return self._run.study.spec

    @property
    def study(self) -> Study:
        """What answers, below this door: it is heun's own, may change, and is asked by one thread at a time."""
        return self._run.study

    @property
    def results(self) -> Results:
        """The results as heun has them: blocks of arrays."""
        return self._run.results

    # -- asking more

    def measure(self, words: str) -> Number:
        """One number, as `--measure` takes it: "max abs sections.web.M1", "at 0.5 energy.kinetic", "final PATH".

        Extremes are those between the samples, too, up to the horizon; nan is open, or not claimed. Raises UsageError.
        """
        check_arguments(("words", words, TEXT), optional=False)
        return self._run.measure(words)

    def at(self, times: float | Sequence[float] | Array) -> Solved:
        """The same run with its results told at other instants [s] of it, in ascending; nothing is solved again.

        Raises UsageError for instants outside of the run.
        """
        check_arguments(("times", times, NUMBERS), optional=False)
        return Solved(self._run.told_at(distinct(times)[1]))

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
        """The load collective of a number over the motion, of a vector of its magnitude, as `--collective` counts it.

        slopes: of Wöhler lines, each with its damage-equivalent range in `equivalents`, of so many cycles (None: of one
        each time the motion is run through); bins: classes of ranges and means; repeat: how often the motion is run
        through; closed: for ever. Ranges and levels in SI. Raises HeunError for what has no collective.
        """
        from heuncli.output.snapshots.collectives import collective

        check_arguments(("path", path, TEXT), ("slopes", slopes, NUMBERS), ("bins", bins, WHOLE), optional=False)
        check_arguments(("repeat", repeat, WHOLE), ("closed", closed, TRUTH), optional=False)
        check_arguments(("cycles", cycles, NUMBER))
        of = tuple(np.atleast_1d(np.asarray(slopes, dtype=np.float64)).tolist())
        with self._run.asking():
            return collective(self.study, path, slopes=of, cycles=cycles, bins=bins, repeat=repeat, closed=closed)

    def load_cases(self, body: str, at: float | str) -> LoadCases:
        """The self-balanced load cases of a body, as `heun export loads` writes them, in SI and in the body's axes.

        at: instants, as `--at` of that command takes them: 0.31, "first,last", "peak:joints.main.force,impulse:0".
        Raises HeunError for instants that are none, and for loads that are open.
        """
        from heuncli.analyses.load_cases.gathered import gathered
        from heuncli.study.ask.asked_instants import parse
        from heuncli.study.ask.asked_values import choice

        check_arguments(("body", body, TEXT), ("at", at, NUMBER_OR_TEXT), optional=False)
        choice("load_cases", body, list(self.spec.bodies))
        with self._run.asking():
            return gathered(self.study, body, parse(str(at)))

    # -- other forms

    def to_json(self) -> str:
        """The results as `heun run --format json` writes them."""
        from heuncli.output.tables.export import to_json

        return to_json(self.results)

    def to_csv(self) -> str:
        """The results as `heun run --format csv` writes them."""
        from heuncli.output.tables.export import to_csv
        from heuncli.study.quantities.labels import labels_of

        return to_csv(self.results, labels_of(self.spec))

    def as_dict(self) -> dict[str, Any]:
        """The results as the JSON has them, in lists and numbers; None is open."""
        found: dict[str, Any] = json.loads(self.to_json())
        return found

    def tables(self, *, units: str | None = None, only: str | Sequence[str] | None = None) -> str:
        """The tables of `heun run`: with the extremes, searched between the samples; of results `at` instants these.

        units: "kN,mm,deg,rpm"; only: reports or entries, as of `solve`. Raises UsageError.
        """
        from heuncli.app.python.told import text_of

        check_arguments(("units", units, TEXT), ("only", only, TEXTS))
        with self._run.asking():
            return text_of(self.study, self._run.instants, units, only)

    def frame(self, *paths: str, units: bool = False) -> pd.DataFrame:
        """Numbers over the instants as a pandas.DataFrame: a column a number, its index `time` [s].

        paths: what is in it, vectors by their components; by default all. units: whether names of columns have them;
        they stand in `frame.attrs["units"]`, and errors in `frame.attrs["errors"]`, too. What is open, or beyond the
        horizon, is nan. Raises UsageError where pandas is not installed, or a path has no instants.
        """
        from heuncli.app.python.frames import frame_of

        check_arguments(("units", units, TRUTH), ("paths", paths, TEXTS), optional=False)
        return frame_of(self._run, [self[path] for path in paths or self.paths()], units, named=bool(paths))

    def plot(self, *paths: str, over: str | None = None, units: str | None = None) -> Diagram:
        """Numbers over time, or over another number, as `heun plot SPEC PATH...` draws them: a notebook shows it.

        units: "kN,mm". Raises HeunError for what cannot be drawn.
        """
        from heuncli.app.python.diagrams import diagram_of

        check_arguments(("paths", paths, TEXTS), ("over", over, TEXT), ("units", units, TEXT))
        with self._run.asking():
            return diagram_of(self.study, paths, over, units)

    def save(self, file: str | os.PathLike[str]) -> None:
        """The results into a file, by its ending: .json or .csv. Raises UsageError, OSError."""
        from heuncli.app.python.told import write_results

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
        """The tables as a part of a page: what a notebook shows."""
        from heuncli.app.python.told import fragment_of

        with self._run.asking():
            return fragment_of(self.study, self._run.instants)

    def __copy__(self) -> Solved:
        return self

    def __deepcopy__(self, memo: object) -> Solved:
        return self

    def __reduce__(self) -> NoReturn:
        raise TypeError("a solved scene is not pickled: send to_json(), or the spec, and solve it there")


def told(study: Study, at: float | Sequence[float] | None) -> Solved:
    """A scene that was just solved, at its own instants or at others; its warnings are told."""
    run = AskedRun(study)
    warn(run.warnings())
    solved = Solved(run)
    return solved if at is None else solved.at(at)
