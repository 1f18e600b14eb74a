"""A vpype command that orders paths by Pathwright: ``vpype read drawing.svg pwsort write sorted.svg``."""

from __future__ import annotations

import logging

import click
import vpype as vp
import vpype_cli

import pathwright as pw

#: Pixels of CSS, in which vpype counts, are this long.
MM_PER_PIXEL = 25.4 / 96.0


def ordered(lines: vp.LineCollection, effort: str = "normal", certify: bool = False) -> tuple[vp.LineCollection, pw.Order]:
    """Paths in a near-optimal order; those that end where they begin are entered at any vertex."""
    polylines = [line * MM_PER_PIXEL for line in lines]
    closed = [len(line) > 3 and line[0] == line[-1] for line in polylines]
    loops = [line[:-1] if is_closed else line for line, is_closed in zip(polylines, closed)]
    order = pw.order(loops, closed=closed, effort=effort, certify=certify)  # type: ignore[arg-type]
    sorted_lines = lines.clone()
    for index, entry, direction in zip(order.order, order.entry, order.direction):
        line = lines[int(index)]
        if closed[index] and entry > 0:
            line = [*line[entry:-1], *line[: entry + 1]]
        sorted_lines.append(line if direction > 0 else line[::-1])
    return sorted_lines, order


@click.command()
@click.option("--effort", type=click.Choice(["fast", "normal", "high"]), default="normal", help="How long is searched.")
@click.option("--bound", is_flag=True, help="Tell how short the travel of any order is at least.")
@vpype_cli.layer_processor  # type: ignore[untyped-decorator]
def pwsort(lines: vp.LineCollection, effort: str, bound: bool) -> vp.LineCollection:
    """Sorts paths for little pen-up travel, nearer to the shortest possible than linesort."""
    sorted_lines, order = ordered(lines, effort, bound)
    before, after = lines.pen_up_length()[0] * MM_PER_PIXEL, order.length
    least = "" if order.bound is None else f", no order has less than {order.bound:.1f} mm"
    logging.info(f"pwsort: {before:.1f} mm of pen-up travel are now {after:.1f} mm{least}")
    return sorted_lines


pwsort.help_group = "Plugins"  # type: ignore[attr-defined]
