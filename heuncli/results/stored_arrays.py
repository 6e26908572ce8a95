"""Arrays over the instants that stand in a temporary file: of a long run whose results are told piece by piece.

The file has no name from its first moment on (where systems know that): nothing is left behind, however the process
ends. An array is its rows one behind the other; what is asked of it is read from there. Impure: a file.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Iterator
from io import FileIO
from typing import TypeAlias

import numpy as np

from heuncli.base.errors import OutputError, Problem
from heuncli.results.results import Array

WIDTH = 8  # bytes of a number
TOGETHER = 4096  # numbers that are read sooner than two of them apart
AT_ONCE = 50_000  # numbers that are read together where each is looked at


class StoredArray:
    """float64 (n_t, ...) in a file, filled by instants. Of an array it has what telling it needs: shape, size, slices.

    By `reshape` it becomes one of rows, (n_t, m), of which columns can be read as well.
    """

    def __init__(self, store: ArrayStore, begin: int, shape: tuple[int, ...]) -> None:
        """begin: where it stands in the store's file [bytes]."""
        self._store, self._begin, self.shape = store, begin, shape
        self.row = math.prod(shape[1:])

    def __len__(self) -> int:
        return self.shape[0]

    @property
    def ndim(self) -> int:
        """How many axes it has."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """How many numbers it has."""
        return self.shape[0] * self.row

    def reshape(self, *shape: int) -> StoredArray:
        """The same numbers as rows: (n_t, -1)."""
        if shape != (len(self), -1):
            raise ValueError(f"stored arrays become rows, not {shape}")
        return StoredArray(self._store, self._begin, (len(self), self.row))

    def __getitem__(self, which: slice | tuple[slice, slice]) -> Array:
        """Some of the instants, (n, ...); of rows also some of the columns, (n, k). A copy."""
        instants, columns = which if isinstance(which, tuple) else (which, slice(None))
        first, end, _ = instants.indices(len(self))
        if not isinstance(which, tuple):
            return self._read(first * self.row, (end - first) * self.row).reshape(-1, *self.shape[1:])
        low, high, _ = columns.indices(self.row)
        found = np.empty((end - first, high - low))
        many = max(1, TOGETHER // max(self.row, 1))  # rows; one of a wide array, of which the columns alone are read
        for i in range(first, end, many):
            if many == 1:
                found[i - first] = self._read(i * self.row + low, high - low)
            else:
                found[i - first : i - first + many] = self[i : min(i + many, end)][:, low:high]
        return found

    def put(self, first: int, rows: Array) -> None:
        """Rows (n, ...) from an instant on, in place of what stands there. Raises OutputError for want of room."""
        left = memoryview(np.ascontiguousarray(rows, dtype=np.float64).tobytes())
        try:
            self._store.file.seek(self._begin + WIDTH * first * self.row)
            while left:  # a disk that is nearly full takes a part
                left = left[self._store.file.write(left) :]
        except OSError as reason:
            raise _no_room(reason) from None

    def _read(self, first: int, count: int) -> Array:
        found = np.empty(count)
        self._store.file.seek(self._begin + WIDTH * first)
        if self._store.file.readinto(found.data) != found.nbytes:
            message, hint = "the temporary file of the results ends too soon", "TMPDIR names the folder for it"
            raise OutputError(Problem("output-failed", message, hint=hint))
        return found


AnyArray: TypeAlias = Array | StoredArray


def in_parts(values: AnyArray, at_once: int = AT_ONCE) -> Iterator[Array]:
    """An array by instants, some of them at a time: so many numbers, or one instant's."""
    many = max(1, at_once * len(values) // max(values.size, 1))
    return (values[i : i + many] for i in range(0, len(values), many))


class ArrayStore:
    """The file that arrays are stored in, one behind the other; it is there as long as one of them is."""

    def __init__(self) -> None:
        """Raises OutputError where there is no folder for temporary files."""
        import tempfile  # 5 ms that long runs alone need

        try:
            self.file: FileIO = tempfile.TemporaryFile(prefix="heun-", buffering=0)  # noqa: SIM115 - closed with its arrays
        except OSError as reason:
            raise _no_room(reason) from None
        self._end = 0
        weakref.finalize(self, self.file.close)

    def array(self, shape: tuple[int, ...]) -> StoredArray:
        """A new array, to be filled."""
        begin, self._end = self._end, self._end + WIDTH * math.prod(shape)
        return StoredArray(self, begin, shape)


def _no_room(reason: OSError) -> OutputError:
    message = f"the temporary file of the results: {reason.strerror or reason}"
    return OutputError(
        Problem("output-failed", message, hint="TMPDIR names the folder for it; or ask for less: --only")
    )
