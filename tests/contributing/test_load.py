"""A kind of load is a row, the keys that users write, and what these mean: a magnet, whose pull is c/d^2."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pytest

from heuncli.base import load_kinds
from heuncli.base.errors import SolveError, SpecError
from heuncli.base.joint_kinds import TYPES
from heuncli.base.load_kinds import LOAD_KINDS, LoadKind
from heuncli.kernel.choose import scene as kernel
from heuncli.output.drawing import symbols
from heuncli.output.drawing.symbols import LINKS
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import LOADS
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format import loads, resolve_loads
from heuncli.scene.file_format.entries import keys_of
from heuncli.scene.file_format.fields import Moment, SiNumber
from heuncli.scene.file_format.format_loads import JointLoadEntry, PairEntry
from heuncli.scene.file_format.resolve_couplings import ReferenceResolver
from tests.contributing.addition import cited
from tests.oracle.loads import KINDS_OF_LOAD, between, pushes
from tests.oracle.read import model
from tests.oracle.scenes import random_scene
from tests.shared.folders import ROOT
from tests.shared.in_process import run_command
from tests.shared.moving_pages import data_of
from tests.shared.scenes import solved

PAGE_SYMBOLS = (ROOT / "heuncli/output/web_page/load_symbols.js").read_text(encoding="utf-8")
ROW = LoadKind(
    "magnet", "points", ("ACTUATOR",), "a pull that falls with the square of the distance of two points",
    not_negative=("strength",), symbols=("actuator",), sample={"strength": (0.1, 2)},
)  # fmt: skip


class MagnetEntry(PairEntry):
    type: Literal["magnet"]
    strength: Annotated[float, SiNumber((1, 3, -2))]


def resolve_magnet(resolver: ReferenceResolver, name: str, load: MagnetEntry) -> loads.Actuator:
    """Resolve a magnet: the force -c/d^2 along its line."""
    law = compile_expression(f"-{load.strength!r}/length**2", Scope(own={"length": "length"}, in_time=True))
    bound = resolve_loads.bind_law(resolver, law, f"forces.{name}.strength", f"{LOADS}.{name}")
    assert bound is not None
    return loads.Actuator(resolver.end(load.from_), resolver.end(load.to), bound, load.type)


SCENE = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {a: {mass: 4, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0], d: [0, 0.1, 0]}}}
joints: {u: {type: slide, from: ground.O, to: a.c, axis: [1, 0, 0], initial: {travel: PLACE, speed: 0}}}
forces: {pull: {type: magnet, from: ground.O, to: a.END, strength: 3 N m^2}}
analysis: {times: [0, 0.1, 0.2]}
"""


def scene(place: float = 2.0, end: str = "c") -> str:
    return SCENE.replace("PLACE", str(place)).replace("END", end)


@pytest.fixture(autouse=True)
def magnet(monkeypatch: pytest.MonkeyPatch) -> None:
    """The magnet in the three tables."""
    monkeypatch.setitem(LOAD_KINDS, "magnet", ROW)
    monkeypatch.setitem(fl.LOADS, "magnet", MagnetEntry)
    monkeypatch.setitem(resolve_loads.MEANINGS, "magnet", resolve_magnet)


def test_its_force() -> None:
    """It is c/d^2 wherever the body is; half the square of its speed is what the magnet gave."""
    found = solved(scene())
    d = found.forces["pull"]["length"]
    assert found.forces["pull"]["value"] == pytest.approx(-3.0 / d**2, rel=1e-14)
    assert d[-1] < d[0] - 1e-3
    speed = found.coordinates["u"]["speed"]
    assert 0.5 * 4.0 * speed**2 == pytest.approx(3.0 / d - 3.0 / d[0], rel=1e-6, abs=1e-12)
    assert found.energy["work"] == pytest.approx(0.5 * 4.0 * speed**2, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize(("place", "code"), [(0.0, "no-direction"), (0.05, "no-value")])
def test_points_that_coincide(place: float, code: str) -> None:
    """At the start, and where they meet in a run: there its pull has no bound."""
    with pytest.raises(SolveError) as caught:
        solved(scene(place))
    assert caught.value.problems[0].code == code


@pytest.mark.parametrize(("right", "wrong", "code"), [
    ("from: ground.O", "from: a.c", "same-point"), ("from: ground.O", "from: ground.P", "unknown-point"),
    ("3 N m^2", "-3 N m^2", "negative"), ("3 N m^2", "3 N", "dimension"),
])  # fmt: skip
def test_wrong_ones(right: str, wrong: str, code: str) -> None:
    with pytest.raises(SpecError) as caught:
        solved(
            scene().replace(f"magnet, {right}", f"magnet, {wrong}").replace(f"strength: {right}", f"strength: {wrong}")
        )
    assert caught.value.problems[0].code == code


def test_its_pictures(tmp_path: Path) -> None:
    """It has its symbol in a picture and on the page, its name there, and the unit of its value in the table."""
    spec, picture, page = (tmp_path / name for name in ("m.yaml", "m.svg", "m.html"))
    spec.write_text(scene(), encoding="utf-8")
    plotted = run_command(["plot", str(spec), "scene", "--output", str(picture)])
    assert (plotted.returncode, plotted.stderr) == (0, "")
    assert "pull: magnet" in picture.read_text(encoding="utf-8")
    assert run_command(["show", str(spec), "--output", str(page)]).returncode == 0
    (line,) = data_of(page.read_text(encoding="utf-8"))["scene"]["lines"]
    assert (line["name"], line["kind"]) == ("pull", ROW.symbols[0])
    assert re.search(r"^pull  magnet\n  value +N ", run_command(["run", str(spec)]).stdout, re.MULTILINE)


def test_one_in_a_joint(monkeypatch: pytest.MonkeyPatch) -> None:
    """A detent, whose torque is -c sin(4 angle), in the pins that take it."""

    class DetentEntry(JointLoadEntry):
        type: Literal["detent"]
        hold: Moment

    def resolve_detent(resolver: ReferenceResolver, name: str, load: DetentEntry) -> loads.Torque:
        law = compile_expression(f"-{load.hold!r}*sin(4*angle)", Scope(own={"angle": "angle"}, in_time=True))
        bound = resolve_loads.bind_law(resolver, law, f"forces.{name}.hold", load.joint)
        assert bound is not None
        return loads.Torque(load.joint, bound, load.type)

    row = LOAD_KINDS["motor"]._replace(name="detent", description="holds in four places", not_negative=("hold",))
    monkeypatch.setitem(LOAD_KINDS, "detent", row)
    monkeypatch.setitem(fl.LOADS, "detent", DetentEntry)
    monkeypatch.setitem(resolve_loads.MEANINGS, "detent", resolve_detent)
    monkeypatch.setitem(TYPES, "pin", TYPES["pin"]._replace(loads=(*TYPES["pin"].loads, "detent")))
    turned = scene(0.3).replace("slide", "pin").replace("travel", "angle").replace("speed", "rate")
    turned = turned.replace(
        "{type: magnet, from: ground.O, to: a.c, strength: 3 N m^2}", "{type: detent, joint: u, hold: 2}"
    )
    found = solved(turned)
    assert found.forces["pull"]["value"] == pytest.approx(-2.0 * np.sin(4.0 * found.coordinates["u"]["angle"]))
    with pytest.raises(SpecError) as caught:
        solved(turned.replace("pin", "cylinder"))
    assert caught.value.problems[0].code == "load-joint"


def test_in_random_scenes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Random scenes draw it from its row, whose pull is that of the oracle's own law."""
    monkeypatch.setitem(KINDS_OF_LOAD, "magnet", lambda own, state, t, spec: between(
        own, state, spec, lambda length, rate: -spec["strength"] / length**2
    ))  # fmt: skip
    drawn, state = random_scene(np.random.default_rng(1), 3, loads=("magnet", "force"))
    assert drawn["forces"]["f_magnet"]["type"] == "magnet"
    push, _ = pushes(model(drawn), state, 0.0)["f_magnet"]
    assert -solved(drawn).forces["f_magnet"]["value"][0] == pytest.approx(np.linalg.norm(push.force), rel=1e-10)


@pytest.mark.parametrize("kind", LOAD_KINDS.values(), ids=lambda kind: kind.name)
def test_every_row(kind: LoadKind) -> None:
    """Each names laws of the kernel and symbols that are drawn, keys that there are, and has its entry and meaning."""
    assert all(isinstance(getattr(kernel, law), int) for law in kind.kernel_laws)
    if kind.place == "points":
        assert {*kind.symbols} <= {*LINKS} and re.search(rf"^  {kind.symbols[0]}: \(pen", PAGE_SYMBOLS, re.MULTILINE)
    elif kind.is_in_joint:
        assert all(name in symbols.SYMBOLS for name in kind.symbols) and len(kind.symbols) == 3
    if kind.place not in ("rope", "thread"):
        keys = {*kind.law_keys, *kind.number_keys, *kind.required_keys, *kind.not_negative, *kind.sample}
        assert keys <= {*keys_of(fl.LOADS[kind.name])}
        assert kind.name in resolve_loads.MEANINGS


def test_its_list() -> None:
    """The list of what a load needs names the files of these tables, and is short."""
    tables = (load_kinds, fl, resolve_loads, symbols)
    named = {name for name in cited("A load") if not name.startswith("tests/contributing")}
    assert {str(Path(table.__file__ or "").relative_to(ROOT)) for table in tables} <= named
    assert len(named) <= 9
