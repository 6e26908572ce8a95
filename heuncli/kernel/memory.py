"""The memory of the kernel's numbers: compiled, arrays that this object keeps alive; in plain Python, lists."""

from __future__ import annotations

from array import array
from typing import Any

from heuncli.kernel.declarations import *


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
