"""Arrays over the instants in a temporary file, for a long run whose results are written piece by piece.

The file has no name from its first moment on (where the system allows it): nothing is left behind, however the process
ends. An array is stored row by row; requested parts are read from the file. Impure: a file.
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

BYTES_PER_NUMBER = 8  # bytes of a number
TOGETHER = 4096  # numbers that are read sooner than two of them apart
AT_ONCE = 50_000  # numbers that are read together where each is looked at


class StoredArray:
    """A float64 array (n_t, ...) in a file, filled by instants; it has the shape, size and slices of an array.

    `reshape` turns it into an array of rows, (n_t, m), of which columns can be read as well.
    """

    def __init__(self, store: ArrayStore, begin: int, shape: tuple[int, ...]) -> None:
        """begin: its position in the store's file [bytes]."""
        self._store, self._begin, self.shape = store, begin, shape
        self.row = math.prod(shape[1:])

    def __len__(self) -> int:
        return self.shape[0]

    @property
    def ndim(self) -> int:
        """The number of axes."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """The number of elements."""
        return self.shape[0] * self.row

    def reshape(self, *shape: int) -> StoredArray:
        """Return the same numbers as rows: (n_t, -1)."""
        if shape != (len(self), -1):
            raise ValueError(f"stored arrays become rows, not {shape}")
        return StoredArray(self._store, self._begin, (len(self), self.row))

    def __getitem__(self, which: slice | tuple[slice, slice]) -> Array:
        """Return some of the instants, (n, ...); of rows also some of the columns, (n, k). A copy."""
        instants, columns = which if isinstance(which, tuple) else (which, slice(None))
        first, end, _ = instants.indices(len(self))
        if not isinstance(which, tuple):
            return self._read(first * self.row, (end - first) * self.row).reshape(-1, *self.shape[1:])
        low, high, _ = columns.indices(self.row)
        values = np.empty((end - first, high - low))
        # rows; one of a wide array, of which the columns alone are read
        row_count = max(1, TOGETHER // max(self.row, 1))
        for i in range(first, end, row_count):
            if row_count == 1:
                values[i - first] = self._read(i * self.row + low, high - low)
            else:
                values[i - first : i - first + row_count] = self[i : min(i + row_count, end)][:, low:high]
        return values

    def write_rows(self, first: int, rows: Array) -> None:
        """Write rows (n, ...) from an instant on, replacing the old ones. Raises OutputError if there is no space."""
        remaining = memoryview(np.ascontiguousarray(rows, dtype=np.float64).tobytes())
        try:
            self._store.file.seek(self._begin + BYTES_PER_NUMBER * first * self.row)
            while remaining:  # a disk that is nearly full takes a part
                remaining = remaining[self._store.file.write(remaining) :]
        except OSError as reason:
            raise _write_error(reason) from None

    def _read(self, first: int, count: int) -> Array:
        """Read numbers of the array. Raises OutputError."""
        values = np.empty(count)
        self._store.file.seek(self._begin + BYTES_PER_NUMBER * first)
        if self._store.file.readinto(values.data) != values.nbytes:
            message, hint = "the temporary results file is incomplete", "TMPDIR names the folder for it"
            raise OutputError(Problem("output-failed", message, hint=hint))
        return values


AnyArray: TypeAlias = Array | StoredArray


def iter_chunks(values: AnyArray, chunk_size: int = AT_ONCE) -> Iterator[Array]:
    """Yield an array in chunks of instants: of about `chunk_size` numbers, at least one instant."""
    row_count = max(1, chunk_size * len(values) // max(values.size, 1))
    return (values[i : i + row_count] for i in range(0, len(values), row_count))


class ArrayStore:
    """The file in which arrays are stored, one after the other; it exists as long as one of them does."""

    def __init__(self) -> None:
        """Create the file. Raises OutputError where there is no folder for temporary files."""
        import tempfile  # 5 ms that long runs alone need

        try:
            self.file: FileIO = tempfile.TemporaryFile(prefix="heun-", buffering=0)  # noqa: SIM115 - closed with its arrays
        except OSError as reason:
            raise _write_error(reason) from None
        self._end = 0
        weakref.finalize(self, self.file.close)

    def allocate(self, shape: tuple[int, ...]) -> StoredArray:
        """Allocate a new array, to be filled."""
        begin, self._end = self._end, self._end + BYTES_PER_NUMBER * math.prod(shape)
        return StoredArray(self, begin, shape)


def _write_error(reason: OSError) -> OutputError:
    """Make the error of a temporary file that cannot be written."""
    message = f"temporary results file: {reason.strerror or reason}"
    return OutputError(
        Problem("output-failed", message, hint="TMPDIR names the folder for it; or request fewer results: --only")
    )
