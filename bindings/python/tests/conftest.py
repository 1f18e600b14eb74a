"""What tests share."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import Callable

import pytest

ROOT = Path(__file__).resolve().parents[3]
MODELS = ROOT / "models"


@pytest.fixture
def cube() -> Path:
    """A cube of 20 mm."""
    return MODELS / "calibration_cube.stl"


@pytest.fixture(scope="session")
def program() -> Callable[..., subprocess.CompletedProcess[bytes]]:
    """Runs the program of this repository, which `PATHWRIGHT` names."""
    name = os.environ.get("PATHWRIGHT") or shutil.which("pathwright")
    if name is None:
        pytest.skip("PATHWRIGHT does not name the program")

    def run(*args: object) -> subprocess.CompletedProcess[bytes]:
        return subprocess.run([name, *map(str, args)], capture_output=True, check=True, timeout=120)

    return run
