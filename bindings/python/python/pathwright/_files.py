"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import tempfile

from ._errors import OutputError


def write(path: str, contents: bytes) -> None:
    """Writes a file beside its place and renames it."""
    folder = os.path.dirname(os.path.abspath(path))
    try:
        handle, temporary = tempfile.mkstemp(dir=folder, prefix=".pathwright-")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(contents)
            mask = os.umask(0)
            os.umask(mask)
            os.chmod(temporary, 0o666 & ~mask)
            os.replace(temporary, path)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}", file=path) from error
