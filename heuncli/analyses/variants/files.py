"""Read the files that the variants of a plan name once, and send them with the recipe. Impure: reads files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from heuncli.analyses.variants.evaluation import Recipe
from heuncli.analyses.variants.parameters import CASE
from heuncli.analyses.variants.plans import Plan
from heuncli.base.errors import HeunError
from heuncli.scene.file_format.incremental_loader import SpecVariants
from heuncli.scene.file_format.named_files import NamedFiles, TrackedFiles
from heuncli.scene.file_format.parameters import parse_settings

FILE_KEYS = (".file", ".curve")  # endings of the keys whose values are names of files


def add_files(recipe: Recipe, plan: Plan) -> Recipe:
    """Add to the recipe the files that its spec names and those that the axes set, with their present content.

    A variant may name a further file, by a key that holds a whole table: see `add_named_files`. Raises SpecError.
    """
    noted_files = TrackedFiles(recipe.path)
    spec = SpecVariants(recipe.path, recipe.text, recipe.overrides, False, recipe.case, noted_files).spec
    for case in _iter_cases(plan, spec.cases):
        try:
            SpecVariants(recipe.path, recipe.text, recipe.overrides, False, case, noted_files)
        except HeunError:  # the rows of that case report it
            continue
    return add_named_files(recipe, [*noted_files.names, *_iter_set_files(plan)])


def add_named_files(recipe: Recipe, names: Iterable[str]) -> Recipe:
    """Add some files to the recipe."""
    files = NamedFiles(recipe.path)
    files_by_name = dict(recipe.files or {})
    files_by_name.update((name, files.get_file(name)) for name in dict.fromkeys(names) if name not in files_by_name)
    return recipe._replace(files=files_by_name)


def _iter_cases(plan: Plan, cases: Iterable[str]) -> Iterator[str]:
    """Yield the load cases that the plan varies."""
    texts = {text for axis in (*plan.columns, *plan.axes) if axis.name == CASE for text in axis.values}
    return (case for case in cases if case in texts)


def _iter_set_files(plan: Plan) -> Iterator[str]:
    """Yield the files that axes name."""
    for axis in (*plan.columns, *plan.axes):
        if axis.name.endswith(FILE_KEYS):
            for text in axis.values if axis.unit is None else ():
                settings, _ = parse_settings({axis.name: str(text)})
                yield from (setting.value for setting in settings if isinstance(setting.value, str))
