"""A sweep as CSV and as Parquet: one row for each variant, read and written one after the other."""

from __future__ import annotations

import importlib.util
import io
import json
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Any

from heuncli.analyses.sweep_rows import SweepColumns, SweepHead, SweptRow, make_columns
from heuncli.base.errors import Problem, SpecError
from heuncli.output.documents.as_data import format_line

ROWS_AT_ONCE = 50_000  # of a Parquet file
INSTALL = 'pip install "heuncli[parquet]"; or -o sweep.csv, which needs no package'


def iter_csv(head: SweepHead, rows: Iterable[SweptRow]) -> Iterator[str]:
    """Yield the lines one after the other."""
    columns = make_columns(head)
    yield format_line(columns.headings)
    for row in rows:
        yield format_line(columns.make_cells(row))


class ByteSink(io.RawIOBase):
    """A stream that keeps what is written until it is taken; it knows its position, which is all that a Parquet file
    needs.
    """

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._written = 0

    def writable(self) -> bool:
        """Return True."""
        return True

    def write(self, part: Any) -> int:
        """Keep some bytes."""
        self._parts.append(bytes(part))
        self._written += len(self._parts[-1])
        return len(self._parts[-1])

    def tell(self) -> int:
        """Return the number of bytes written."""
        return self._written

    def take(self) -> bytes:
        """Return the bytes written since the last call."""
        parts, self._parts = self._parts, []
        return b"".join(parts)


def require_parquet() -> None:
    """Raise SpecError before the work if pyarrow is missing."""
    if importlib.util.find_spec("pyarrow") is None:
        raise SpecError(Problem("missing-extra", "Parquet requires pyarrow, which is not installed", hint=INSTALL))


def iter_parquet(head: SweepHead, rows: Iterable[SweptRow]) -> Iterator[bytes]:
    """Yield the file in pieces."""
    require_parquet()
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = make_columns(head)
    fields = list(zip(columns.headings, _list_types(pa, columns), strict=True))
    schema = pa.schema(fields, metadata={"heun": json.dumps(_make_metadata(head))})
    sink, remaining = ByteSink(), iter(rows)
    with pq.ParquetWriter(sink, schema) as writer:
        while (group := _read_group(pa, schema, columns, remaining)).num_rows:
            writer.write_table(group)
            yield sink.take()
    yield sink.take()


def _read_group(pa: Any, schema: Any, columns: SweepColumns, rows: Iterator[SweptRow]) -> Any:
    """Return the next rows as a table; empty at their end."""
    cells = [columns.make_cells(row) for row in islice(rows, ROWS_AT_ONCE)]
    by_column = zip(*cells, strict=True) if cells else [()] * len(schema.types)
    arrays = [pa.array(column, kind) for column, kind in zip(by_column, schema.types, strict=True)]
    return pa.Table.from_arrays(arrays, schema=schema)


def _list_types(pa: Any, columns: SweepColumns) -> list[Any]:
    """Return the types of the columns, in their order."""
    parameter_types = [pa.string() if column.unit is None else pa.float64() for column in columns.parameters]
    measure_types = [pa.float64()] * (3 * len(columns.measures))
    return [pa.int64(), *parameter_types, *measure_types, pa.string(), pa.string()]


def _make_metadata(head: SweepHead) -> dict[str, str]:
    """Make the metadata of a Parquet file."""
    return {"version": head.version, "title": head.title, "spec": head.path, "sha256": head.sha256}
