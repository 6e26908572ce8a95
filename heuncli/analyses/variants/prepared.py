"""A scene solved again and again with other values: what hangs on none of them is kept from one set-up.

    prepared = Variants("specs/slider_crank.yaml", options=Options(wanted=frozenset({"joints"})))
    study = prepared.solve({"w": "1500 rpm", "r": "0.06"})

What is kept is what a variant would make with the very same bits: it is decided by what each entry, rule and stage has
looked up (scene/file_format/variants.py), so a variant is what `heun run --set` makes of it, to the bit, whichever came
before.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from heuncli.base.errors import HeunError
from heuncli.base.records import replace
from heuncli.multibody.kept_stages import FirstStages, LaterStages
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.variants import SpecVariants
from heuncli.study.ask.study import Study
from heuncli.study.model.options import Options, as_asked
from heuncli.study.model.selection import asked_by
from heuncli.study.workflow import asked_set_up, solve


class Variants:
    """A spec that was read, checked and resolved once, to be solved with other values."""

    def __init__(
        self,
        path: str | Path,
        text: str | None = None,
        *,
        options: Options | None = None,
        overrides: Mapping[str, str] | None = None,
        case: str | None = None,
        measures: Sequence[str] = (),
        files: NamedFiles | None = None,
    ) -> None:
        """Read the file of a spec, or a text that stands for it, as `load` does; nothing of it is read again.

        options: by which all variants are solved; overrides: what is set in all of them; case: the load case whose
        values these go on top of; measures: paths into the results, where no more is solved than these need; files:
        those that the spec names, None where they stand beside it. Raises SpecError.
        """
        self.options = options or Options()
        self._specs = SpecVariants(path, text, overrides, checking=False, case=case, files=files)
        if measures:
            what = asked_by(measures, self.spec)
            self.options = replace(self.options, wanted=what.reports, entries=what.entries)
        first = FirstStages()
        with suppress(HeunError):  # of a scene that cannot be set up less is kept, or nothing
            asked_set_up(as_asked(self._specs.spec, self.options), self.options, first)
        self._stages = LaterStages(first)

    @property
    def spec(self) -> Spec:
        """The scene as it was read, with what is set in all variants."""
        return self._specs.spec

    def idle(self, names: Collection[str]) -> frozenset[str]:
        """The parameters among some names on which nothing of the scene hangs."""
        return self._specs.idle(names)

    def load(self, values: Mapping[str, str]) -> Spec:
        """The scene with other values, by the names and in the form of `--set`. Raises SpecError."""
        return self._specs.load(values)

    def solve(self, values: Mapping[str, str]) -> Study:
        """The scene with other values, solved; values: by the names and in the form of `--set`.

        Raises what `load` and `solve` raise: SpecError, SolveError, LimitError; the next variant does not feel it.
        """
        return solve(self.load(values), self.options, self._stages)
