"""The moving machine as glTF: read back by its standard and by another program it is the run, to single precision."""

from __future__ import annotations

import io
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from heuncli.output.figures.courses import choose_instants
from heuncli.output.machine_geometry.elements import collect_elements
from heuncli.output.machine_geometry.gltf import encode_gltf
from heuncli.output.machine_geometry.machine import BodyGeometry, Machine, find_drawn_shapes, make_machine
from heuncli.output.machine_geometry.poses import Poses, compute_poses, find_up_direction
from heuncli.output.machine_geometry.solids import ROD_RADIUS_RATIO, ROUND_FACES
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Shape, Spec
from heuncli.study.workflow import solve
from tests.shared.command import Heun
from tests.shared.folders import SPECS
from tests.shared.glb import Glb

pytestmark = pytest.mark.heavy  # of the kernels' numbers pictures see the first seven digits

FILES = sorted(path.stem for path in SPECS.glob("*.yaml"))
SINGLE = float(np.finfo(np.float32).eps)
# What of a circle and of a sphere flat faces leave: sides of a polygon, and the frusta between a sphere's rings.
OF_CIRCLE = ROUND_FACES / (2.0 * math.pi) * math.sin(2.0 * math.pi / ROUND_FACES)
LEVELS = 2.0 * math.pi * np.arange(ROUND_FACES // 2 + 1) / ROUND_FACES


@cache
def drawn(name: str) -> tuple[Spec, Machine, Poses, bytes]:
    """A worked example solved and written, once for all that looks at it."""
    solved = solve(load(SPECS / f"{name}.yaml"))
    machine, poses = make_machine(solved.spec), compute_poses(solved, choose_instants(solved))
    return solved.spec, machine, poses, encode_gltf(machine, poses, find_up_direction(solved.spec, poses))


def matrices(xyzw: Array) -> Array:
    """Rotation matrices (n, 3, 3) of unit quaternions (n, 4), as glTF's readers make them."""
    x, y, z, w = xyzw.T.astype(np.float64)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    return np.moveaxis(np.array(rows), 2, 0)


@pytest.mark.parametrize("name", FILES)
@pytest.mark.third
def test_bodies_stand_where_the_run_has_them(name: str) -> None:
    """At every instant, those on both sides of a jump too, which are one instant in the file."""
    _, machine, poses, content = drawn(name)
    glb = Glb(content)
    instants, of_run = np.unique((poses.times - poses.times[0]).astype(np.float32), return_inverse=True)
    for body in machine.bodies:
        node = glb.node(body.name)
        still = {key: (instants, np.array([node[key]])) for key in ("translation", "rotation")}
        moved = glb.courses(body.name) if len(instants) > 1 else still
        (times, places), (same, turns) = moved["translation"], moved["rotation"]
        assert np.array_equal(times, instants)
        assert np.array_equal(same, instants)
        size = max(1.0, float(np.abs(poses.positions[body.name]).max()))
        assert np.allclose(places[of_run], poses.positions[body.name], rtol=0.0, atol=SINGLE * size)
        assert np.allclose(np.linalg.norm(turns, axis=1), 1.0, rtol=0.0, atol=2 * SINGLE)
        assert np.allclose(matrices(turns)[of_run], poses.orientations[body.name], rtol=0.0, atol=4 * SINGLE)
        assert np.all(np.sum(turns[1:] * turns[:-1], axis=1) > 0.0)


@pytest.mark.parametrize("name", FILES)
@pytest.mark.third
def test_another_program_finds_each_shape_closed_and_of_its_volume(name: str) -> None:
    spec, machine, _, content = drawn(name)
    told = trimesh.load(io.BytesIO(content), file_type="glb")
    found: dict[str, list[trimesh.Trimesh]] = {}
    for node in told.graph.nodes_geometry:
        mesh = told.geometry[told.graph[node][1]]
        if isinstance(mesh, trimesh.Trimesh):  # of several shapes each hangs on the body as a node of its own there
            body = node if node in spec.bodies else told.graph.transforms.parents[node]
            found.setdefault(body, []).append(mesh)
    for look in machine.bodies:
        meshes = found.pop(look.name, [])
        volumes = [
            volume(shape)
            for shape in find_drawn_shapes(spec, look.name, collect_elements(spec, None).discs.get(look.name, ()))
            if shape.type != "point"
        ]
        if look.surfaces and not volumes:
            volumes = [hull_volume(look)]
        with np.errstate(invalid="ignore"):  # flat things have no volume to divide by
            told_volumes = [float(mesh.volume) for mesh in meshes]
        assert sorted(told_volumes) == pytest.approx(sorted(volumes), rel=1e-5, abs=1e-12)
        closed = [mesh for mesh, size in zip(meshes, told_volumes, strict=True) if size > 1e-12]
        assert all(mesh.is_watertight and mesh.is_winding_consistent for mesh in closed)
    assert not found


def hull_volume(look: BodyGeometry) -> float:
    """The volume of the hull of a body's points and its centre of mass; 0 of a plate."""
    (surface,) = look.surfaces
    offsets = surface.corners - surface.corners.mean(axis=0)
    if np.linalg.matrix_rank(offsets, tol=1e-6 * np.abs(offsets).max()) < 3:
        return 0.0
    return float(ConvexHull(surface.corners).volume)


def ball(radius: float) -> float:
    """The volume of a sphere of frusta between rings whose sides are flat."""
    r, q = np.sin(LEVELS[:-1]), np.sin(LEVELS[1:])
    height = np.cos(LEVELS[:-1]) - np.cos(LEVELS[1:])
    return float(math.pi * OF_CIRCLE * np.sum(height * (r * r + r * q + q * q)) / 3.0) * radius**3


def volume(shape: Shape) -> float:
    """The volume of a shape whose round faces are flat ones."""
    if shape.type == "box":
        return float(np.prod(shape.size))
    if shape.type == "sphere":
        return ball(shape.radius or 0.0)
    if shape.mesh is not None and shape.scale is not None:
        return shape.mesh.volume * shape.scale**3
    length = math.dist(shape.from_ or (), shape.to or ())
    if shape.member is not None:  # drawn without its fillets; those of the specs are I and C, and do not taper
        assert shape.member.family in "IC" and shape.member.start == shape.member.end
        m = shape.member.start
        return length * (m.height * m.web + 2.0 * (m.width - m.web) * (m.flange - 0.5 * m.slope * m.web))
    if shape.type == "rod":
        return math.pi * OF_CIRCLE * length * (ROD_RADIUS_RATIO * length) ** 2
    r, inner = shape.radius or 0.0, shape.inner_radius or 0.0
    q = r if shape.to_radius is None else shape.to_radius
    return math.pi * OF_CIRCLE * length * ((r * r + r * q + q * q) / 3.0 - inner * inner)


@pytest.mark.parametrize("name", FILES)
@pytest.mark.third
def test_up_is_y_and_lengths_are_metres(name: str) -> None:
    """A point of a body through the nodes as readers stack them: gravity pulls along -y."""
    spec, machine, _, content = drawn(name)
    glb = Glb(content)
    (root,) = glb.head["scenes"][glb.head["scene"]]["nodes"]
    world = glb.head["nodes"][root]
    assert world["name"] == spec.title
    R = matrices(np.array([world["rotation"]]))[0]
    gravity = R @ np.array(spec.gravity)
    assert gravity == pytest.approx([0.0, -float(np.linalg.norm(spec.gravity)), 0.0], abs=1e-12)
    assert {glb.head["nodes"][k]["name"] for k in world["children"]} == {"ground", *spec.bodies}
    for point, place in machine.ground_points.items():
        assert glb.node(f"ground.{point}")["translation"] == place.tolist()
    for body in machine.bodies:
        for point, place in body.points.items():
            assert glb.node(f"{body.name}.{point}")["translation"] == place.tolist()
        lines = [glb.numbers(part["attributes"]["POSITION"]) for part in parts(glb, body.name) if part["mode"] < 4]
        drawn_lines = [line for line in body.strokes if len(line)]
        assert len(lines) == len(drawn_lines)
        for found, line in zip(lines, drawn_lines, strict=True):
            assert np.allclose([*found[:1], *found[1::2]], line, rtol=SINGLE)


def parts(glb: Glb, body: str) -> list[dict[str, int]]:
    """The parts of the mesh of a body."""
    mesh = glb.node(body).get("mesh")
    return glb.head["meshes"][mesh]["primitives"] if mesh is not None else []


@pytest.mark.parametrize("name", FILES)
@pytest.mark.third
def test_between_its_instants_no_body_turns_so_far_that_the_shortest_way_is_another(name: str) -> None:
    for turns in drawn(name)[2].quaternions.values():
        near = np.abs(np.sum(turns[1:] * turns[:-1], axis=1)).min(initial=1.0)
        assert 2.0 * math.acos(min(near, 1.0)) < math.pi / 4.0


def test_bytes_repeat_and_say_when_the_run_begins() -> None:
    solved = solve(load(SPECS / "engine.yaml"))
    poses = compute_poses(solved, np.linspace(0.5 * solved.results.time[-1], solved.results.time[-1], 9))
    machine, up = make_machine(solved.spec), find_up_direction(solved.spec, poses)
    content = encode_gltf(machine, poses, up)
    assert encode_gltf(machine, poses, up) == content
    assert Glb(content).head["extras"] == {"start": poses.times[0]}


def test_heun_show_writes_it_beside_the_page_or_alone(heun: Heun, folder: Path) -> None:
    assert heun("show", "swinging.yaml", "--glb", "alone.glb").returncode == 0
    assert heun("show", "swinging.yaml", "-o", "page.html", "--glb", "beside.glb").returncode == 0
    alone = (folder / "alone.glb").read_bytes()
    assert alone == (folder / "beside.glb").read_bytes()
    assert (folder / "page.html").exists()
    glb = Glb(alone)
    assert glb.courses("bar")["rotation"][0][-1] == 1.0
    assert heun("show", "hanging.yaml", "--glb", "rest.glb").returncode == 0
    assert "animations" not in Glb((folder / "rest.glb").read_bytes()).head


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--glb", "x.gltf"), "--glb x.gltf: unknown file extension"),
        (("--glb", "nowhere/x.glb"), "there is no folder nowhere"),
        (("-o", "-", "--glb", "/dev/stdout"), "unknown file extension"),
        ((), "no output file is given"),
    ],
)
def test_what_cannot_be_written_is_told_before_any_work(heun: Heun, folder: Path, words: list[str], told: str) -> None:
    before = sorted(folder.iterdir())
    done = heun("show", "swinging.yaml", *words)
    assert done.returncode in (2, 5)
    assert told in done.stderr
    assert sorted(folder.iterdir()) == before


def test_a_spec_or_the_page_is_not_written_over(heun: Heun, folder: Path) -> None:
    spec = folder / "spec.glb"
    spec.write_text((folder / "swinging.yaml").read_text())
    assert "would overwrite the spec itself" in heun("show", "spec.glb", "--glb", "spec.glb").stderr
    (folder / "page.html").symlink_to(folder / "x.glb")
    assert "the page is written to this file" in heun("show", "spec.glb", "-o", "page.html", "--glb", "x.glb").stderr
    assert not (folder / "x.glb").exists()


def test_what_turns_too_fast_to_be_followed_is_told(heun: Heun, folder: Path) -> None:
    """300 turns a second for 40 s are 12,000 turns: no 4,000 instants show them."""
    text = (folder / "hanging.yaml").read_text().replace("type: ball", "type: pin, axis: [0, 0, 1]")
    driven = "drives:\n  motor: {joint: pivot, rate: 2000}\nanalysis: {duration: 40, samples: 3}\n"
    (folder / "fast.yaml").write_text(text + driven)
    done = heun("show", "fast.yaml", "--glb", "fast.glb")
    assert done.returncode == 0
    assert "a body rotates up to" in done.stderr
