"""What the experiments share: where their reports go, how numbers and tables are written.

An experiment ``NN_question.py`` writes ``reports/NN_question/report.json``, ``report.md`` and a few small pictures. It
has a function ``subset`` that computes a stated part of the JSON again; tests/experiments compares the two.
Run one from the project's root: ``python -m experiments.NN_question``.
"""

import importlib.util
import json
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
DIGITS = 6


def folder(script: str) -> Path:
    """The report's folder of the experiment ``script`` (its ``__file__``), made if it is not there."""
    path = ROOT / "reports" / Path(script).stem
    path.mkdir(parents=True, exist_ok=True)
    return path


def rounded(value: Any) -> Any:
    """``value`` with floats at 6 significant digits and numbers that JSON has no name for as text."""
    if isinstance(value, dict):
        return {str(key): rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(item) for item in value]
    if hasattr(value, "tolist"):
        return rounded(value.tolist())
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else str(value)
    return value


def write(script: str, data: dict[str, Any], text: str) -> Path:
    """Write report.json and report.md; returns their folder."""
    at = folder(script)
    (at / "report.json").write_text(json.dumps(rounded(data), indent=1) + "\n", encoding="utf-8")
    (at / "report.md").write_text(text.rstrip() + "\n", encoding="utf-8")
    return at


def committed(name: str) -> dict[str, Any]:
    """The report.json of the experiment ``name`` as it lies in the project."""
    return json.loads((ROOT / "reports" / name / "report.json").read_text(encoding="utf-8"))


def load(name: str) -> ModuleType:
    """The experiment ``name`` (such as ``10_calibration``) as a module: its file name is no Python name."""
    spec = importlib.util.spec_from_file_location(f"experiment_{name}", ROOT / "experiments" / f"{name}.py")
    if spec is None or spec.loader is None:
        raise FileNotFoundError(f"no experiment {name} in {ROOT / 'experiments'}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def table(head: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """A Markdown table; floats at 3 significant digits."""

    def cell(value: Any) -> str:
        return f"{value:.3g}" if isinstance(value, float) else str(value)

    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(map(cell, row)) + " |" for row in rows])
