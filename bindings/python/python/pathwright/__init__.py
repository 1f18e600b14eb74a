"""Slices models into G-code with a near-optimal order of paths, and orders paths for plotters and lasers.

>>> import pathwright as pw
>>> print_ = pw.slice(["part.stl"], profiles=["petg"], settings={"infill.density": "15%"})  # doctest: +SKIP
>>> print_.write("part.gcode")  # doctest: +SKIP

Lengths are millimetres, times seconds, speeds millimetres per second, angles degrees. While Rust works other threads run, and
Ctrl-C ends the call with ``KeyboardInterrupt``.
"""

from ._errors import (
    CancelledError,
    CheckError,
    DoesNotFitError,
    Error,
    InputError,
    OutputError,
    SettingsError,
)
from ._gcode import Reordered, check, reorder, time
from ._models import Mesh, Model
from ._ordering import Order, TravelTime, order
from ._pathwright import VERSION as __version__
from ._prints import Layer, Path, Paths, Print
from ._slicing import compare, info, key, settings_schema, slice
from ._tables import Rows
from ._tasks import Options

__all__ = [
    "CancelledError",
    "CheckError",
    "DoesNotFitError",
    "Error",
    "InputError",
    "Layer",
    "Mesh",
    "Model",
    "Options",
    "Order",
    "OutputError",
    "Path",
    "Paths",
    "Print",
    "Reordered",
    "Rows",
    "SettingsError",
    "TravelTime",
    "__version__",
    "check",
    "compare",
    "info",
    "key",
    "order",
    "reorder",
    "settings_schema",
    "slice",
    "time",
]
