"""Slicing: the program's bytes, errors by kind, cancelling."""

from __future__ import annotations

import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

import pathwright as pw

MODELS = Path(__file__).resolve().parents[3] / "models"
Program = Callable[..., "subprocess.CompletedProcess[bytes]"]


@pytest.mark.parametrize(
    ("models", "options", "args"),
    [
        (["calibration_cube.stl"], {}, []),
        (
            ["tilted_bracket.3mf"],
            {"profiles": ["petg"], "settings": {"infill.density": "15%", "support.enabled": True}},
            ["--profile", "petg", "--set", "infill.density=15%", "--set", "support.enabled=true"],
        ),
        (["calibration_cube.stl", "tilted_bracket.3mf"], {"certify": True, "pauses": ["12"]}, ["--certify", "--pause-at", "12"]),
    ],
)
def test_gcode_and_key_are_those_of_the_program(
    models: list[str], options: Any, args: list[str], program: Program, tmp_path: Path
) -> None:
    paths = [MODELS / model for model in models]
    program("slice", *paths, *args, "-o", tmp_path / "program.gcode")
    print_ = pw.slice(paths, **options)
    assert print_.gcode == (tmp_path / "program.gcode").read_bytes()
    assert pw.key(paths, **options) == program("key", *paths, *args).stdout.decode().strip()


def test_a_project_is_sliced_as_the_program_does(cube: Path, program: Program, tmp_path: Path) -> None:
    project = tmp_path / "plate.3mf"
    program("slice", cube, "--rotate", "0,0,45", "--set", "walls.count=3", "--save-project", project)
    program("slice", project, "-o", tmp_path / "program.gcode")
    assert pw.slice(project).gcode == (tmp_path / "program.gcode").read_bytes()
    with pytest.raises(pw.InputError, match="alone"):
        pw.slice([project, cube])


def test_settings_of_a_model_and_its_transform(cube: Path, program: Program, tmp_path: Path) -> None:
    options = ["--scale", "1,1,0.5", "--copies", "2", "--object", "calibration_cube:infill.density=40%"]
    program("slice", cube, *options, "-o", tmp_path / "program.gcode")
    model = pw.Model(cube, scale=(1, 1, 0.5), copies=2, settings={"infill.density": "40%"})
    assert pw.slice(model).gcode == (tmp_path / "program.gcode").read_bytes()


def test_a_mesh_prints_like_the_file_that_it_is_saved_as(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    stl = pytest.importorskip("stl")
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=8.0)
    path = tmp_path / "mesh.stl"
    mesh.export(path)
    gcode = pw.slice(path).gcode
    assert pw.slice(mesh).gcode == gcode
    assert pw.slice(pw.Mesh(mesh.vertices, mesh.faces)).gcode == gcode
    other = stl.mesh.Mesh.from_file(str(path))
    assert pw.slice(pw.Model(other, name="mesh.stl")).gcode == gcode
    assert pw.slice(pw.Model(path.read_bytes(), name="mesh.stl")).gcode == gcode


def test_a_summary_has_the_programs_keys(cube: Path, program: Program, tmp_path: Path) -> None:
    import json

    told = json.loads(program("slice", cube, "--json", "-o", tmp_path / "a.gcode").stdout)
    summary = pw.slice(cube).summary
    assert summary.keys() == told.keys()
    assert summary["total_s"] == told["total_s"] and summary["layers"] == told["layers"]


def test_times_and_lengths_of_paths_add_up(cube: Path) -> None:
    print_ = pw.slice(cube)
    layer, figures = print_.layers[40], print_.summary["layers"][40]
    paths = layer.paths
    assert paths.points.shape == (len(paths.widths), 3) and paths.starts[-1] == len(paths.points)
    length = sum(float(np.linalg.norm(np.diff(path.points, axis=0), axis=1).sum()) for path in paths)
    assert length == pytest.approx(figures["print_mm"], rel=1e-6)
    assert 0.0 < paths.times.sum() < figures["total_s"]
    assert (paths.widths > 0.3).all() and "External perimeter" in paths.roles
    assert layer.z == pytest.approx(figures["z_mm"]) and (paths.points[:, 2] == layer.z).all()
    assert (paths.speeds[paths.starts[:-1]] == 0.0).all() and (paths[0].speeds[1:] > 0.0).all()


def test_arrays_of_a_path_are_views(cube: Path) -> None:
    paths = pw.slice(cube).layers[3].paths
    assert paths[1].points.base is not None and np.shares_memory(paths[1].points, paths.points)


def test_it_rises_along_a_spiral(cube: Path) -> None:
    layer = pw.slice(cube, settings={"spiral.enabled": True}).layers[20]
    z = layer.paths[0].points[:, 2]
    assert (np.diff(z) >= 0).all() and z[-1] - z[0] == pytest.approx(layer.height, rel=0.02)


def test_a_print_is_written_whole_or_not_at_all(cube: Path, program: Program, tmp_path: Path) -> None:
    print_ = pw.slice(cube)
    print_.write(tmp_path / "a.gcode")
    assert (tmp_path / "a.gcode").read_bytes() == print_.gcode
    program("slice", cube, "-o", tmp_path / "program.bgcode")
    print_.write(tmp_path / "b.bgcode")
    assert (tmp_path / "b.bgcode").read_bytes() == (tmp_path / "program.bgcode").read_bytes()
    with pytest.raises(pw.OutputError, match="gone"):
        print_.write(tmp_path / "gone" / "a.gcode")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.gcode", "b.bgcode", "program.bgcode"]


def test_errors_have_a_kind_a_file_and_a_place(cube: Path, tmp_path: Path) -> None:
    broken = tmp_path / "broken.stl"
    broken.write_text("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n")
    with pytest.raises(pw.InputError) as caught:
        pw.slice(broken)
    assert (caught.value.kind, caught.value.file, caught.value.place) == ("input", str(broken), "line 4")
    with pytest.raises(pw.SettingsError, match="did you mean") as wrong:
        pw.slice(cube, settings={"infill.densty": 0.2})
    assert wrong.value.key == "infill.densty"
    with pytest.raises(pw.DoesNotFitError) as large:
        pw.slice(pw.Model(cube, scale=100.0))
    assert large.value.object is not None
    again = pickle.loads(pickle.dumps(large.value))
    assert (str(again), again.object, again.kind) == (str(large.value), large.value.object, "does_not_fit")
    with pytest.raises(pw.InputError, match="face 1"):
        pw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 1, 3]])
    with pytest.raises(TypeError, match="profile"):
        pw.slice(cube, profile="petg")  # type: ignore[call-arg]


def test_progress_is_told_in_the_callers_thread_and_ends_with_all(cube: Path) -> None:
    told: list[tuple[int, int]] = []
    threads = set()

    def progress(done: int, of: int) -> None:
        told.append((done, of))
        threads.add(threading.get_ident())

    print_ = pw.slice(cube, progress=progress)
    assert told == sorted(told) and told[-1] == (len(print_.layers), len(print_.layers))
    assert threads == {threading.get_ident()}


def test_an_exception_of_progress_ends_the_run(cube: Path) -> None:
    def progress(done: int, of: int) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        pw.slice(pw.Model(cube, scale=5.0), progress=progress)


def test_other_threads_go_on(cube: Path) -> None:
    turns = 0
    over = threading.Event()

    def count() -> None:
        nonlocal turns
        while not over.is_set():
            turns += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    began = time.monotonic()
    pw.slice(pw.Model(cube, scale=4.0))
    took = time.monotonic() - began
    over.set()
    thread.join()
    assert turns > took * 100


INTERRUPTED = """
import os, signal, sys, threading, time
import numpy as np
import pathwright as pw

# What runs in the background is begun with interrupts ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
sent = []
def interrupt():
    sent.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)
points = np.random.default_rng(1).random((30_000, 2, 2)) * 300
work = {
    "slice": lambda: pw.slice(pw.Model(sys.argv[2], scale=8.0), settings={"layer.height": 0.05}),
    "order": lambda: pw.order(list(points), effort="high"),
}[sys.argv[1]]
threading.Timer(0.5, interrupt).start()
try:
    work()
except KeyboardInterrupt:
    print(time.monotonic() - sent[0])
    sys.stdout.flush()
    os._exit(0)
os._exit(1)
"""


@pytest.mark.parametrize("work", ["slice", "order"])
def test_an_interrupt_ends_it_within_a_tenth_of_a_second(work: str, cube: Path) -> None:
    run = [sys.executable, "-c", INTERRUPTED, work, str(cube)]
    done = subprocess.run(run, capture_output=True, text=True, timeout=60, check=True)
    # Another fifth for a machine that does something else as well.
    assert float(done.stdout) < 0.3


def test_jupyter_shows_figures_and_pictures(cube: Path) -> None:
    print_ = pw.slice(cube)
    html = print_._repr_html_()
    assert "calibration_cube.stl" in html and "data:image/png;base64," in html
    layer = print_.layers[3]
    assert layer._repr_svg_().startswith("<svg") and layer._repr_png_().startswith(b"\x89PNG")
    assert "layers" in repr(print_)


def test_the_schema_describes_every_setting() -> None:
    schema = pw.settings_schema()
    assert schema["layer.height"]["unit"] == "mm" and schema["layer.height"]["default"] == 0.2
    assert set(schema["order.strategy"]["choices"]) == {
        "as-sliced", "nearest", "greedy", "christofides", "christofides-open", "optimized",
    }  # fmt: skip


def test_strategies_are_compared_as_the_program_does(cube: Path, program: Program) -> None:
    import json

    told = json.loads(program("compare", cube, "--json", "--no-bound").stdout)["strategies"]
    rows = pw.compare(cube)
    assert [row["link_mm"] for row in rows] == [row["link_mm"] for row in told]
    assert rows[-1]["strategy"] == "optimized" and rows[-1]["took_s"] > 0.0 and "<table>" in rows._repr_html_()


def test_a_model_is_described(cube: Path) -> None:
    (info,) = pw.info(cube)
    assert info["fits"] is True and info["objects"] == 1


def test_an_error_is_never_none_and_signals_are_left_alone(cube: Path) -> None:
    before = signal.getsignal(signal.SIGINT)
    assert pw.slice(cube).gcode
    assert signal.getsignal(signal.SIGINT) is before
