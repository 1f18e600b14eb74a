"""Ordering polylines."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import pathwright as pw


def random_lines(count: int, seed: int = 1) -> list[npt.NDArray[np.float64]]:
    return list(np.random.default_rng(seed).random((count, 3, 2)) * 200.0)


def length(lines: list[Any], start: Any = None, closed: bool = False) -> float:
    """The straight lines between polylines."""
    at, total = start, 0.0
    for line in lines:
        if at is not None:
            total += float(np.hypot(*(line[0] - at)))
        at = line[0] if closed else line[-1]
    return total


def test_lines_are_drawn_back_and_forth() -> None:
    lines = [np.array([[0.0, y], [50.0, y]]) for y in (0.0, 2.0, 1.0)]
    order = pw.order(lines)
    assert order.length == 2.0
    assert order.order.tolist() in ([0, 2, 1], [1, 2, 0])
    assert abs(order.direction.sum()) == 1 and order.bound is None


def test_the_length_is_that_of_what_is_drawn() -> None:
    lines = random_lines(200)
    order = pw.order(lines, start=(0.0, 0.0), certify=True)
    assert sorted(order.order.tolist()) == list(range(200))
    assert length(order.drawn(lines), np.zeros(2)) == pytest.approx(order.length, abs=0.01)
    assert order.bound is not None and 0.9 * order.length < order.bound <= order.length


def test_closed_lines_are_begun_at_any_vertex() -> None:
    squares = [np.array([[x, 0], [x + 5, 0], [x + 5, 5], [x, 5]], dtype=float) for x in (0, 20, 40)]
    order = pw.order(squares, closed=True, start=(0.0, 5.0))
    # From the start 5 mm to a corner and 15 mm on, or none and 20 mm: both are shortest.
    assert (order.direction == 1).all() and order.length == pytest.approx(40.0)
    assert length(order.drawn(squares), np.array([0.0, 5.0]), closed=True) == pytest.approx(order.length)


def test_a_line_that_is_drawn_backwards_is_entered_at_its_last_vertex() -> None:
    lines = [np.array([[10.0, 0.0], [5.0, 0.0], [0.0, 0.0]])]
    order = pw.order(lines, start=(0.0, 0.0))
    assert (order.entry.tolist(), order.direction.tolist(), order.length) == ([2], [-1], 0.0)


def test_groups_come_one_after_the_other() -> None:
    groups = [int(i % 3) - 1 for i in range(30)]
    order = pw.order(random_lines(30), groups=groups)
    drawn = [groups[i] for i in order.order]
    assert drawn == sorted(groups)


def test_complex_numbers_and_lists_are_vertices() -> None:
    lines = random_lines(20)
    as_complex = [line[:, 0] + 1j * line[:, 1] for line in lines]
    as_lists = [line.tolist() for line in lines]
    orders = [pw.order(these).order.tolist() for these in (lines, as_complex, as_lists)]
    assert orders[0] == orders[1] == orders[2]


def test_time_is_a_cost() -> None:
    lines = random_lines(100)
    order = pw.order(lines, cost=pw.TravelTime(100.0, acceleration=500.0, stop=0.1))
    assert order.length < pw.order(lines, strategy="as-sliced").length
    with pytest.raises(ValueError, match="speed"):
        pw.TravelTime(0.0)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([[[0.0, 0.0]], []], "polyline 1"),
        ([[[0.0, 0.0]], [[0.0, 0.0], [float("nan"), 0.0]]], "polyline 1: vertex 1"),
        ([[[0.0, 2e4]]], "polyline 0: vertex 0"),
        ([[0.0, 1.0]], "polyline 0"),
    ],
)
def test_what_is_no_polyline_is_named(lines: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        pw.order(lines)


def test_unknown_words_are_named_with_those_that_there_are() -> None:
    with pytest.raises(ValueError, match="optimized"):
        pw.order(random_lines(2), strategy="fastest")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="normal"):
        pw.order(random_lines(2), effort="none")  # type: ignore[arg-type]


def test_nothing_has_an_order() -> None:
    order = pw.order([])
    assert len(order.order) == 0 and order.length == 0.0
