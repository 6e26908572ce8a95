"""How the tests themselves are laid out: what two of them share stands in a file that is no test; README.md is true."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from tests.shared.folders import ROOT

OTHERS = re.compile(
    r"(?:from|import)\s+tests(?:\.\w+)*\.(?:test_\w+|conftest)\b|from\s+tests[\w.]*\s+import\s+.*\b(?:test_|conftest)"
)


def test_no_file_imports_a_test_or_a_conftest() -> None:
    """Nor do the scripts that tests hand to processes of their own: the text is searched, not the imports.

    What is shared goes to tests/shared, fixtures to a conftest.py.
    """
    here = Path(__file__)
    files = [path for path in (ROOT / "tests").rglob("*.py") if path != here]
    assert len(files) > 300
    assert not [f"{path.relative_to(ROOT)}: {m[0]}" for path in files for m in OTHERS.finditer(path.read_text())]


def test_such_an_import_is_found() -> None:
    for line in (
        "from tests.cli.conftest import X",
        "import tests.spec.test_load as it",
        "from tests.spec import test_load",
    ):
        assert OTHERS.search(line)
    assert not OTHERS.search("from tests.shared.scenes import near")


@pytest.mark.heavy
def test_every_file_says_what_it_is_for() -> None:
    files = [path for path in (ROOT / "tests").rglob("*.py") if path.name != "__init__.py"]
    assert not [path for path in files if not ast.get_docstring(ast.parse(path.read_text()))]


def test_the_readme_says_of_every_folder_what_decides_there() -> None:
    text = (ROOT / "tests" / "README.md").read_text()
    listed = set(re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE))
    folders = {path.parent.relative_to(ROOT / "tests").parts[0] for path in (ROOT / "tests").glob("*/**/test_*.py")}
    assert listed == folders


def test_what_the_readme_names_exists() -> None:
    text = (ROOT / "tests" / "README.md").read_text()
    named = re.findall(r"`((?:heuncli/)?[\w/]+\.(?:py|md|toml))`", text)
    assert len(named) > 5
    places = (ROOT / "tests", ROOT)
    assert not [name for name in named if not any((place / name).exists() for place in places)]
