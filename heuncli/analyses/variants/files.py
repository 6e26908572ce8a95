"""The files that the variants of a plan name, read once and sent along with the recipe. Impure: reads files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from heuncli.analyses.variants.asking import CASE, Recipe
from heuncli.analyses.variants.plans import Plan
from heuncli.base.errors import HeunError
from heuncli.scene.file_format.named_files import NamedFiles, NotedFiles
from heuncli.scene.file_format.overrides import of_words
from heuncli.scene.file_format.variants import SpecVariants

KEYS = (".file", ".curve")  # how names of values end that are names of files


def with_files(recipe: Recipe, plan: Plan) -> Recipe:
    """The recipe with the files that its spec names and those that the axes set, as they are now.

    A variant may come to name another one, by a key that holds a whole table: with_more_files. Raises SpecError.
    """
    noted = NotedFiles(recipe.path)
    spec = SpecVariants(recipe.path, recipe.text, recipe.overrides, False, recipe.case, noted).spec
    for case in _cases(plan, spec.cases):
        try:
            SpecVariants(recipe.path, recipe.text, recipe.overrides, False, case, noted)
        except HeunError:  # the rows of that case say so
            continue
    return with_more_files(recipe, [*noted.names, *_set_by(plan)])


def with_more_files(recipe: Recipe, names: Iterable[str]) -> Recipe:
    """The recipe with some files more."""
    files = NamedFiles(recipe.path)
    kept = dict(recipe.files or {})
    kept.update((name, files.kept(name)) for name in dict.fromkeys(names) if name not in kept)
    return recipe._replace(files=kept)


def _cases(plan: Plan, known: Iterable[str]) -> Iterator[str]:
    """The load cases that the plan varies."""
    texts = {text for axis in (*plan.columns, *plan.axes) if axis.name == CASE for text in axis.texts}
    return (case for case in known if case in texts)


def _set_by(plan: Plan) -> Iterator[str]:
    """The files that axes name."""
    for axis in (*plan.columns, *plan.axes):
        if axis.name.endswith(KEYS):
            for text in axis.texts:
                settings, _ = of_words({axis.name: text})
                yield from (setting.value for setting in settings if isinstance(setting.value, str))
