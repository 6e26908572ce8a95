"""Solve the variants of a spec; what depends on no varied value is computed once.

    solver = VariantSolver("specs/slider_crank.yaml", options=Options(requested_reports=frozenset({"joints"})))
    study = solver.solve({"w": "1500 rpm", "r": NumberWithUnit(60.0, "mm")})

A cached stage has the very same bits that the variant would compute: this is decided by what each entry, rule and stage
has looked up (scene/file_format/incremental_loader.py). So a variant equals the result of `heun run --set` to the bit,
whatever was solved before.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from heuncli.base.errors import HeunError
from heuncli.base.process import keep_freed_memory
from heuncli.base.records import replace
from heuncli.multibody.stage_cache import RecordingStages, ReusingStages
from heuncli.scene.file_format.incremental_loader import SpecVariants
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.quantity import ParameterValue
from heuncli.study.model.options import Options, apply_options
from heuncli.study.model.selection import select_paths
from heuncli.study.queries.study import Study
from heuncli.study.workflow import set_up_requested, solve


class VariantSolver:
    """A spec that was read, checked and resolved once, to be solved with other values."""

    def __init__(
        self,
        path: str | Path,
        text: str | None = None,
        *,
        options: Options | None = None,
        overrides: Mapping[str, ParameterValue] | None = None,
        case: str | None = None,
        measures: Sequence[str] = (),
        files: NamedFiles | None = None,
    ) -> None:
        """Read the file of a spec, or its text, as `load` does; nothing of it is read again.

        options: with which all variants are solved
        overrides: set in all of them
        case: the load case that these values are applied to
        measures: paths into the results; only what they need is solved
        files: the files that the spec names; None: they are read from the spec's folder

        Raises SpecError.
        """
        keep_freed_memory()
        self.options = options or Options()
        self._specs = SpecVariants(path, text, overrides, checking=False, case=case, files=files)
        if measures:
            selection = select_paths(measures, self.spec)
            self.options = replace(self.options, requested_reports=selection.reports, entries=selection.entries)
        first = RecordingStages()
        with suppress(HeunError):  # a scene that cannot be set up leaves a partly filled or empty cache
            set_up_requested(apply_options(self._specs.spec, self.options), self.options, first)
        self._stages = ReusingStages(first)

    @property
    def spec(self) -> Spec:
        """The scene as it was read, with the values set in all variants."""
        return self._specs.spec

    def find_unused_parameters(self, names: Collection[str]) -> frozenset[str]:
        """Return the parameters among some names that nothing of the scene depends on."""
        return self._specs.unused_parameters(names)

    def load(self, values: Mapping[str, ParameterValue]) -> Spec:
        """Load the scene with other values, by name. Raises SpecError."""
        return self._specs.load(values)

    def solve(self, values: Mapping[str, ParameterValue]) -> Study:
        """Solve the scene with other values, by name: numbers with their units, or texts in the form of `--set`.

        Raises what `load` and `solve` raise: SpecError, SolveError, LimitError; the next variant is not affected.
        """
        return solve(self.load(values), self.options, self._stages)
