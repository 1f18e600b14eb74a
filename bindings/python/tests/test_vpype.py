"""The plug-in for vpype in examples/."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

vpype = pytest.importorskip("vpype")
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "examples" / "vpype-pathwright"))


def drawing() -> object:
    """Lines and squares, at random."""
    random = np.random.default_rng(5)
    lines = vpype.LineCollection()
    for _ in range(60):
        x, y = random.random(2) * 500
        lines.append([complex(x, y), complex(x + 30 * random.random(), y + 30)])
        a, b = random.random(2) * 500
        lines.append([complex(a, b), complex(a + 9, b), complex(a + 9, b + 9), complex(a, b + 9), complex(a, b)])
    return vpype.Document(lines)


def test_it_is_shorter_than_linesort_and_draws_the_same() -> None:
    import vpype_pathwright
    from vpype_cli import execute

    execute.__globals__["cli"].add_command(vpype_pathwright.pwsort, "pwsort")
    before = drawing()
    theirs = execute("linesort --two-opt", drawing()).layers[1]
    ours = execute("pwsort", drawing()).layers[1]
    assert ours.pen_up_length()[0] < theirs.pen_up_length()[0]

    def segments(lines: object) -> set[frozenset[complex]]:
        return {frozenset(pair) for line in lines for pair in zip(line[:-1], line[1:])}  # type: ignore[attr-defined]

    assert segments(ours) == segments(before.layers[1]) and len(ours) == 120  # type: ignore[attr-defined]


def test_the_length_that_is_told_is_vpypes() -> None:
    from vpype_pathwright import MM_PER_PIXEL, ordered

    lines, order = ordered(drawing().layers[1])  # type: ignore[attr-defined]
    assert lines.pen_up_length()[0] * MM_PER_PIXEL == pytest.approx(order.length, abs=0.01)
