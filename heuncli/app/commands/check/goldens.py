"""Find the golden file of a spec, and check the options about golden files. Impure: reads folders and files.

The golden file of a spec found in a folder has the same path below DIR, with `.json`. That of a spec named directly has
the longest end of its path that exists there, so that a hook that names single files finds those of the whole folder.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path, PurePath

from heuncli.app.cli.entry import UsageError
from heuncli.app.commands.check.folders import FoundSpec
from heuncli.app.commands.check.request import CheckRequest
from heuncli.base.errors import Finding, HeunError, Problem, SourceLocation
from heuncli.base.text_safety import escape
from heuncli.scene.file_format.reading import STANDARD_INPUT

SUFFIX = ".json"
CI_OFF = ("", "0", "false", "no")  # values of CI that mean "no"


class GoldenError(HeunError):
    """A golden file that cannot be used."""

    exit_code = 2


def require_consistent_options(request: CheckRequest) -> None:
    """Raise UsageError if the options about golden files contradict each other."""
    if request.golden is None:
        for word, is_given in (
            ("--update", request.update), ("--strict", request.strict),
            ("--golden-tolerance", request.golden_tolerance is not None),
        ):  # fmt: skip
            if is_given:
                raise UsageError(Problem("bad-option", f"{word} without --golden", hint="for example --golden golden"))
        return
    if request.force and not request.update:
        raise UsageError(
            Problem("bad-option", "--force without --update", hint="--force allows --update where CI is set")
        )
    share = request.golden_tolerance
    if share is not None and not 0.0 < share < 1.0:
        hint = "for example 1e-6; without it, the stated errors apply"
        raise UsageError(
            Problem("bad-option", f"--golden-tolerance {share:g}: expected a fraction between 0 and 1", hint=hint)
        )
    if request.update and not request.force and os.environ.get("CI", "").lower() not in CI_OFF:
        hint = "run it locally, review the changes and commit the files; --force writes here too"
        raise UsageError(Problem("bad-option", "--update where CI is set: a pipeline would approve itself", hint=hint))
    folder = Path(request.golden)
    if folder.exists() and not folder.is_dir():
        raise UsageError(Problem("bad-option", f"--golden {request.golden}: not a folder", hint="give a folder"))
    if not folder.exists() and not request.update:
        hint = "--update creates it from the current results"
        raise UsageError(Problem("bad-option", f"--golden {request.golden}: there is no such folder", hint=hint))


def map_golden_files(specs: Sequence[FoundSpec], folder: str) -> dict[str, str]:
    """Return the golden file of each spec, by the spec's path. Raises UsageError if two specs would have the same
    one.
    """
    files: dict[str, str] = {}
    owners: dict[str, str] = {}
    for one in specs:
        if one.path == STANDARD_INPUT:
            raise UsageError(Problem("bad-option", "--golden with standard input: it has no path", hint="name a file"))
        file = find_golden_file(one, folder)
        other = owners.setdefault(file, one.path)
        if os.path.realpath(other) != os.path.realpath(one.path):
            hint = "give their common parent folder, or check them separately with separate golden folders"
            raise UsageError(
                Problem("bad-option", f"--golden: {other} and {one.path} would both use {file}", hint=hint)
            )
        files[one.path] = file
    return files


def find_golden_file(one: FoundSpec, folder: str) -> str:
    """Return the path of a spec's golden file."""
    if one.folder is not None:
        return str(Path(folder, os.path.relpath(one.path, one.folder)).with_suffix(SUFFIX))
    parts = [part for part in PurePath(one.path).parts if part not in (os.curdir, os.pardir, os.sep)]
    tails = [str(Path(folder, *parts[start:]).with_suffix(SUFFIX)) for start in range(len(parts))]
    return next((tail for tail in tails if Path(tail).is_file()), tails[-1])


def make_spec_name(file: str, spec: str, folder: str) -> str:
    """Return the path by which a golden file names its spec: its own path below the folder, with the spec's ending."""
    return PurePath(os.path.relpath(file, folder)).with_suffix(PurePath(spec).suffix).as_posix()


def require_inside(file: str, folder: str) -> None:
    """Raise GoldenError if a file is a link that leads out of the folder, or a folder itself."""
    inside, real = os.path.realpath(folder), os.path.realpath(file)
    if os.path.commonpath([inside, real]) != inside:
        raise make_golden_error(
            file,
            Finding("not-golden", f"this link leads out of {escape(folder)}, to {escape(real)}", "remove the link"),
        )
    if Path(file).is_dir():
        raise make_golden_error(
            file, Finding("not-golden", "this is a folder", "remove it, or choose another place for --golden")
        )


def make_golden_error(file: str, finding: Finding) -> GoldenError:
    """Make the error of a golden file."""
    return GoldenError(Problem(finding.code, finding.message, SourceLocation(file, 1, 1), finding.hint))


def find_orphans(folder: str, files: Iterable[str]) -> list[str]:
    """Return the golden files in a folder that belong to none of the specs, sorted."""
    known = {os.path.realpath(file) for file in files}
    paths = (str(path) for path in sorted(Path(folder).rglob("*" + SUFFIX)) if path.is_file())
    return [path for path in paths if os.path.realpath(path) not in known]
