"""The farm: rows once, right, whatever fails."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

import pathwright as pw

pytest.importorskip("distributed")
pq = pytest.importorskip("pyarrow.parquet")

from pathwright.farm import _catalogue, _guard  # noqa: E402
from pathwright.farm.__main__ import main  # noqa: E402
from pathwright.farm._store import Store  # noqa: E402

MODELS = Path(__file__).resolve().parents[3] / "models"
Program = Callable[..., "subprocess.CompletedProcess[bytes]"]


def box(path: Path, size: float) -> Path:
    """A model of twelve facets."""
    vertices = np.array([[x, y, z] for x in (0, size) for y in (0, size) for z in (0, 2)], dtype=float)
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
             [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]  # fmt: skip
    from pathwright._models import _corners, _stl

    path.write_bytes(_stl(_corners(vertices, faces, path.name)))
    return path


def table(folder: Path, work: str = "slice") -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = pq.read_table(folder / f"{work}.parquet").to_pylist()
    return rows


@pytest.fixture
def catalogue(tmp_path: Path) -> Path:
    """Three models that can be printed, one that is broken, and one that never ends."""
    folder = tmp_path / "models"
    folder.mkdir()
    for size in (8, 12):
        box(folder / f"box{size}.stl", size)
    (folder / "broken.stl").write_text("solid nothing\n")
    os.mkfifo(folder / "endless.stl")
    path = folder / "catalogue.csv"
    path.write_text(
        "model,profiles,settings,infill.density\n"
        "box8.stl,petg,,\n"
        "box8.stl,,walls.count=3;order.strategy=nearest,\n"
        "box12.stl,,,40%\n"
        "broken.stl,,,\n"
        "endless.stl,,,\n"
        "box8.stl,petg,,\n"
    )
    return path


def test_every_row_is_there_once_with_the_programs_bytes(
    catalogue: Path, program: Program, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    command = ["slice", str(catalogue), "--out", str(out), "--timeout", "3", "--workers", "1"]
    assert main(command) == 0
    rows = table(out)
    assert [Path(row["model"]).name for row in rows].count("box8.stl") == 2 and len(rows) == 5
    kinds = {Path(row["model"]).name: row["error_kind"] for row in rows}
    assert kinds == {"box8.stl": None, "box12.stl": None, "broken.stl": "input", "endless.stl": "timeout"}
    (row,) = [row for row in rows if row["settings"] == '{"infill.density": "40%"}']
    box12 = catalogue.parent / "box12.stl"
    program("slice", box12, "--set", "infill.density=40%", "-o", tmp_path / "program.gcode")
    assert (out / row["gcode"]).read_bytes() == (tmp_path / "program.gcode").read_bytes()
    assert row["key"] == program("key", box12, "--set", "infill.density=40%").stdout.decode().strip()
    assert row["time_s"] > 10 and row["filament_g"] > 0
    assert not list(out.glob("slice.rows/*/*.json"))

    # A second run does nothing.
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()}
    capsys.readouterr()
    began = time.monotonic()
    assert main(command) == 0
    assert time.monotonic() - began < 2.0
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()} == before
    assert "3 rows well, 2 with errors (input 1, timeout 1)" in capsys.readouterr().out

    # What changes is done again, and what is asked for.
    box(catalogue.parent / "broken.stl", 5)
    assert main([*command, "--retry", "timeout"]) == 0
    again = {row["id"]: row for row in table(out)}
    assert len(again) == 6 and sum(row["error_kind"] is None for row in again.values()) == 4


def test_a_run_that_is_killed_goes_on_where_it_was(catalogue: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    text = "model,layer.height\n" + "".join(f"box12.stl,0.{height}\n" for height in range(10, 30))
    catalogue.write_text(text)
    command = [sys.executable, "-m", "pathwright.farm", "slice", str(catalogue), "--out", str(out), "--workers", "1"]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as process:
        while len(list(out.glob("slice.rows/*/*.json"))) < 3:
            assert process.poll() is None
            time.sleep(0.02)
        process.kill()
    assert not (out / "slice.parquet").exists()
    kept = {path.stem: path.stat().st_mtime_ns for path in out.glob("gcode/*/*.gcode")}
    subprocess.run(command, check=True, timeout=120, stderr=subprocess.DEVNULL)
    rows = table(out)
    assert len({row["id"] for row in rows}) == len(rows) == 20
    for row in rows:
        gcode = pw.slice(row["model"], settings=json.loads(row["settings"]), threads=1).gcode
        assert (out / row["gcode"]).read_bytes() == gcode
    again = [name for name, when in kept.items() if (out / f"gcode/{name[:2]}/{name}.gcode").stat().st_mtime_ns != when]
    assert len(again) <= 1, "but for what was being written nothing is done twice"


def test_strategies_are_compared_into_one_table_and_one_picture(catalogue: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    folder = tmp_path / "only"
    folder.mkdir()
    box(folder / "a.stl", 9)
    box(folder / "b.stl", 14)
    command = ["compare", str(folder), "--out", str(out), "--workers", "1", "--plot", "travel.png"]
    assert main([*command, "--strategies", "nearest,optimized"]) == 0
    rows = table(out, "compare")
    assert [row["strategy"] for row in rows].count("optimized") == 2 and len(rows) == 4
    assert all(row["link_mm"] >= row["bound_mm"] for row in rows)
    assert (out / "travel.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("part\na.stl\n", "unknown columns part"),
        ("model\n\"\"\n", "row 1: it names no model"),
        ("model,settings\na.stl,walls.count\n", "row 1: settings"),
    ],
)
def test_a_wrong_catalogue_names_the_row(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "catalogue.csv"
    path.write_text(text)
    with pytest.raises(_catalogue.CatalogueError, match=message):
        _catalogue.read(str(path))


def test_parquet_and_folders_are_catalogues(tmp_path: Path) -> None:
    import pyarrow as pa

    box(tmp_path / "a.stl", 9)
    rows = [{"model": "a.stl", "settings": '{"walls.count": 3}', "profiles": "petg;fine"}]
    pq.write_table(pa.Table.from_pylist(rows), tmp_path / "c.parquet")
    (row,) = _catalogue.read(str(tmp_path / "c.parquet"))
    assert (row.model, row.profiles, row.settings) == (str(tmp_path / "a.stl"), ("petg", "fine"), {"walls.count": "3"})
    assert [Path(row.model).name for row in _catalogue.read(str(tmp_path))] == ["a.stl"]
    assert main(["slice", str(tmp_path / "gone.csv"), "--out", str(tmp_path)]) == 3


@pytest.fixture
def guard() -> Iterator[_guard.Guard]:
    guard = _guard.Guard(_guard.Limits(timeout_s=20.0, memory_bytes=400 << 20))
    yield guard
    guard.close()


def task(model: Path, out: Path, **options: Any) -> dict[str, Any]:
    options = {"settings": {}, "threads": 1, **options}
    return {"id": "ab", "model": str(model), "row": {}, "out": str(out), "about": {"work": "slice"}, "options": options}


def ran(guard: _guard.Guard, *tasks: dict[str, Any]) -> list[dict[str, Any]]:
    """The rows that tasks come to."""
    return [row for _, rows in guard.run(tasks) for row in rows]


def test_a_process_that_crashes_is_a_row_and_the_next_one_is_new(guard: _guard.Guard, tmp_path: Path) -> None:
    model = box(tmp_path / "a.stl", 10)
    (well,) = ran(guard, task(model, tmp_path))
    assert well["error_kind"] is None if "error_kind" in well else well["layers"] == 10
    os.mkfifo(tmp_path / "endless.stl")
    assert guard._child is not None
    first = guard._child.pid
    import threading

    threading.Timer(0.3, os.kill, (first, signal.SIGSEGV)).start()
    crashed, again = ran(guard, task(tmp_path / "endless.stl", tmp_path), task(model, tmp_path))
    assert crashed["error_kind"] == "crash" and "SIGSEGV" in crashed["error"]
    assert again["key"] == well["key"] and guard._child.pid != first


def test_too_much_memory_is_a_row(guard: _guard.Guard, tmp_path: Path) -> None:
    facets = np.random.default_rng(3).random((2_000_000, 3, 3)).astype("<f4") * 200
    from pathwright._models import _stl

    (tmp_path / "large.stl").write_bytes(_stl(facets))
    model = box(tmp_path / "a.stl", 10)
    row, well = ran(guard, task(tmp_path / "large.stl", tmp_path), task(model, tmp_path))
    assert row["error_kind"] == "memory"
    assert well["layers"] == 10


def test_what_nobody_asks_for_any_more_is_not_taken_for_an_answer(guard: _guard.Guard, tmp_path: Path) -> None:
    small, large = box(tmp_path / "a.stl", 10), box(tmp_path / "b.stl", 20)
    for _ in guard.run([task(small, tmp_path), task(small, tmp_path), task(small, tmp_path)]):
        break
    (row,) = ran(guard, task(large, tmp_path))
    assert row["key"] == pw.key(large)


def test_what_is_kept_of_a_row_is_found_by_its_identity_alone(tmp_path: Path) -> None:
    store = Store(str(tmp_path))
    store.record("slice", "ab", [{"id": "ab", "layers": 3}])
    assert store.recorded("slice", "ab") == [{"id": "ab", "layers": 3}] and store.recorded("slice", "cd") is None


def test_a_process_ends_with_whoever_asks(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "endless.stl")
    script = (
        "import sys, json, threading, time\n"
        "from pathwright.farm._guard import Guard, Limits\n"
        "guard = Guard(Limits(60, 1 << 30))\n"
        "run = lambda: list(guard.run([json.loads(sys.argv[1])]))\n"
        "threading.Thread(target=run, daemon=True).start()\n"
        "time.sleep(1.0)\n"
        "print(guard._child.pid, flush=True)\n"
        "time.sleep(60)\n"
    )
    given = json.dumps(task(tmp_path / "endless.stl", tmp_path))
    process = subprocess.Popen([sys.executable, "-c", script, given], stdout=subprocess.PIPE)
    assert process.stdout is not None
    child = int(process.stdout.readline())
    process.kill()
    process.wait()
    process.stdout.close()
    import psutil

    deadline = time.monotonic() + 5.0
    while psutil.pid_exists(child) and psutil.Process(child).status() != psutil.STATUS_ZOMBIE:
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_results_go_to_an_object_store(catalogue: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    server = pytest.importorskip("moto.server")
    pytest.importorskip("s3fs")
    running = server.ThreadedMotoServer(ip_address="127.0.0.1", port=0)
    running.start()
    try:
        host, port = running.get_host_and_port()
        monkeypatch.setenv("FSSPEC_S3_ENDPOINT_URL", f"http://{host}:{port}")
        for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
            monkeypatch.setenv(name, "test")
        import fsspec

        fsspec.config.set_conf_env(fsspec.config.conf)
        s3 = fsspec.filesystem("s3")
        s3.mkdir("farm")
        s3.put(str(catalogue.parent / "box8.stl"), "farm/models/box8.stl")
        s3.pipe("farm/catalogue.csv", b"model,walls.count\nmodels/box8.stl,2\nmodels/box8.stl,3\nmodels/gone.stl,\n")
        # A process of its own: workers have the environment with which the first of them began.
        command = [sys.executable, "-m", "pathwright.farm", "slice", "s3://farm/catalogue.csv", "--out", "s3://farm/out"]
        subprocess.run([*command, "--workers", "1"], check=True)
        rows = pq.read_table(io.BytesIO(Store("s3://farm/out").get("slice.parquet"))).to_pylist()
        assert sorted(str(row["error_kind"]) for row in rows) == ["None", "None", "input"]
        gcode = pw.slice(catalogue.parent / "box8.stl", settings={"walls.count": 3}).gcode
        assert gcode in [s3.cat(f"farm/out/{row['gcode']}") for row in rows if row["gcode"]]
        table = s3.info("farm/out/slice.parquet")["ETag"], s3.find("farm/out")
        subprocess.run([*command, "--workers", "1"], check=True)
        assert table == (s3.info("farm/out/slice.parquet")["ETag"], s3.find("farm/out")), "a second run does nothing"
    finally:
        running.stop()
        import fsspec

        fsspec.config.conf.pop("s3", None)


def test_bounds_are_computed_up_to_a_number_of_paths(tmp_path: Path) -> None:
    from pathwright.farm._plot import measured

    folder = tmp_path / "only"
    folder.mkdir()
    box(folder / "a.stl", 9)
    for most, has_bounds in ((1, False), (0, True)):
        out = tmp_path / f"out{most}"
        assert main(["compare", str(folder), "--out", str(out), "--workers", "1", "--bound-paths", str(most)]) == 0
        rows = table(out, "compare")
        assert {row["bound_mm"] is not None for row in rows} == {has_bounds}
        assert ("bound" in measured(rows)[0]) == has_bounds
