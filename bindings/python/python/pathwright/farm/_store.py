"""Where results are kept: a folder, or a prefix of an object store."""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Iterable, Iterator
from typing import Any, Optional

import fsspec

from .. import _files

#: How many records are read at once.
_AT_ONCE = 500


class Store:
    """Results below a path or URL.

    ``gcode/ab/KEY.gcode`` is G-code by the hash that ``pathwright key`` prints, ``NAME.parquet`` the table, and
    ``NAME.rows/ab/ID.json`` what is not in the table yet. A file is there whole or not at all.
    """

    def __init__(self, url: str) -> None:
        self.fs, self.root = fsspec.core.url_to_fs(url)
        self._is_local = "file" in self.fs.protocol
        self._folders: set[str] = set()

    def put(self, name: str, contents: bytes) -> None:
        """Writes a file, over one of that name."""
        path = self._path(name)
        if not self._is_local:
            self.fs.pipe_file(path, contents)
            return
        folder = os.path.dirname(path)
        if folder not in self._folders:
            os.makedirs(folder, exist_ok=True)
            self._folders.add(folder)
        _files.write(path, contents)

    def get(self, name: str) -> bytes:
        """The contents of a file. Raises :class:`FileNotFoundError`."""
        contents: bytes = self.fs.cat_file(self._path(name))
        return contents

    def exists(self, name: str) -> bool:
        return bool(self.fs.exists(self._path(name)))

    def record(self, table: str, identity: str, rows: list[dict[str, Any]]) -> None:
        """Keeps rows until they are in the table."""
        self.put(_record(table, identity), json.dumps(rows).encode())

    def recorded(self, table: str, identity: str) -> Optional[list[dict[str, Any]]]:
        """What is kept of an identity, if anything is."""
        try:
            rows: list[dict[str, Any]] = json.loads(self.get(_record(table, identity)))
        except FileNotFoundError:
            return None
        return rows

    def records(self, table: str) -> Iterator[tuple[str, list[dict[str, Any]]]]:
        """All that is kept, by identity."""
        names = self._records(table)
        for first in range(0, len(names), _AT_ONCE):
            for path, contents in self.fs.cat(names[first : first + _AT_ONCE]).items():
                yield path.rsplit("/", 1)[-1].removesuffix(".json"), json.loads(contents)

    def forget(self, table: str, identities: Iterable[str]) -> None:
        """Removes what is in the table."""
        gone = set(identities)
        names = [name for name in self._records(table) if name.rsplit("/", 1)[-1][:-5] in gone]
        for first in range(0, len(names), _AT_ONCE):
            self.fs.rm(names[first : first + _AT_ONCE])

    def _records(self, table: str) -> list[str]:
        self.fs.invalidate_cache()
        try:
            found = self.fs.find(self._path(f"{table}.rows"))
        except FileNotFoundError:
            return []
        return [name for name in found if name.endswith(".json")]

    def _path(self, name: str) -> str:
        return f"{self.root.rstrip('/')}/{name}"


def _record(table: str, identity: str) -> str:
    return f"{table}.rows/{identity[:2]}/{identity}.json"


@functools.lru_cache(maxsize=16)
def opened(url: str) -> Store:
    """The store at a path or URL."""
    return Store(url)
