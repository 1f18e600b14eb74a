"""Prints, their layers, and what these draw."""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Union, overload

import numpy as np
import numpy.typing as npt

from . import _files, _pathwright
from ._tables import duration, table

Floats = npt.NDArray[np.float64]

_ROLES = np.array(_pathwright.Print.roles())


@dataclass(frozen=True)
class Path:
    """What is drawn from one stop to the next: a view of the arrays of :class:`Paths`."""

    #: What it is for, as in ``;TYPE:`` comments: ``"External perimeter"``.
    role: str
    #: Shape (n, 3): positions of the nozzle, mm.
    points: Floats
    #: Shape (n,): width of the bead, mm.
    widths: Floats
    #: Shape (n,): speed of the move that ends at the vertex, mm/s; 0 at the first.
    speeds: Floats
    #: Shape (n,): duration of that move, s; 0 at the first.
    times: Floats


@dataclass(frozen=True, repr=False)
class Paths(Sequence[Path]):
    """What a layer draws, in the order in which it is drawn: one array for each quantity, and a sequence of :class:`Path`.

    Path ``i`` has the vertices ``starts[i]`` to ``starts[i + 1]``.
    """

    #: Shape (m + 1,): first vertex of each path, and the number of vertices.
    starts: npt.NDArray[np.int64]
    #: Shape (m,): names of roles.
    roles: npt.NDArray[np.str_]
    #: Shape (n, 3): positions of the nozzle, mm.
    points: Floats
    #: Shape (n,): width of the bead, mm.
    widths: Floats
    #: Shape (n,): speed of the move that ends at each vertex, mm/s; 0 at the first of a path.
    speeds: Floats
    #: Shape (n,): duration of that move, with speeding up and slowing down, s; 0 at the first of a path.
    times: Floats

    def __len__(self) -> int:
        return len(self.roles)

    @overload
    def __getitem__(self, index: int) -> Path: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Path]: ...
    def __getitem__(self, index: Union[int, slice]) -> Union[Path, Sequence[Path]]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        i = range(len(self))[index]
        at = slice(int(self.starts[i]), int(self.starts[i + 1]))
        return Path(str(self.roles[i]), self.points[at], self.widths[at], self.speeds[at], self.times[at])

    def __repr__(self) -> str:
        return f"<{len(self)} paths of {len(self.points)} vertices>"


class Layer:
    """A layer as it is printed. Jupyter shows it as a picture."""

    def __init__(self, print_: _pathwright.Print, index: int) -> None:
        self._print = print_
        #: From the bed, 0 the first.
        self.index = index
        #: Height of the nozzle over the bed, and of the layer, mm.
        self.z, self.height = print_.heights(index)

    @cached_property
    def paths(self) -> Paths:
        """What it draws."""
        starts, roles, points, widths, speeds, times = self._print.paths(self.index)
        return Paths(starts, _ROLES[roles], points, widths, speeds, times)

    def svg(self) -> str:
        """A picture with travel, one unit a millimetre."""
        return self._print.svg(self.index)

    def png(self, side: int = 800) -> bytes:
        """The same as PNG, its longer side so many pixels long (at most 2000)."""
        return self._print.png(self.index, side)

    def __repr__(self) -> str:
        return f"<layer {self.index}, {self.height:g} mm high, at {self.z:g} mm>"

    def _repr_svg_(self) -> str:
        return self.svg()

    def _repr_png_(self) -> bytes:
        return self.png()


class Layers(Sequence[Layer]):
    """The layers of a print from the bed up."""

    def __init__(self, print_: _pathwright.Print) -> None:
        self._print = print_

    def __len__(self) -> int:
        return len(self._print)

    @overload
    def __getitem__(self, index: int) -> Layer: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Layer]: ...
    def __getitem__(self, index: Union[int, slice]) -> Union[Layer, Sequence[Layer]]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        return Layer(self._print, range(len(self))[index])

    def __iter__(self) -> Iterator[Layer]:
        return (Layer(self._print, index) for index in range(len(self)))


class Print:
    """A sliced plate. Jupyter shows its figures and the layer in the middle."""

    def __init__(self, print_: _pathwright.Print, warnings: list[str]) -> None:
        self._print = print_
        self._warnings = warnings

    @property
    def gcode(self) -> bytes:
        """The G-code, as text in UTF-8; not copied."""
        return self._print.gcode

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Size, time, filament, cost, travel, repairs, warnings, and the figures of each layer, with the keys of
        ``pathwright slice --json``."""
        summary: dict[str, Any] = json.loads(self._print.summary)
        return summary

    @property
    def layers(self) -> Layers:
        """The layers from the bed up."""
        return Layers(self._print)

    @property
    def warnings(self) -> list[str]:
        """What is allowed but unwise: first about the settings, then about the models and the print."""
        return [*self._warnings, *self.summary["warnings"]]

    def write(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the G-code, whole or not at all; as binary G-code where the name ends in ``.bgcode``.

        Raises :class:`OutputError`.
        """
        name = os.fspath(path)
        _files.write(name, self._print.binary() if name.lower().endswith(".bgcode") else self.gcode)

    def __repr__(self) -> str:
        models, layers = " + ".join(self.summary["models"]), self.summary["layer_count"]
        return f"<print of {models}: {layers} layers, {duration(self.summary['total_s'])}>"

    def _repr_html_(self) -> str:
        summary = self.summary
        x, y, z = summary["size_mm"]
        rows = [
            ["models", " + ".join(summary["models"])],
            ["size", f"{x:.2f} × {y:.2f} × {z:.2f} mm, {summary['layer_count']} layers"],
            ["time", duration(summary["total_s"])],
            ["filament", f"{summary['filament_mm'] / 1000:.2f} m, {summary['filament_g']:.2f} g"],
            ["cost", f"{summary['filament_cost']:.2f}"],
            ["travel", f"{summary['travel_mm'] / 1000:.2f} m, {summary['travels']} travels"],
        ]
        if summary.get("bound_mm") is not None:
            bound = summary["bound_mm"] / 1000
            rows.append(["order", f"links {summary['link_mm'] / 1000:.2f} m, no order has less than {bound:.2f} m"])
        rows += [["warning", warning] for warning in self.warnings]
        middle = self.layers[len(self.layers) // 2]
        picture = base64.b64encode(middle.png(480)).decode()
        title = f"layer {middle.index} at {middle.z:g} mm"
        image = f'<img alt="{title}" title="{title}" src="data:image/png;base64,{picture}">'
        return f"{table(rows, ['', ''])}{image}"
