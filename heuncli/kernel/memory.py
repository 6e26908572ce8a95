"""The memory of the kernel's numbers: compiled, arrays that this object keeps alive; in plain Python, lists.

Allocated here: a scene, as copies of its tables, whose rows are the structs, and its work arrays.
"""

from __future__ import annotations

from array import array
from typing import Any

from heuncli.kernel.declarations import *
from heuncli.kernel.events import find_angles


class Memory:
    """The arrays behind the pointers that were handed out; in plain Python those whose rows were."""

    def __init__(self) -> None:
        self.buffers: list[Any] = []

    def ints(self, numbers: Any) -> cython.p_int:
        """Return a copy of some integers."""
        memory = array("i", numbers) or array("i", [0])
        if not cython.compiled:
            return memory.tolist()
        return cython.cast(cython.p_int, self.keep(bytearray(memory)))

    def doubles(self, numbers: Any) -> cython.p_double:
        """Return a copy of some numbers."""
        memory = array("d", numbers) or array("d", [0.0])
        if not cython.compiled:
            return memory.tolist()
        return cython.cast(cython.p_double, self.keep(bytearray(memory)))

    def zeros(self, count: cython.Py_ssize_t) -> cython.p_double:
        """Return zeros, at least one."""
        if not cython.compiled:
            return [0.0] * max(count, 1)
        return cython.cast(cython.p_double, self.keep(bytearray(8 * (count if count > 0 else 1))))

    def keep(self, memory: bytearray) -> cython.p_char:
        """Keep some bytes alive, which never grow, and return their address; compiled only."""
        self.buffers.append(memory)
        return cython.cast(cython.p_char, memory)

    def view_rows(self, numbers: Any, rows: cython.Py_ssize_t, n: cython.Py_ssize_t) -> cython.pp_double:
        """Return rows of a caller's flat array: compiled its own memory, in plain Python lists that `fetch` writes
        back.
        """
        i: cython.Py_ssize_t
        if not cython.compiled:
            lists = [numbers[i * n : i * n + n].tolist() for i in range(rows)]
            self.buffers.append((numbers, lists))
            return lists
        begin: cython.pp_double = cython.cast(cython.pp_double, self.zeros(rows))
        self.buffers.append(numbers)
        if rows and n:
            view: cython.double[::1] = numbers
            for i in range(rows):
                begin[i] = cython.address(view[i * n])
        return begin

    def view_row(self, numbers: Any) -> cython.p_double:
        """Return a caller's flat array as one row."""
        return self.view_rows(numbers, 1, len(numbers))[0]

    def fetch(self) -> None:
        """Copy what was written to rows back into their arrays; compiled it is there already."""
        if not cython.compiled:
            for numbers, lists in self.buffers:
                for i, row in enumerate(lists):
                    numbers[i * len(row) : (i + 1) * len(row)] = row

    def matrix(self, rows: cython.Py_ssize_t, n: cython.Py_ssize_t) -> cython.pp_double:
        """Return rows of zeros."""
        if not cython.compiled:
            return [[0.0] * n for _ in range(rows)]
        return self.view_rows(array("d", bytes(8 * max(rows * n, 1))), rows, n)

    def copy_structs(self, table: Any, size: cython.Py_ssize_t) -> cython.p_void:
        """Copy a table's rows, each of a struct's size; compiled only. Raises ValueError for another size."""
        if table.dtype.itemsize != size:
            raise ValueError(f"a row of {table.dtype.itemsize} bytes is no struct of {size}")
        memory = bytearray(table.tobytes() or bytes(size))
        view: cython.uchar[::1] = memory
        self.buffers.append(memory)
        return cython.address(view[0])


def set_numbers(scene: cython.pointer[Scene], tables: dict[str, Any], numbers: dict[str, Any]) -> None:
    """Set the single numbers of a scene, and how many rows its tables have."""
    x, y, z = numbers["gravity"]
    scene.gravity = Vec3(x, y, z)
    scene.size = numbers["size"]
    scene.rank_of_gap = numbers["rank_of_gap"]
    scene.has_drives = numbers["driven"]
    scene.work_at = numbers["work_at"]
    scene.velocity_count = numbers["velocity_count"]
    scene.pivot_chosen = 1.0
    scene.pivot = 1.0
    scene.pivot_of_step = 1.0
    scene.own_share = 1.0
    scene.artificial_part = 1.0
    scene.body_count = len(tables["bodies"])
    scene.freedom_count = len(tables["freedoms"])
    scene.load_count = len(tables["loads"])
    scene.closure_count = len(tables["closures"])
    scene.part_count = len(tables["parts"])
    scene.counter_count = len(tables["counters"])
    scene.variable_count = len(tables["variables"])
    scene.point_count = tables["variables"]["is_point"].astype(bool).sum().item()
    scene.artificial_count = len(tables["artificial_inertias"])
    scene.island_count = len(tables["islands"])
    scene.watch_count = len(tables["watches"])
    scene.contact_count = len(tables["contacts"])
    scene.flat = numbers["flat"] and scene.artificial_count == 0


def copy_tables(scene: cython.pointer[Scene], memory: Memory, tables: dict[str, Any]) -> None:
    """Copy the tables: compiled their rows are the structs, in plain Python they become objects."""
    if cython.compiled:
        scene.bodies = cython.cast(cython.pointer[Body], memory.copy_structs(tables["bodies"], cython.sizeof(Body)))
        scene.freedoms = cython.cast(
            cython.pointer[Freedom], memory.copy_structs(tables["freedoms"], cython.sizeof(Freedom))
        )
        scene.loads = cython.cast(cython.pointer[Load], memory.copy_structs(tables["loads"], cython.sizeof(Load)))
        scene.closures = cython.cast(
            cython.pointer[Closure], memory.copy_structs(tables["closures"], cython.sizeof(Closure))
        )
        scene.parts = cython.cast(cython.pointer[Closure], memory.copy_structs(tables["parts"], cython.sizeof(Closure)))
        scene.counters = cython.cast(
            cython.pointer[Counter], memory.copy_structs(tables["counters"], cython.sizeof(Counter))
        )
        scene.pieces = cython.cast(
            cython.pointer[PathPiece], memory.copy_structs(tables["pieces"], cython.sizeof(PathPiece))
        )
        scene.variables = cython.cast(
            cython.pointer[Variable], memory.copy_structs(tables["variables"], cython.sizeof(Variable))
        )
        scene.artificial_inertias = cython.cast(
            cython.pointer[ArtificialInertia],
            memory.copy_structs(tables["artificial_inertias"], cython.sizeof(ArtificialInertia)),
        )
        scene.islands = cython.cast(
            cython.pointer[Island], memory.copy_structs(tables["islands"], cython.sizeof(Island))
        )
        scene.watches = cython.cast(cython.pointer[Watch], memory.copy_structs(tables["watches"], cython.sizeof(Watch)))
        scene.contacts = cython.cast(
            cython.pointer[Contact], memory.copy_structs(tables["contacts"], cython.sizeof(Contact))
        )
        limits: cython.pointer[Limits] = cython.cast(
            cython.pointer[Limits], memory.copy_structs(tables["limits"], cython.sizeof(Limits))
        )
        scene.limits = limits[0]
        scene.spare_bodies, scene.spare_freedoms = scene.bodies, scene.freedoms
        if scene.point_count:
            scene.spare_bodies = cython.cast(
                cython.pointer[Body], memory.copy_structs(tables["bodies"], cython.sizeof(Body))
            )
            freedoms: cython.p_void = memory.copy_structs(tables["freedoms"], cython.sizeof(Freedom))
            scene.spare_freedoms = cython.cast(cython.pointer[Freedom], freedoms)
    else:
        records = {
            "bodies": Body, "freedoms": Freedom, "loads": Load, "closures": Closure, "parts": Closure,
            "counters": Counter, "pieces": PathPiece, "variables": Variable, "artificial_inertias": ArtificialInertia,
            "islands": Island, "watches": Watch, "contacts": Contact,
        }  # fmt: skip
        for name, record in records.items():
            setattr(scene, name, [record.from_numbers(row) for row in tables[name].tolist()])
        scene.spare_bodies = [Body.from_numbers(row) for row in tables["bodies"].tolist()]
        scene.spare_freedoms = [Freedom.from_numbers(row) for row in tables["freedoms"].tolist()]
        scene.limits = Limits.from_numbers(tables["limits"].tolist()[0])


def allocate_work(scene: cython.pointer[Scene], memory: Memory, indices: array[int], numbers: dict[str, Any]) -> None:
    """Copy the indices and the measures of the freedoms, and allocate the work arrays."""
    response_count: cython.Py_ssize_t = scene.velocity_count
    rows: cython.Py_ssize_t = scene.closure_count
    scene.indices = memory.ints(indices)
    scene.selected = memory.ints(bytes(4 * rows))
    scene.envelope = memory.ints(bytes(4 * rows))
    scene.support = memory.ints(bytes(4 * numbers["column_count"]))
    scene.coupled = memory.ints(bytes(4 * len(indices)))
    scene.is_pivot = memory.ints(bytes(4 * response_count))
    scene.velocity_scale = memory.doubles(numbers["velocity_scale"])
    scene.e = memory.zeros(response_count)
    scene.inertia_root = memory.zeros(response_count)
    scene.velocity_vector = memory.zeros(response_count)
    scene.columns = memory.zeros(numbers["column_count"])
    scene.R = memory.zeros(rows * rows)
    scene.J = memory.zeros(numbers["island_room"])
    scene.remainders = memory.zeros(rows)
    scene.pivot_row_velocities = memory.ints(bytes(4 * response_count))
    scene.row_bits = memory.ints(bytes(4 * rows))
    scene.rows_left = memory.ints(bytes(4 * rows))
    scene.row_vector = memory.zeros(rows)
    scene.is_angle = memory.ints(bytes(4 * scene.held_count))
    find_angles(scene)
    scene.least = memory.zeros(scene.variable_count)
    scene.most = memory.zeros(scene.variable_count)
    scene.own_inertia = memory.zeros(scene.artificial_count * scene.artificial_count)
    allocate_friction(scene, memory)
    allocate_tangents(scene, memory)


def allocate_friction(scene: cython.pointer[Scene], memory: Memory) -> None:
    """List the loads of joint friction, and allocate the arrays to solve for their normal forces."""
    friction_loads = [k for k in range(scene.load_count) if scene.loads[k].normal_force_kind]
    n: cython.Py_ssize_t = len(friction_loads)
    scene.friction_count = n
    scene.friction_loads = memory.ints(friction_loads)
    scene.contact_forces = memory.zeros(6 * n * (n + 2))
    scene.stored_loads = memory.zeros(6 * scene.body_count if n else 0)
    scene.friction_bound = memory.zeros(n * n)
    scene.friction_slope = memory.zeros(n * n)
    scene.friction_trial = memory.zeros(5 * n)


def allocate_tangents(scene: cython.pointer[Scene], memory: Memory) -> None:
    """Allocate the changes of the scene along a direction of its state."""
    n: cython.Py_ssize_t = 2 * scene.freedom_count + scene.counter_count + 1
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        n += 7 * scene.bodies[i].ball
    scene.direction = memory.zeros(n)
    scene.slopes = memory.zeros(scene.variable_count)
    scene.multipliers = memory.zeros(scene.closure_count)
    bodies: cython.Py_ssize_t = scene.body_count
    freedoms: cython.Py_ssize_t = scene.freedom_count
    if cython.compiled:
        scene.state_values = cython.cast(
            cython.pointer[BodyAtState], memory.zeros(bodies * cython.sizeof(BodyAtState) // 8)
        )
        scene.tangents = cython.cast(
            cython.pointer[BodyTangent], memory.zeros(bodies * cython.sizeof(BodyTangent) // 8)
        )
        scene.freedom_tangents = cython.cast(
            cython.pointer[FreedomTangent], memory.zeros(freedoms * cython.sizeof(FreedomTangent) // 8)
        )
    else:
        scene.state_values = [BodyAtState.blank() for _ in range(bodies)]
        scene.tangents = [BodyTangent.blank() for _ in range(bodies)]
        scene.freedom_tangents = [FreedomTangent.blank() for _ in range(freedoms)]
