"""heun sweep --dask: a Dask scheduler and workers as processes of this machine; some of them are killed.

Whatever becomes of the workers, every variant is answered once, and to the bit as it is here.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from heuncli.analyses.variants.evaluation import Recipe, VariantEvaluator
from heuncli.analyses.variants.measures import VariantResult
from heuncli.analyses.variants.parameters import parse_axis_values
from heuncli.analyses.variants.plans import Plan, make_axes_plan
from heuncli.app.cli.entry import UsageError
from heuncli.app.commands.sweep.cluster import scheduler as cluster
from heuncli.app.commands.sweep.cluster import workers as cluster_lots
from heuncli.app.commands.sweep.cluster.connection import ClusterGone
from heuncli.app.commands.sweep.cluster.scheduler import WORKER_DIED, solve_variants
from heuncli.output.tables import measure
from heuncli.scene.file_format.source import read_text
from heuncli.study.model.options import Options
from heuncli.version import VERSION
from tests.shared.command import TURNED, Heun
from tests.shared.folders import ROOT

pytest.importorskip("distributed", reason="pip install 'heuncli[dask]'")
from tests.shared.dask_cluster import OTHER_TEXT, DaskCluster

pytestmark = pytest.mark.heavy  # processes, each of which imports Dask
FORCE = "max abs joints.pivot.force"
SWINGING = TURNED + "analysis: {duration: 0.2, samples: 3}\n"
AXES = ("m=1:2/120",)
DRIVEN = """\
heun: 1
title: A block on rails, driven by a table
ground: {points: {O: [0, 0, 0]}}
tables: {push: {file: a.csv, interpolation: cubic}}
bodies:
  block: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {a: [0, 0, 0]}}
joints:
  rail: {type: slide, from: ground.O, to: block.a, axis: [1, 0, 0]}
drives:
  motor: {joint: rail, travel: "table(push, t)"}
analysis: {duration: 1, samples: 3}
"""


@pytest.fixture(scope="module")
def dask(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DaskCluster]:
    """A scheduler; the workers that a test needs it starts."""
    found = DaskCluster(tmp_path_factory.mktemp("dask"))
    yield found
    found.end()


@pytest.fixture
def recipe(folder: Path) -> Recipe:
    """A scene that is solved in some milliseconds."""
    (folder / "swinging.yaml").write_text(SWINGING)
    path = str(folder / "swinging.yaml")
    return Recipe(path, read_text(path), tuple(measure.parse_measures((FORCE, "final energy.kinetic"))), Options(), {})


def plan(*words: str) -> Plan:
    return make_axes_plan([parse_axis_values(word) for word in words or AXES])


def here(recipe: Recipe, of: Plan) -> dict[int, VariantResult]:
    """The answers of this process."""
    asker = VariantEvaluator(recipe)
    return {number: asker.answer(of.find_values(number)) for number in of.iter_numbers()}


def there(recipe: Recipe, of: Plan, address: str, told: list[str] | None = None) -> Iterator[tuple[int, VariantResult]]:
    """The answers of the cluster."""
    tell = (told if told is not None else []).append
    return solve_variants(recipe, of, of.iter_numbers(), address, of.size, tell)


def gathered(found: Iterator[tuple[int, VariantResult]]) -> dict[int, VariantResult]:
    """The answers by their numbers, of which none may come twice."""
    answers: dict[int, VariantResult] = {}
    for number, answer in found:
        assert number not in answers
        answers[number] = answer
    return answers


def test_rows_are_those_of_a_local_sweep(heun: Heun, dask: DaskCluster, folder: Path) -> None:
    """With tables that no worker has on its disk, and variants that cannot be solved."""
    (folder / "driven.yaml").write_text(DRIVEN)
    for name, rows in {"a": "0,0\n0.4,3\n1,5\n", "b": "0,0\n0.5,1\n1,9\n"}.items():
        (folder / f"{name}.csv").write_text(rows)
    dask.with_workers(2)
    files = "tables.push.file=a.csv,b.csv,none.csv"
    whole = "tables.push={file: a.csv},{file: b.csv, interpolation: linear},{file: none.csv}"
    for word in (files, whole):
        words = ("sweep", "driven.yaml", "bodies.block.mass=1:2/11", word, "--measure", "max abs joints.rail.drive")
        local, far = heun(*words, "--format", "csv"), heun(*words, "--format", "csv", "--dask", dask.address)
        assert far == local
        assert local.returncode == 0
        assert len(local.stdout.splitlines()) == 34
        assert local.stdout.count("table-file") == 11


def test_a_worker_that_is_killed_costs_nothing(
    dask: DaskCluster, recipe: Recipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("heuncli.app.commands.sweep.cluster.workers.SECONDS", 0.2)
    monkeypatch.setattr(cluster_lots, "SECONDS", 0.2)
    dask.with_workers(2)
    answers: dict[int, VariantResult] = {}
    for number, answer in there(recipe, plan(), dask.address):
        assert number not in answers
        answers[number] = answer
        if len(answers) == 20:
            dask.workers[0].kill()
    assert answers == here(recipe, plan())


@pytest.mark.long
def test_what_is_done_stands_when_the_scheduler_goes(tmp_path: Path, recipe: Recipe) -> None:
    """And a sweep that begins before there is a worker waits for one."""
    dask, told, answers = DaskCluster(tmp_path), [], {}
    try:
        tell = lambda line: told.append(line) or dask.work()  # noqa: E731
        with pytest.raises(ClusterGone) as gone:
            for number, answer in solve_variants(
                recipe, plan(), plan().iter_numbers(), dask.address, plan().size, tell
            ):
                answers[number] = answer
                dask.scheduler.kill()
    finally:
        dask.end()
    assert told == [f"{dask.address}: no workers; waiting for them"]
    assert 0 < len(answers) < plan().size
    local = here(recipe, plan())
    assert answers == {number: local[number] for number in answers}
    assert gone.value.exit_code == 4
    # what it is depends on whether the client notices, or a call waits in vain
    first = str(gone.value).splitlines()[0].removeprefix(f"--dask {dask.address}: the scheduler ")
    assert first == "was lost [cluster-gone]" or re.fullmatch(r"no longer answers: .*\[cluster-gone\]", first)


@pytest.mark.long
def test_workers_without_this_heun_are_named_and_not_used(dask: DaskCluster, recipe: Recipe) -> None:
    [good] = dask.with_workers(1)
    others = [
        dask.lacking_heun(),
        dask.of_another_version("0.0.1"),
        dask.work("--no-nanny", "--preload", dask.preload(OTHER_TEXT)),
    ]
    dask.there(4)
    told: list[str] = []
    for _ in range(5):  # workers that have not yet said what they have when all is solved are not told of
        assert gathered(there(recipe, plan("m=1,2,3"), dask.address, told)) == here(recipe, plan("m=1,2,3"))
        if told:
            break
    reasons = (
        "heun is not installed",
        f"heun 0.0.1 there, {VERSION} here",
        f"heun {VERSION} there too, but with different code",
    )
    assert sorted(line.partition(": is not used: ")[2] for line in told) == sorted(reasons)
    assert all(line.startswith("tcp://127.0.0.1:") and good not in line for line in told)
    dask.workers[0].kill()
    dask.there(3)
    with pytest.raises(UsageError, match="no worker can be used: ") as refused:
        list(there(recipe, plan("m=1,2,3"), dask.address))
    assert all(reason in str(refused.value) for reason in reasons)
    for other in others:
        other.kill()
    dask.there(0)


@pytest.mark.long
def test_a_variant_that_ends_its_workers_is_found_out(
    dask: DaskCluster, recipe: Recipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It stands among others, whose answers come all the same; a nanny starts the worker again each time."""
    for module in (cluster, cluster_lots):
        monkeypatch.setattr(module, "WORKERS", 1)  # of more that are lost: tests of the lots
    ending = (
        "import os\n"
        "from heuncli.app.commands.sweep.cluster import worker as cluster_worker\n"
        "def ending(evaluator, values, *more, plain=cluster_worker.solve_contained):\n"
        "    os._exit(9) if values['m'].value == 5 else None\n"
        "    return plain(evaluator, values, *more)\n"
        "cluster_worker.solve_contained = ending\n"
    )
    dask.with_workers(0)
    dask.work("--nanny", "--preload", dask.preload(ending))
    dask.there(1)
    found = gathered(there(recipe, plan("m=1,2,3,4,5,6,7,8"), dask.address))
    assert found[4].code == WORKER_DIED
    assert "was lost" in found[4].reason
    local = here(recipe, plan("m=1,2,3,4,5,6,7,8"))
    assert {**found, 4: local[4]} == local
    dask.workers[-1].kill()


def test_an_interrupt_leaves_the_cluster_as_it_was(dask: DaskCluster, folder: Path) -> None:
    (folder / "swinging.yaml").write_text(SWINGING)
    dask.with_workers(1)
    words = ["sweep", "swinging.yaml", "m=1:2/2000", "--measure", FORCE, "--dask", dask.address, "--store", "s.sqlite"]
    process = subprocess.Popen(
        [sys.executable, "-m", "heuncli", *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    begun = time.monotonic()
    while not dask.at_work()[0]:
        assert time.monotonic() < begun + 60
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, complaints = process.communicate(timeout=60)
    assert process.returncode == 130
    assert complaints.splitlines()[-1].startswith("heun: interrupted: ")
    assert complaints.splitlines()[-1].endswith(" of 2000 variants are done; the same command continues with the rest")
    assert "Traceback" not in complaints
    while any(dask.at_work()):
        assert time.monotonic() < begun + 60
        time.sleep(0.1)
    dask.there(1)


@pytest.mark.parametrize(
    ("address", "code", "words"),
    [
        ("127.0.0.1:8786", "bad-option", "expected tcp://HOST:PORT"),
        ("tcp://127.0.0.1", "bad-option", "expected tcp://HOST:PORT"),
        ("tcp://127.0.0.1:port", "bad-option", "expected tcp://HOST:PORT"),
        ("tcp://127.0.0.1:8786/status", "bad-option", "expected tcp://HOST:PORT"),
        ("tcp://", "bad-option", "expected tcp://HOST:PORT"),
        ("http://127.0.0.1:8787", "bad-option", "this is the dashboard"),
        ("ucx://127.0.0.1:8786", "bad-option", "accepted: tcp://, tls://"),
        ("tcp://127.0.0.1:9", "no-cluster", "nothing listens there"),
        ("tcp://[::1]:9", "no-cluster", ""),
        ("tcp://" + "a" * 70 + ":9", "no-cluster", ""),
    ],
)
def test_addresses_at_which_there_is_nothing(heun: Heun, address: str, code: str, words: str) -> None:
    done = heun("sweep", "hanging.yaml", "m=1,2", "--measure", "energy.potential", "--dask", address)
    assert (done.returncode, done.stdout) == (2, "")
    [problem, hint] = done.stderr.splitlines()
    assert problem.startswith(f"heun: --dask {address}: ") and problem.endswith(f"[{code}]")
    assert words in done.stderr
    assert hint.startswith("  hint: ")


def test_processes_here_and_a_cluster_do_not_go_together(heun: Heun) -> None:
    words = ("--measure", "energy.potential", "--jobs", "2", "--dask", "tcp://127.0.0.1:9")
    done = heun("sweep", "hanging.yaml", "m=1,2", *words)
    assert done.returncode == 2
    assert done.stderr.startswith("heun: --jobs and --dask cannot be combined [bad-option]")


def test_tls_without_certificates(heun: Heun, dask: DaskCluster) -> None:
    address = dask.address.replace("tcp:", "tls:")
    done = heun("sweep", "hanging.yaml", "m=1,2", "--measure", "energy.potential", "--dask", address)
    assert done.returncode == 2
    assert "[no-cluster]" in done.stderr and "tls:// takes certificates" in done.stderr


def test_without_dask_the_extra_is_named(heun: Heun, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    done = heun("sweep", "hanging.yaml", "m=1,2", "--measure", "energy.potential", "--dask", "tcp://127.0.0.1:9")
    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        "heun: --dask: the package distributed is not installed [missing-extra]",
        '  hint: pip install "heuncli[dask]"',
    ]


@pytest.mark.long
def test_who_cannot_be_reached_for_long_is_given_up(
    dask: DaskCluster, recipe: Recipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "LONGEST_WAIT", 1.0)
    dask.with_workers(0)
    with pytest.raises(ClusterGone, match="no worker was available for 1 s"):
        list(there(recipe, plan(), dask.address))
