"""Polylines → the order, direction and entry in which they are drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _pathwright

#: Coordinates are at most this far from 0, mm.
FARTHEST = 10_000.0

Strategy = Literal["as-sliced", "nearest", "greedy", "christofides", "christofides-open", "optimized"]


@dataclass(frozen=True)
class TravelTime:
    """How long a machine takes from the end of one path to the start of the next, as a cost."""

    #: Top speed, mm/s.
    speed: float
    #: Acceleration from and to rest, mm/s²; 0: the top speed is there at once.
    acceleration: float = 0.0
    #: Share of every travel that is not spent on speeding up and slowing down.
    cruise_ratio: float = 0.0
    #: Time to stop and start, such as lifting and lowering a pen, s.
    stop: float = 0.0
    #: Travels that are longer than this are retracted, mm.
    retract_from: float = float("inf")
    #: What retracting takes, s.
    retract: float = 0.0

    def __post_init__(self) -> None:
        if not self.speed > 0.0 or not 0.0 <= self.cruise_ratio < 1.0:
            raise ValueError("a travel has a speed above 0 and a cruise_ratio of at least 0 and below 1")
        if min(self.acceleration, self.stop, self.retract_from, self.retract) < 0.0:
            raise ValueError("acceleration, stop, retract_from and retract are not negative")


@dataclass(frozen=True, repr=False)
class Order:
    """In which order polylines are drawn."""

    #: Shape (m,): index of the polyline that is drawn first, next, and so on.
    order: npt.NDArray[np.int64]
    #: Shape (m,): for each of these the vertex at which it is begun.
    entry: npt.NDArray[np.int64]
    #: Shape (m,): 1 where it is drawn forwards, -1 where backwards; closed ones are always drawn forwards.
    direction: npt.NDArray[np.int8]
    #: Length of the straight lines in between, and from the start where one is given, mm.
    length: float
    #: A length that no order is below, mm, with ``certify=True``.
    bound: Optional[float]

    def drawn(self, polylines: Sequence[Any]) -> list[Any]:
        """The polylines in this order, reversed or begun elsewhere where the order says so. Nothing is copied but closed
        polylines that are begun elsewhere."""
        out = []
        for index, entry, direction in zip(self.order.tolist(), self.entry.tolist(), self.direction.tolist()):
            line = np.asarray(polylines[index])
            if direction < 0:
                line = line[::-1]
            elif entry > 0:
                line = np.roll(line, -entry, axis=0)
            out.append(line)
        return out

    def __repr__(self) -> str:
        bound = "" if self.bound is None else f", at least {self.bound:.1f} mm"
        return f"<order of {len(self.order)} polylines: {self.length:.1f} mm in between{bound}>"


def order(
    polylines: Sequence[npt.ArrayLike],
    *,
    closed: Union[bool, Sequence[bool], npt.NDArray[np.bool_]] = False,
    start: Optional[tuple[float, float]] = None,
    groups: Union[None, Sequence[int], npt.NDArray[np.integer[Any]]] = None,
    strategy: Strategy = "optimized",
    cost: Union[Literal["length"], TravelTime] = "length",
    effort: Literal["fast", "normal", "high"] = "normal",
    certify: bool = False,
) -> Order:
    """Finds the order, direction and entry in which little is travelled between polylines.

    ``polylines``: each of shape (n, 2), or n complex numbers, in mm, within 10 m of 0; distances below 0.01 µm do not count.
    ``closed``: which of them (or all) return to their first vertex, which is not repeated: they are begun at any vertex.
    ``start``: where the machine begins; by default anywhere. ``groups``: a number for each; all of one come before any of the
    next (pens, layers of a drawing). ``certify``: compute a bound, too, which takes longer.

    Raises :class:`ValueError` with the index of a polyline that is empty or not finite.
    """
    lines = [_vertices(line, index) for index, line in enumerate(polylines)]
    starts = np.zeros(len(lines) + 1, dtype=np.int64)
    np.cumsum([len(line) for line in lines], out=starts[1:])
    points = np.ascontiguousarray(np.concatenate(lines) if lines else np.empty((0, 2)), dtype=np.float64)
    _check(points, starts)
    if start is not None and not all(abs(x) <= FARTHEST for x in start):
        raise ValueError(f"start: {start} is farther away than 10 m")
    is_closed = np.ascontiguousarray(np.broadcast_to(np.asarray(closed, dtype=bool), len(lines)))
    ranks = np.zeros(len(lines), dtype=np.uint32)
    if groups is not None:
        if len(groups) != len(lines):
            raise ValueError(f"groups: {len(groups)} for {len(lines)} polylines")
        # Their order alone counts, which may begin below 0.
        ranks = np.unique(np.asarray(groups), return_inverse=True)[1].astype(np.uint32)
    time = None
    if isinstance(cost, TravelTime):
        retraction = (cost.retract_from, cost.retract)
        time = (cost.speed, cost.acceleration, cost.cruise_ratio, cost.stop, *retraction)
    elif cost != "length":
        raise ValueError(f'cost: "length" or a TravelTime, not {cost!r}')
    order, entry, length, bound = _pathwright.order(
        points, starts, is_closed, ranks, start, strategy, effort, time, certify
    )
    backwards = (entry == 1) & ~is_closed[order]
    direction = np.where(backwards, -1, 1).astype(np.int8)
    entry[backwards] = (np.diff(starts) - 1)[order[backwards]]
    return Order(order, entry, direction, length, bound)


def _vertices(line: npt.ArrayLike, index: int) -> npt.NDArray[np.float64]:
    array = np.asarray(line)
    if array.dtype.kind == "c" and array.ndim == 1:
        array = np.ascontiguousarray(array, dtype=np.complex128).view(np.float64).reshape(-1, 2)
    if array.ndim != 2 or array.shape[1] != 2 or not len(array):
        raise ValueError(f"polyline {index}: its shape is (n, 2) with n of at least 1, not {array.shape}")
    return array


def _check(points: npt.NDArray[np.float64], starts: npt.NDArray[np.int64]) -> None:
    # Written so that what is no number is wrong, too.
    wrong = np.flatnonzero(~(np.abs(points) <= FARTHEST).all(axis=1))
    if wrong.size:
        index = int(np.searchsorted(starts, wrong[0], side="right")) - 1
        vertex = int(wrong[0] - starts[index])
        raise ValueError(f"polyline {index}: vertex {vertex} is no number, or farther from 0 than 10 m")
