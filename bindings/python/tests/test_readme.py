"""The README's examples are run, one after the other, as they stand."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import pytest

import pathwright

README = Path(__file__).resolve().parents[1] / "README.md"
MODELS = Path(__file__).resolve().parents[3] / "models"


def test_the_examples_of_the_readme_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(MODELS, tmp_path / "models")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    examples = re.findall(r"```python\n(.*?)```", README.read_text(), flags=re.DOTALL)
    assert len(examples) >= 5
    for example in examples:
        exec(compile(example, str(README), "exec"), names)  # noqa: S102
    assert (tmp_path / "cube.gcode").stat().st_size > 100_000
    assert names["order"].bound <= names["order"].length


def test_everything_public_is_documented() -> None:
    undocumented = [name for name in pathwright.__all__ if not getattr(pathwright, name).__doc__]
    assert undocumented == []
