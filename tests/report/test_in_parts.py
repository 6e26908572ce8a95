"""Long runs are composed and written part by part: the same bytes, and memory that does not grow with what is told."""

from __future__ import annotations

import io
import json
import tracemalloc
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import OutputError, SolveError
from heuncli.output.documents import as_data
from heuncli.output.tables import export
from heuncli.output.tables.export import iter_csv_pieces, iter_json_pieces
from heuncli.results import stored_arrays
from heuncli.results.stored_arrays import ArrayStore
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose import recovery, results
from heuncli.study.model import options
from heuncli.study.model.options import Options
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.study import Study
from heuncli.study.solve import load_errors
from heuncli.study.workflow import solve
from tests.shared.command import Heun
from tests.shared.folders import SPECS

TREES = ("cart_pole", "chain", "charpy", "clock", "double", "drawer", "drill", "journal", "lamp", "trolley", "wingnut")
CHAINS = ("four_bar", "engine", "excavator")  # closed, with nothing indeterminate
WHOLE = ("door", "slider_crank_pins", "bricard", "chimney", "overhang")  # indeterminate, or one instant
SWINGING = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar: {{shapes: [{{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 0.01, mass: 1}}],
         points: {{top: [0, 0, 0], end: [0, 0, -1]}}}}
joints: {{pivot: {{type: pin, from: ground.O, to: bar.top, axis: [0, 1, 0], initial: {{angle: 0.5}}}}}}
sections: {{along: {{body: bar, from: top, to: end, count: {cuts}}}}}
analysis: {{duration: 1, samples: {samples}, tolerance: 1e-6}}
"""


def swinging(samples: int, cuts: int = 3) -> Spec:
    return load("swinging.yaml", text=SWINGING.format(samples=samples, cuts=cuts))


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts of eight instants, and texts of a few numbers."""
    for module, name, value in (
        (options, "FEW", 0), (results, "AT_ONCE", 1), (export, "AT_ONCE", 11), (as_data, "AT_ONCE", 11),
        (export, "READ", 23),
        (stored_arrays, "TOGETHER", 5), (stored_arrays, "AT_ONCE", 7),
    ):  # fmt: skip
        monkeypatch.setattr(module, name, value)


def texts(study: Study) -> tuple[str, str]:
    """The results in JSON and in CSV, but for the times that the run took."""
    study.results.work["seconds"] = {}
    return "".join(iter_json_pieces(study.results)), "".join(iter_csv_pieces(study.results, make_labels(study.spec)))


def both(spec: Spec) -> tuple[Study, Study]:
    """Composed at once, and part by part where that can be."""
    return solve(spec, Options()), solve(spec, Options(in_parts=True))


@pytest.mark.heavy
@pytest.mark.parametrize("name", [*TREES, *CHAINS, *WHOLE])
@pytest.mark.third
def test_parts_are_written_as_the_whole_is(name: str, small: None, monkeypatch: pytest.MonkeyPatch) -> None:
    spec = load(str(SPECS / f"{name}.yaml"))
    whole, divided = both(spec)
    assert (divided.result_recovery is None) == (name in TREES + CHAINS)
    assert divided.results.warnings == whole.results.warnings
    found = texts(divided)
    for module, name_of_part in ((as_data, "AT_ONCE"), (export, "AT_ONCE"), (export, "READ")):
        monkeypatch.setattr(module, name_of_part, 10**9)
    assert found == texts(whole)
    json.loads(found[0])


def test_parts_of_many_sizes() -> None:
    """Whole blocks but for the last, which has no row alone."""
    for count in range(2, 70):
        for at_once in range(40):
            found = results.divide_instants(count, at_once)
            assert [k for part in found for k in range(count)[part]] == list(range(count))
            assert all(part.start % results.BLOCK == 0 and part.stop - part.start >= min(count, 8) for part in found)
            assert max(part.stop - part.start for part in found) < 2 * max(at_once, results.BLOCK) + results.BLOCK


PULLED = """\
heun: 1
bodies: {b: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}
joints: {guide: {type: slide, from: {body: ground, at: [0, 0, 0]}, to: b.c, axis: [1, 0, 0]}}
forces: {pull: {type: force, on: b.c, vector: [0, "1e-11 + 1e3*step(t - 0.5)", 0]}}
analysis: {duration: 1, samples: 32}
"""


def test_a_total_is_none_beside_the_largest_force_of_the_whole_run(small: None) -> None:
    """In the first half a part by itself sees nothing larger, and would tell its axis."""
    spec = load("pulled.yaml", text=PULLED)
    whole, divided = both(spec)
    assert divided.result_recovery is None
    assert np.isnan(whole.results.foundation["axis"]["pitch"]).sum() == 16
    assert texts(divided) == texts(whole)
    alone = whole.resample(np.array([0.1, 0.2])).foundation["axis"]["direction"]
    assert np.isfinite(alone).all()


RUBBED = """\
heun: 1
gravity: [0, 0, -9.81]
bodies: {b: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], velocity: [2, 0, 0], points: {c: [0, 0, 0]}}}
joints: {guide: {type: slide, from: {body: ground, at: [0, 0, 0]}, to: b.c, axis: [1, 0, 0]}}
forces:
  pull: {type: force, on: b.c, vector: [0, "1e3*step(t - 0.5)", 0]}
  rub: {type: friction, joint: guide, force: 6, speed: 0.1}
analysis: {duration: 1, samples: 32}
"""


def test_causes_and_notes_are_those_of_the_whole_run(small: None) -> None:
    """In the first half the pull has no effect, and only in the second the friction is not full."""
    spec = load("rubbed.yaml", text=RUBBED)
    wanted = frozenset({"joints", "foundation", "shares"})
    whole, divided = (solve(spec, Options(requested_reports=wanted, in_parts=parts)) for parts in (False, True))
    assert divided.result_recovery is None and "pull" in whole.results.joints["guide"]["shares"]
    assert texts(divided) == texts(whole)
    assert any("do not include full friction" in note for note in divided.results.model["notes"])


def test_what_is_not_finite_is_refused_in_the_same_words(small: None, monkeypatch: pytest.MonkeyPatch) -> None:
    energy = recovery.energy_block

    def broken(layout: Any, recovered: Any, *given: Any) -> Any:
        block = energy(layout, recovered, *given)
        return block | {"kinetic": np.where(recovered.times > 0.55, np.inf, block["kinetic"])}

    monkeypatch.setattr(recovery, "energy_block", broken)
    told = []
    for in_parts in (False, True):
        with pytest.raises(SolveError) as caught:
            solve(swinging(21), Options(in_parts=in_parts))
        told.append(str(caught.value))
    assert told[0] == told[1] and "energy.kinetic is not finite at t = 0.6 s" in told[0]


@pytest.mark.parametrize("form", ["json", "csv"])
def test_a_command_writes_the_parts(heun: Heun, folder: Path, form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "s.yaml").write_text(SWINGING.format(samples=31, cuts=4))
    words = ("run", "s.yaml", "--format", form, "--strict")
    whole = heun(*words)
    monkeypatch.setattr(options, "FEW", 0)
    monkeypatch.setattr(results, "AT_ONCE", 1000)
    stores: list[ArrayStore] = []
    made = ArrayStore.__init__

    def noted(self: ArrayStore) -> None:
        stores.append(self)
        made(self)

    monkeypatch.setattr(ArrayStore, "__init__", noted)
    divided = heun(*words)
    assert len(stores) == 1
    assert (divided.returncode, divided.stderr) == (whole.returncode, whole.stderr)
    assert without_times(divided.stdout) == without_times(whole.stdout)


def without_times(text: str) -> list[str]:
    words = ('"load":', '"build":', '"integrate":', '"check":', '"recover":')
    return [line for line in text.splitlines() if not line.strip().startswith(words)]


def test_a_disk_that_is_full_is_5(heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is written then, and no half of anything is left."""
    monkeypatch.setattr(options, "FEW", 0)

    class Full(io.BytesIO):
        def write(self, _: Any) -> int:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr("tempfile.TemporaryFile", lambda **_: Full())
    (folder / "s.yaml").write_text(SWINGING.format(samples=31, cuts=4))
    done = heun("run", "s.yaml", "-o", "out.json")
    assert (done.returncode, done.stdout) == (5, "")
    assert "temporary results file: No space left on device" in done.stderr and "TMPDIR" in done.stderr
    assert not (folder / "out.json").exists()


def test_stored_arrays_are_the_arrays_that_were_put_there(small: None) -> None:
    rng = np.random.default_rng(3)
    store, wanted, stored = ArrayStore(), [], []
    for shape in ((9,), (9, 3), (9, 3, 3), (9, 40)):
        wanted.append(rng.random(shape))
        stored.append(store.allocate(shape))
    for first, end in ((0, 4), (4, 9)):
        for array, values in zip(stored, wanted, strict=True):
            array.write_rows(first, values[first:end])
    for array, values in zip(stored, wanted, strict=True):
        assert (array.shape, array.size, array.ndim, len(array)) == (values.shape, values.size, values.ndim, 9)
        np.testing.assert_array_equal(array[2:7], values[2:7])
        rows, flat = array.reshape(9, -1), values.reshape(9, -1)
        for columns in (slice(0, 2), slice(1, None), slice(None)):
            np.testing.assert_array_equal(rows[1:8, columns], flat[1:8, columns])
        np.testing.assert_array_equal(np.concatenate([*stored_arrays.iter_chunks(array)]), values)
    with pytest.raises(ValueError, match="become rows"):
        stored[2].reshape(-1)
    with pytest.raises(OutputError, match="is incomplete"):
        store.allocate((2,))[:]


# Memory: what is held at a time, by how it grows.


def peak(spec: Spec, wanted: frozenset[str], write: Any) -> int:
    """The most that is held while a scene is solved and written down [bytes]."""
    tracemalloc.start()
    try:
        study = solve(spec, Options(requested_reports=wanted, in_parts=True))
        assert study.result_recovery is None
        for _ in write(study.results):
            pass
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def pieces(form: str, spec: Spec) -> Any:
    return iter_json_pieces if form == "json" else partial(iter_csv_pieces, labels=make_labels(spec))


@pytest.fixture
def little(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """As little at a time as memory shows it: the parts themselves would hide how it grows."""
    for module, name, value in (
        (options, "FEW", 0), (results, "AT_ONCE", 20_000), (export, "AT_ONCE", 2_000), (as_data, "AT_ONCE", 2_000),
        (export, "READ", 20_000),
        (load_errors, "CUTS_AT_ONCE", 2_000),
    ):  # fmt: skip
        monkeypatch.setattr(module, name, value)
    monkeypatch.setattr("heuncli.motion.integration.check.estimate.MAX_NUMBERS", 100_000)
    peak(swinging(50), frozenset({"energy"}), iter_json_pieces)  # what is loaded once
    yield


@pytest.mark.heavy
@pytest.mark.parametrize("form", ["json", "csv"])
def test_a_sample_takes_its_states_and_nothing_else(form: str, little: None) -> None:
    """Some 7 numbers of state in two runs, its instant, as a number and as text; 15 numbers are told, and by cause."""
    few, many = (swinging(n, 2) for n in (3_000, 12_000))
    wanted = frozenset({"joints", "shares"})
    a, b = (peak(spec, wanted, pieces(form, spec)) for spec in (few, many))
    assert (b - a) / 9_000 <= 250.0, f"{(b - a) / 9_000:.0f} bytes a sample"


@pytest.mark.heavy
@pytest.mark.parametrize("form", ["json", "csv"])
@pytest.mark.third
def test_cuts_times_samples_take_nothing(form: str, little: None) -> None:
    """400 cuts at 50 instants more are 20,000 more places, each of 15 numbers."""
    few, many = (swinging(n, 400) for n in (20, 70))
    wanted = frozenset({"sections"})
    a, b = (peak(spec, wanted, pieces(form, spec)) for spec in (few, many))
    assert (b - a) / 20_000 <= 5.0, f"{(b - a) / 20_000:.1f} bytes a place"
