"""The farm on three hosts, each a network namespace of its own, with an S3-compatible store (moto). Needs root and `ip`.

    sudo python benches/farm_cluster.py FOLDER [--rows 60]

Host 1 has the store, the scheduler and the client, hosts 2 and 3 a worker each. Models and results are in the store alone. The
worker of host 3 is killed in the middle of the run. In the end every G-code is compared with that of a run on this machine.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import fsspec
from farm import catalogue, farm, results

HOSTS = [f"pw-host{i}" for i in (1, 2, 3)]
STORE = "http://10.77.0.1:5000"
ENVIRONMENT = {
    "FSSPEC_S3_ENDPOINT_URL": STORE,
    "AWS_ACCESS_KEY_ID": "test",
    "AWS_SECRET_ACCESS_KEY": "test",
    "AWS_DEFAULT_REGION": "us-east-1",
}


def ip(*args: str) -> None:
    subprocess.run(["ip", *args], check=True)


def on(host: str, *command: str) -> subprocess.Popen[bytes]:
    """Starts a command on a host."""
    run = ["ip", "netns", "exec", host, *command]
    return subprocess.Popen(run, env={**os.environ, **ENVIRONMENT}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def connect(stack: ExitStack) -> None:
    """Three hosts on one network."""
    ip("netns", "add", "pw-switch")
    stack.callback(ip, "netns", "del", "pw-switch")
    ip("-n", "pw-switch", "link", "add", "bridge", "type", "bridge")
    ip("-n", "pw-switch", "link", "set", "bridge", "up")
    for number, host in enumerate(HOSTS, start=1):
        ip("netns", "add", host)
        stack.callback(ip, "netns", "del", host)
        ip("-n", host, "link", "add", "eth0", "type", "veth", "peer", f"port{number}", "netns", "pw-switch")
        ip("-n", "pw-switch", "link", "set", f"port{number}", "master", "bridge", "up")
        ip("-n", host, "address", "add", f"10.77.0.{number}/24", "dev", "eth0")
        ip("-n", host, "link", "set", "eth0", "up")
        ip("-n", host, "link", "set", "lo", "up")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rows", type=int, default=60)
    given = parser.parse_args()
    path = catalogue(given.folder, given.rows)
    for endless in path.parent.glob("endless*"):
        endless.unlink()  # A store has no pipes.
        endless.write_bytes(b"solid\n")
    # On this machine, first.
    assert farm(path, given.folder / "here").wait() == 0
    here = results(given.folder / "here")
    with ExitStack() as stack:
        connect(stack)

        def start(host: str, *command: str) -> subprocess.Popen[bytes]:
            process = on(host, sys.executable, "-m", *command)
            stack.callback(process.wait)
            stack.callback(process.kill)
            return process

        worker = ["dask", "worker", "tcp://10.77.0.1:8786", "--nthreads", "1", "--no-dashboard", "--death-timeout", "60"]
        start(HOSTS[0], "moto.server", "-H", "10.77.0.1", "-p", "5000")
        start(HOSTS[0], "dask", "scheduler", "--host", "10.77.0.1", "--port", "8786", "--no-dashboard")
        start(HOSTS[1], *worker)
        lost = start(HOSTS[2], *worker)
        time.sleep(6.0)
        script = Path(__file__).resolve()
        up = on(HOSTS[0], sys.executable, str(script), "--upload", str(path.parent))
        assert up.wait() == 0
        began = time.monotonic()
        command = ["pathwright.farm", "slice", "s3://farm/models/catalogue.csv", "--out", "s3://farm/out"]
        command += ["--scheduler", "tcp://10.77.0.1:8786", "--timeout", "30"]
        client = start(HOSTS[0], *command)
        time.sleep(5.0)
        lost.kill()
        start(HOSTS[2], *worker)
        assert client.wait() == 0
        took_s = time.monotonic() - began
        down = on(HOSTS[0], sys.executable, str(script), "--download", str(given.folder / "there"))
        assert down.wait() == 0
        began = time.monotonic()
        again = start(HOSTS[0], *command)
        assert again.wait() == 0
        again_s = time.monotonic() - began
    there = results(given.folder / "there")
    same = sorted(gcode for _, gcode in there.values() if gcode) == sorted(gcode for _, gcode in here.values() if gcode)
    print(f"{len(there)} rows on three hosts in {took_s:.0f} s, a worker lost; the same G-code as here: {same}; again: {again_s:.1f} s")
    assert same and len(there) == len(here)


def upload(folder: Path) -> None:
    """Models into the store."""
    s3: Any = fsspec.filesystem("s3")
    s3.mkdir("farm")
    for path in sorted(folder.iterdir()):
        s3.pipe(f"farm/models/{path.name}", path.read_bytes())


def download(folder: Path) -> None:
    """Results from the store."""
    s3: Any = fsspec.filesystem("s3")
    for name in s3.find("farm/out"):
        target = folder / name[len("farm/out/") :]
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(s3.cat(name))


if __name__ == "__main__":
    if sys.argv[1] == "--upload":
        upload(Path(sys.argv[2]))
    elif sys.argv[1] == "--download":
        download(Path(sys.argv[2]))
    else:
        main()
