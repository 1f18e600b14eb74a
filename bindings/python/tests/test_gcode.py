"""Finished G-code."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Callable

import pytest

import pathwright as pw

Program = Callable[..., "subprocess.CompletedProcess[bytes]"]


@pytest.fixture(scope="module")
def gcode(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cube in the order in which it was planned."""
    path = tmp_path_factory.mktemp("gcode") / "cube.gcode"
    cube = Path(__file__).resolve().parents[3] / "models" / "calibration_cube.stl"
    pw.slice(cube, settings={"order.strategy": "as-sliced"}).write(path)
    return path


def test_gcode_is_reordered_as_the_program_does(gcode: Path, program: Program, tmp_path: Path) -> None:
    program("reorder", gcode, "-o", tmp_path / "program.gcode")
    reordered = pw.reorder(gcode)
    assert reordered.gcode == (tmp_path / "program.gcode").read_bytes()
    assert reordered.report["after"]["travel_mm"] < reordered.report["before"]["travel_mm"]
    reordered.write(tmp_path / "again.gcode")
    again = pw.reorder((tmp_path / "again.gcode").read_bytes())
    assert again.report["after"]["travel_mm"] <= again.report["before"]["travel_mm"]


def test_gcode_is_timed_as_the_program_does(gcode: Path, program: Program) -> None:
    told = json.loads(program("time", gcode, "--json").stdout)
    time = pw.time(gcode)
    assert time["total_s"] == told["total_s"] and time["by_role"] == told["by_role"]


def test_gcode_is_checked_beside_its_model(gcode: Path, cube: Path) -> None:
    assert pw.check(gcode)["errors"] == 0
    assert pw.check(gcode, cube)["model"] is not None
    outside = pw.check(b"G28\nG1 X900 Y0 F3000\n")
    assert "outside" in str(outside["faults"])


def test_what_is_no_gcode_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(pw.InputError, match="is it G-code"):
        pw.check(b"no moves\n")
    with pytest.raises(pw.InputError) as caught:
        pw.time(tmp_path / "gone.gcode")
    assert caught.value.file == str(tmp_path / "gone.gcode")
