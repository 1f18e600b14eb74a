"""What is printed: files, contents of files, meshes."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, Literal, Optional, Protocol, Union, runtime_checkable

import numpy as np
import numpy.typing as npt

from ._errors import InputError

Triple = tuple[float, float, float]
#: A value as it is typed after ``--set``, or the number, flag or list that it stands for.
Value = Union[str, bool, int, float, Sequence[float]]

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


@runtime_checkable
class HasFaces(Protocol):
    """A mesh of vertices and triangles, such as trimesh's."""

    @property
    def vertices(self) -> Any: ...

    @property
    def faces(self) -> Any: ...


@runtime_checkable
class HasVectors(Protocol):
    """A mesh of separate triangles, such as numpy-stl's."""

    @property
    def vectors(self) -> Any: ...


@dataclass(frozen=True)
class Mesh:
    """A mesh in memory.

    Coordinates are rounded to 32 bits, as in a binary STL file, and repaired as a file's are: the G-code is that of the mesh
    saved as STL under this name.
    """

    #: Shape (n, 3), millimetres.
    vertices: npt.ArrayLike
    #: Shape (m, 3): indices of the corners of each triangle, counter-clockwise seen from outside.
    faces: npt.ArrayLike
    #: What messages and labels call it.
    name: str = "mesh.stl"

    def __post_init__(self) -> None:
        _corners(self.vertices, self.faces, self.name)


@dataclass(frozen=True)
class Model:
    """A model, and what is done with it."""

    #: A path, the contents of a file (STL, 3MF, OBJ), or a mesh.
    source: Union[str, os.PathLike[str], bytes, Mesh, HasFaces, HasVectors]
    #: What messages and labels call it; by default the file's name.
    name: Optional[str] = None
    #: A factor, or one for each of X, Y and Z; a negative one mirrors.
    scale: Union[float, Triple] = 1.0
    #: Angles about X, then Y, then Z, degrees.
    rotate: Triple = (0.0, 0.0, 0.0)
    #: Where the middle of its box, seen from above, and its lowest point are on the bed, millimetres. Either all models have
    #: a position or none has.
    at: Optional[Triple] = None
    copies: int = 1
    #: The object of a file with several, counted from 0; by default all.
    object: Optional[int] = None
    #: Whether it is printed, or a body in which support is enforced or blocked.
    role: Literal["part", "support_enforcer", "support_blocker"] = "part"
    #: Settings of its own.
    settings: Mapping[str, Value] = field(default_factory=dict)


AnyModel = Union[str, "os.PathLike[str]", bytes, Mesh, HasFaces, HasVectors, Model]


def given(model: AnyModel) -> SimpleNamespace:
    """A model as Rust takes it."""
    if not isinstance(model, Model):
        model = Model(model)
    path, contents = _contents(model.source)
    if model.name is not None:
        if contents is None:
            with _readable(path) as file:
                contents = file.read()
        path = model.name
    scale = model.scale if isinstance(model.scale, Sequence) else (model.scale,) * 3
    if any(factor == 0.0 or not np.isfinite(factor) for factor in scale):
        raise InputError(f"{path}: a scale has factors other than 0", file=path)
    if not 1 <= model.copies <= 1000:
        raise InputError(f"{path}: copies: 1 to 1000 are possible", file=path)
    if model.at is not None and model.copies > 1:
        raise InputError(f"{path}: a model with a position stands there once; leave out its copies", file=path)
    return SimpleNamespace(
        path=path,
        contents=contents,
        object=model.object,
        scale=tuple(scale),
        rotate_deg=tuple(model.rotate),
        at_mm=None if model.at is None else tuple(model.at),
        copies=model.copies,
        role=model.role,
        settings=typed(model.settings),
    )


def typed(settings: Mapping[str, Value]) -> list[tuple[str, str]]:
    """Settings as they are typed."""
    return [(key, _typed(value)) for key, value in settings.items()]


def _typed(value: Value) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (Sequence, np.ndarray)):
        return "[" + ", ".join(_typed(item) for item in value) + "]"
    return str(value)


def _readable(path: str) -> Any:
    try:
        return open(path, "rb")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}", file=path) from error


def _contents(source: object) -> tuple[str, Optional[bytes]]:
    if isinstance(source, (str, os.PathLike)):
        return os.fspath(source), None
    if isinstance(source, (bytes, bytearray, memoryview)):
        return "model", bytes(source)
    name = getattr(source, "name", None)
    name = name if isinstance(name, str) and name else "mesh.stl"
    if isinstance(source, HasFaces):
        return name, _stl(_corners(source.vertices, source.faces, name))
    if isinstance(source, HasVectors):
        corners = np.asarray(source.vectors, dtype=np.float32)
        if corners.ndim != 3 or corners.shape[1:] != (3, 3):
            raise InputError(f"{name}: vectors have the shape (n, 3, 3), not {corners.shape}", file=name)
        return name, _stl(corners)
    raise TypeError(
        f"a model is a path, bytes, or has vertices and faces, or vectors; {type(source).__name__} is none of these"
    )


def _corners(vertices: object, faces: object, name: str) -> npt.NDArray[np.float32]:
    """The corners of each triangle."""
    points, corners = np.asarray(vertices, dtype=np.float32), np.asarray(faces)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"{name}: vertices have the shape (n, 3), not {points.shape}", file=name)
    if corners.ndim != 2 or corners.shape[1] != 3 or corners.dtype.kind not in "iu":
        shape = f"{corners.shape} of {corners.dtype}"
        raise InputError(f"{name}: faces have the shape (m, 3) of whole numbers, not {shape}", file=name)
    wrong = np.flatnonzero(((corners < 0) | (corners >= len(points))).any(axis=1))
    if wrong.size:
        face = int(wrong[0])
        problem = f"names a vertex that is not there; there are {len(points)}"
        raise InputError(f"{name}: face {face}: {problem}", file=name, place=f"face {face}")
    chosen: npt.NDArray[np.float32] = points[corners]
    return chosen


def _stl(corners: npt.NDArray[np.float32]) -> bytes:
    facets = np.zeros(len(corners), dtype=_FACET)
    facets["corners"] = corners
    return b"".join([bytes(80), np.uint32(len(corners)).tobytes(), facets.tobytes()])
