"""The table of results."""

from __future__ import annotations

import io
from typing import Any, Optional

import pyarrow as pa
import pyarrow.parquet

from ._store import Store

_GIVEN = [
    ("id", pa.string()),
    ("model", pa.string()),
    ("printer", pa.string()),
    ("print", pa.string()),
    ("filament", pa.string()),
    ("profiles", pa.string()),
    ("settings", pa.string()),
]
_ENDED = [
    ("error_kind", pa.string()),
    ("error", pa.string()),
    ("seconds", pa.float64()),
    ("memory_mb", pa.float64()),
]
#: Columns by what is done.
SCHEMAS = {
    "slice": pa.schema(
        [
            *_GIVEN,
            ("key", pa.string()),
            ("gcode", pa.string()),
            ("time_s", pa.float64()),
            ("filament_mm", pa.float64()),
            ("filament_g", pa.float64()),
            ("cost", pa.float64()),
            ("print_mm", pa.float64()),
            ("travel_mm", pa.float64()),
            ("link_mm", pa.float64()),
            ("bound_mm", pa.float64()),
            ("layers", pa.int64()),
            ("warnings", pa.list_(pa.string())),
            *_ENDED,
        ]
    ),
    "compare": pa.schema(
        [
            *_GIVEN,
            ("strategy", pa.string()),
            ("paths", pa.int64()),
            ("link_mm", pa.float64()),
            ("bound_mm", pa.float64()),
            ("gap", pa.float64()),
            ("travels", pa.int64()),
            ("travel_s", pa.float64()),
            ("took_s", pa.float64()),
            *_ENDED,
        ]
    ),
}
#: Rows that are held as Python objects.
_HELD = 10_000


class Table:
    """Rows that are known, in the order of their coming."""

    def __init__(self, work: str, store: Store) -> None:
        self._work, self._store = work, store
        self._schema = SCHEMAS[work]
        self._rows: list[dict[str, Any]] = []
        self._parts: list[pa.Table] = []
        #: How each identity ended: the kind of its error, or nothing.
        self.known: dict[str, str] = {}

    def load(self) -> None:
        """What earlier runs left."""
        name = f"{self._work}.parquet"
        if self._store.exists(name):
            table = pyarrow.parquet.read_table(io.BytesIO(self._store.get(name))).cast(self._schema)
            self._parts.append(table)
            kinds = (kind or "" for kind in table["error_kind"].to_pylist())
            self.known.update(zip(table["id"].to_pylist(), kinds))
        for identity, rows in self._store.records(self._work):
            if identity not in self.known:
                self.add(rows)

    def add(self, rows: list[dict[str, Any]]) -> None:
        """Rows of one identity."""
        for row in rows:
            self._rows.append(row)
            self.known[row["id"]] = row.get("error_kind") or ""
        if len(self._rows) >= _HELD:
            self._pack()

    def recorded(self, identity: str) -> Optional[list[dict[str, Any]]]:
        """Rows of one identity that whoever did them has kept, if any."""
        return self._store.recorded(self._work, identity)

    def drop(self, identities: set[str]) -> None:
        """Forgets rows that are done again."""
        table = self.table()
        keep = pa.compute.invert(pa.compute.is_in(table["id"], pa.array(sorted(identities), pa.string())))
        self._parts = [table.filter(keep)]
        self._store.forget(self._work, identities)
        for identity in identities:
            self.known.pop(identity, None)

    def table(self) -> pa.Table:
        self._pack()
        parts = self._parts or [self._schema.empty_table()]
        return pa.concat_tables(parts)

    def save(self) -> None:
        """Writes the table; the records that are in it go."""
        table = self.table().sort_by([("model", "ascending"), ("id", "ascending")])
        file = io.BytesIO()
        pyarrow.parquet.write_table(table, file)
        self._store.put(f"{self._work}.parquet", file.getvalue())
        self._store.forget(self._work, self.known)

    def _pack(self) -> None:
        if self._rows:
            self._parts.append(pa.Table.from_pylist(self._rows, schema=self._schema))
            self._rows = []
