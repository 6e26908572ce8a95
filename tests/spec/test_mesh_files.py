"""Files of meshes: what is read is the solid that was written; what is none is refused, and never with a traceback."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.base.errors import Finding, SpecError
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.scene.meshes.model import TriangleMesh
from heuncli.scene.meshes.reading import read_closed_mesh
from tests.shared import triangles as t

UNIT = t.box()
RING = t.torus(30, 16)


def read(triangles: Array) -> TriangleMesh:
    return read_closed_mesh(t.binary_stl(triangles), "body.stl")


def code_of(triangles: Array) -> str:
    with pytest.raises(Finding) as caught:
        read(triangles)
    assert caught.value.hint
    return caught.value.code


def volume(triangles: Array) -> float:
    """The sum of the tetrahedra to the origin, one after the other."""
    return sum(float(np.linalg.det(one)) for one in triangles) / 6.0


WRITERS = {
    "binary.stl": t.binary_stl,
    "text.STL": lambda x: t.text_stl(x).encode(),
    "crlf.stl": lambda x: t.text_stl(x, "a facet of vertex 1").upper().replace("\n", "\r\n").encode(),
    "a.obj": lambda x: t.obj(x).encode(),
    "slashes.obj": lambda x: ("mtllib a\nvn 0 0 1\n" + t.obj(x)).replace("\nf ", "\ng a\nf ").encode(),
    "text.ply": t.ply,
    "little.ply": lambda x: t.ply(x, "<"),
    "big.ply": lambda x: t.ply(x, ">"),
}


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_gives_the_solid(name: str) -> None:
    mesh = read_closed_mesh(WRITERS[name](RING), name)
    assert mesh.volume == pytest.approx(volume(RING), rel=3e-7 if name.lower().endswith("stl") else 1e-14)
    assert (len(mesh.corners), len(mesh.triangles), mesh.shells, mesh.notes) == (480, 960, 1, ())
    assert mesh.low == pytest.approx(RING.min(axis=(0, 1)), abs=1e-6)


def test_all_solids_of_a_text_are_read_however_they_are_written() -> None:
    small, capital = t.text_stl(UNIT), t.text_stl(UNIT + 2.0, "other").upper()
    for written in (small + capital, capital + small, small + t.text_stl(UNIT + 2.0)):
        mesh = read_closed_mesh(written.encode(), "a.stl")
        assert (mesh.shells, mesh.volume) == (2, pytest.approx(2.0))


def test_faces_of_four_corners_and_numbers_counted_back() -> None:
    corners = [f"v {k & 1} {k >> 1 & 1} {k >> 2 & 1}" for k in range(8)]
    faces = [f"f {' '.join(str(k + 1) for k in face)}" for face in t.FACES]
    assert read_closed_mesh("\n".join([*corners, *faces]).encode(), "a.obj").volume == pytest.approx(1.0)
    back = [f"f {' '.join(f'{k - 8}/1/{k - 8}' for k in face)}" for face in t.FACES]
    assert read_closed_mesh("\n".join([*corners, *back]).encode(), "a.obj").volume == pytest.approx(1.0)
    several = [line.replace("f ", "f \\\n") for line in faces]
    assert read_closed_mesh("\n".join([*corners, *several]).encode(), "a.obj").volume == pytest.approx(1.0)
    head = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 6\nproperty list uchar int vertex_index\nproperty uchar red\nend_header\n"
    rows = [*(line[2:] for line in corners), *(f"4 {' '.join(map(str, face))} 9" for face in t.FACES)]
    assert read_closed_mesh((head + "\n".join(rows)).encode(), "a.ply").volume == pytest.approx(1.0)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("seed", range(3))
def test_corners_that_were_rounded_twice_are_one(seed: int, scale: float) -> None:
    noise = np.random.default_rng(seed).uniform(-1.0, 1.0, RING.shape) * 1e-7
    mesh = read(scale * (RING + noise))
    assert len(mesh.corners) == 480 and "merged" in mesh.notes[0]
    assert mesh.volume == pytest.approx(scale**3 * volume(RING), rel=1e-6)
    assert code_of(scale * (RING + 30.0 * noise)) == "open-mesh"  # farther apart than digits


def test_what_is_closed_and_turned() -> None:
    point = np.zeros((1, 3, 3))
    assert read(np.concatenate([UNIT, point])).volume == pytest.approx(1.0)
    assert read(UNIT[:, ::-1]).volume == pytest.approx(1.0)
    assert "inward" in read(UNIT[:, ::-1]).notes[0]
    with pytest.raises(Finding, match=r"3 edges are open, around 1 hole: the first from \(0, 0, 1\) to \(0, 0, 0\)"):
        read(UNIT[1:])
    with pytest.raises(Finding, match="6 edges are open, around 2 holes"):
        read(np.delete(UNIT, [1, 2], axis=0))
    for k in range(12):
        turned = UNIT.copy()
        turned[k] = turned[k, ::-1]
        assert code_of(turned) == "mesh-orientation"
    flat = np.concatenate([UNIT[:2], UNIT[:2, ::-1]])
    assert code_of(flat) == "mesh-crosses-itself"
    assert code_of(UNIT[:0]) == "mesh-file"


def moved(*by: float) -> Array:
    return UNIT + np.array(by)


OUTER, HOLE = t.box([-1, -1, -1], [2, 2, 2]), UNIT[:, ::-1]
SHELLS = {
    "apart": ([UNIT, UNIT + 3.0], 2.0),
    "a hole": ([OUTER, HOLE], 26.0),
    "a hole, all inside out": ([OUTER[:, ::-1], UNIT], 26.0),
    "a solid in a hole": ([t.box([-2, -2, -2], [3, 3, 3]), OUTER[:, ::-1], UNIT], 99.0),
    "a solid in a solid": ([OUTER, UNIT], "mesh-orientation"),
    "one inside out": ([UNIT, HOLE + 3.0], "mesh-orientation"),
    "through each other": ([UNIT, moved(0.3, 0.4, 0.45)], "mesh-crosses-itself"),
    "at the very diagonal": ([UNIT, UNIT + 0.5], "mesh-crosses-itself"),
    "along flush faces": ([UNIT, moved(0.5, 0.0, 0.0)], "mesh-crosses-itself"),
    "twice the same": ([UNIT, UNIT], "mesh-crosses-itself"),
    "standing on each other": ([UNIT, t.box([0.25, 0.25, 1], [0.75, 0.75, 1.5])], 1.125),
    "in it from below": ([UNIT, t.box([0.25, 0.25, 0.5], [0.75, 0.75, 1])], "mesh-crosses-itself"),
    "at a corner": ([UNIT, UNIT + 1.0], 2.0),
    "at an edge": ([UNIT, moved(1.0, 1.0, 0.0)], "mesh-crosses-itself"),
}


@pytest.mark.parametrize("name", SHELLS)
def test_several_shells(name: str) -> None:
    parts, expected = SHELLS[name]
    triangles = np.concatenate(parts)
    if isinstance(expected, str):
        assert code_of(triangles) == expected
    else:
        mesh = read(triangles)
        assert mesh.volume == pytest.approx(expected) and mesh.shells == len(parts)


@pytest.mark.parametrize("seed", range(6))
def test_what_runs_through_itself_is_found_wherever_it_lies(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    assert read(RING @ turn.T).shells == 1
    assert code_of(t.torus(30, 16, 1.0, 1.3) @ turn.T) == "mesh-crosses-itself"
    spike = np.concatenate([RING, t.tetrahedron(rng.normal(size=(4, 3)) * 0.1 + RING[seed].mean(axis=0))])
    assert code_of(spike @ turn.T) == "mesh-crosses-itself"


SEEDS = {
    "a.stl": t.binary_stl(UNIT), "b.stl": t.text_stl(UNIT).encode(), "a.obj": t.obj(UNIT).encode(),
    "a.ply": t.ply(UNIT), "b.ply": t.ply(UNIT, "<"), "c.ply": t.ply(UNIT, ">"),
}  # fmt: skip


@pytest.mark.heavy
@pytest.mark.parametrize("name", SEEDS)
def test_whatever_is_written_is_read_or_refused(name: str) -> None:
    rng = np.random.default_rng(len(SEEDS[name]))
    refused = 0
    for _ in range(150):
        content = bytearray(SEEDS[name])
        for _ in range(int(rng.integers(1, 4))):
            at, many = int(rng.integers(len(content))), int(rng.integers(1, 20))
            match int(rng.integers(3)):
                case 0:
                    content[at] = int(rng.integers(256))
                case 1:
                    del content[at : at + many]
                case _:
                    content[at:at] = content[at : at + many]
        try:
            read_closed_mesh(content, name)
        except Finding as finding:
            refused += 1
            assert finding.hint and finding.code in {
                "mesh-file", "open-mesh", "mesh-orientation", "mesh-crosses-itself", "too-large",
            }  # fmt: skip
    assert refused > 75


@pytest.mark.parametrize("name", SEEDS)
def test_a_file_that_breaks_off_is_refused(name: str) -> None:
    whole = SEEDS[name].rstrip()
    for length in sorted({*range(0, len(whole), 1 + len(whole) // 40), len(whole) - 10}):
        with pytest.raises(Finding):
            read_closed_mesh(whole[:length], name)


@pytest.mark.parametrize(
    ("content", "name", "told"),
    [
        (b"ISO-10303-21;", "rod.step", "states no unit of length"), (b"\0\1", "rod.xyz", "cannot be identified"),
        (b"ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n", "a.ply", "more elements than"),
        (t.binary_stl(UNIT).replace(b"\0\0\x80?", b"\0\0\xc0\x7f"), "a.stl", "not a finite number"),
        (t.obj(UNIT).replace("f 1 ", "f 9 ").encode(), "a.obj", "outside 1 to 8"),
        (t.binary_stl(UNIT) + b"x", "a.stl", "1 bytes more"),
    ],
)  # fmt: skip
def test_what_is_said(content: bytes, name: str, told: str) -> None:
    with pytest.raises(Finding, match=told):
        read_closed_mesh(content, name)


SCENE = """heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  b: {shapes: [{type: mesh, file: FILE, density: 1000}], points: {a: [0, 0, 0]}}
joints: {w: {type: weld, from: ground.O, to: b.a}}
"""


def test_errors_stand_at_the_file(tmp_path: Path) -> None:
    (tmp_path / "open.stl").write_bytes(t.binary_stl(UNIT[1:]))
    (tmp_path / "small.stl").write_bytes(t.binary_stl(UNIT * 1e-21))
    for file, code in (("open.stl", "open-mesh"), ("none.stl", "mesh-file"), ("small.stl", "magnitude")):
        (tmp_path / "a.yaml").write_text(SCENE.replace("FILE", file))
        with pytest.raises(SpecError) as caught:
            load(tmp_path / "a.yaml")
        (problem,) = caught.value.problems
        assert problem.code == code and problem.hint and problem.location is not None
        assert (problem.location.line, problem.location.path) == (4, "bodies.b.shapes.0.file")


def test_a_mesh_in_metres_of_the_size_of_a_house_is_warned_of(tmp_path: Path) -> None:
    (tmp_path / "rod.stl").write_bytes(t.binary_stl(UNIT * 240.0))
    text = SCENE.replace("FILE", "rod.stl")
    for scale, codes in (("", ["mesh-size"]), (", scale: 1 mm", []), (", scale: 1", [])):
        (tmp_path / "a.yaml").write_text(text.replace(", density", f"{scale}, density"))
        assert [w.code for w in load(tmp_path / "a.yaml").warnings] == codes


def test_a_mesh_without_a_mass_is_told_once(tmp_path: Path) -> None:
    (tmp_path / "rod.stl").write_bytes(t.binary_stl(UNIT))
    text = SCENE.replace("FILE", "rod.stl")
    density = text[text.index(", density") : text.index("}", text.index(", density"))]
    for given, code in (("", "shape-form"), (", density: 0", "not-positive"), (", mass: 0", "not-positive")):
        (tmp_path / "a.yaml").write_text(text.replace(density, given))
        with pytest.raises(SpecError) as caught:
            load(tmp_path / "a.yaml")
        assert [problem.code for problem in caught.value.problems] == [code]
