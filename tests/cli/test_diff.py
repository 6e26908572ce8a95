"""`heun diff`: what changed of two specs, golden files and results, and what is not compared."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from heuncli.output.snapshots.changes import Tolerance, _compare_sums
from heuncli.output.snapshots.golden_file import NumberSnapshot, SumSnapshot
from tests.shared.command import Heun


@pytest.fixture
def pair(folder: Path) -> tuple[str, str]:
    """A swinging bar, and one that is heavier by a tenth."""
    text = (folder / "swinging.yaml").read_text()
    (folder / "heavier.yaml").write_text(text.replace("m: 1.0", "m: 1.1"))
    return "swinging.yaml", "heavier.yaml"


def test_the_same_spec_has_not_changed(heun: Heun) -> None:
    done = heun("diff", "swinging.yaml", "swinging.yaml", "--exit-code")
    assert done.returncode == 0
    assert done.stdout.startswith("no change exceeds both stated errors: ")


@pytest.mark.heavy
def test_the_largest_relative_change_comes_first(heun: Heun, pair: tuple[str, str]) -> None:
    """A heavier bar of the same inertia: its weight is 1.1 of what it was."""
    done = heun("diff", *pair, "--format", "json", "--exit-code")
    assert done.returncode == 1
    found = json.loads(done.stdout)["changes"]
    sizes = [change["relative"] for change in found if change["relative"] is not None]
    assert sizes == sorted(sizes, reverse=True)
    assert {"of", "at", "unit", "before", "after", "difference", "allowed", "why"} <= found[0].keys()
    assert heun("diff", *pair).returncode == 0


@pytest.mark.heavy
def test_a_spec_against_its_golden_file_and_two_of_these(heun: Heun, pair: tuple[str, str]) -> None:
    heun("check", *pair, "--golden", "g", "--update", "--force")
    assert "no change exceeds" in heun("diff", "g/swinging.json", "swinging.yaml").stdout
    assert "no change exceeds" in heun("diff", "swinging.yaml", "g/swinging.json").stdout
    one = json.loads(heun("diff", "g/swinging.json", "g/heavier.json", "--format", "json").stdout)["changes"]
    other = json.loads(heun("diff", *pair, "--format", "json").stdout)["changes"]
    assert one == other


def test_results_are_compared_by_their_samples(heun: Heun, pair: tuple[str, str], folder: Path) -> None:
    for name in pair:
        heun("run", name, "--format", "json", "-o", f"{name}.json")
    assert "no change exceeds" in heun("diff", "swinging.yaml.json", "swinging.yaml.json").stdout
    changed = json.loads(heun("diff", *(f"{name}.json" for name in pair), "--format", "json").stdout)["changes"]
    results = [json.loads((folder / f"{name}.json").read_text()) for name in pair]
    highest = [max(row[2] for row in result["joints"]["pivot"]["force"]) for result in results]
    row = next(one for one in changed if one["of"] == "joints.pivot.force.z" and one["at"] == "greatest")
    assert [row["before"], row["after"]] == highest


def test_a_result_is_not_held_against_what_is_searched_between_samples(heun: Heun) -> None:
    heun("run", "swinging.yaml", "--format", "json", "-o", "r.json")
    done = heun("diff", "swinging.yaml", "r.json")
    assert (done.returncode, "[bad-option]" in done.stderr) == (2, True)


@pytest.mark.parametrize(
    "text", ["hello", "{", "[1]", "{}", '{"time": [0], "model": {}, "status": {}, "accuracy": {}}']
)
def test_what_is_neither_is_told_by_its_path(heun: Heun, folder: Path, text: str) -> None:
    (folder / "bad.json").write_text(text)
    done = heun("diff", "bad.json", "swinging.yaml")
    assert done.returncode == 2
    assert done.stderr.startswith("bad.json:1:1: ")
    assert "[not-a-result]" in done.stderr


@pytest.mark.heavy
def test_forms_for_a_pull_request(heun: Heun, pair: tuple[str, str]) -> None:
    assert heun("diff", *pair, "--format", "markdown").stdout.startswith("### heun diff: ")
    assert heun("diff", *pair, "--format", "github").stdout.startswith("::warning file=heavier.yaml,title=heun%3A ")


@pytest.mark.heavy
def test_results_at_other_instants_are_compared_where_both_are(heun: Heun, folder: Path) -> None:
    """Samples at other instants have other extremes of the same motion; at the common ones nothing differs."""
    for name, samples in (("few", 5), ("many", 9), ("other", 4)):
        heun("run", "swinging.yaml", "--set", f"analysis.samples={samples}", "--format", "json", "-o", f"{name}.json")
    done = heun("diff", "few.json", "many.json")
    assert "5 of 5 and 9 are common, and only these are compared" in done.stdout
    assert "no change exceeds" in done.stdout
    assert "2 of 4 and 9 are common" in heun("diff", "other.json", "many.json").stdout
    heun(
        "run", "swinging.yaml", "--set", "m=1.1", "--set", "analysis.samples=9", "--format", "json", "-o", "heavy.json"
    )
    changed = json.loads(heun("diff", "few.json", "heavy.json", "--format", "json").stdout)["changes"]
    assert any(row["of"] == "joints.pivot.force.z" for row in changed)
    result = json.loads((folder / "few.json").read_text())
    result["time"] = [t + 10.0 for t in result["time"]]
    (folder / "later.json").write_text(json.dumps(result))
    refused = heun("diff", "later.json", "many.json")
    assert (refused.returncode, "no instant in common" in refused.stderr) == (2, True)


def test_a_sum_is_compared_in_all_that_one_run_has() -> None:
    value = NumberSnapshot(unit="N", error=0.1, first=1.0, last=1.0)
    old = SumSnapshot(factors={"a": 1.0}, error=0.0, value=value)
    new = SumSnapshot(factors={"a": 1.0, "b": 1.0}, error=0.0, value=value.model_copy(update={"least": 0.0}))
    for pair in ((old, new), (new, old)):
        assert [change.what for change in _compare_sums("s", *pair, Tolerance(None, {}))] == ["factor of b", "least"]
    assert not [*_compare_sums("s", old, old, Tolerance(None, {}))]
