"""Progress: silent for short work, one line a stage in a log, bars on a terminal."""

import io
import time

from rich.console import Console

from axffit.cli import _progress


def test_short_work_shows_nothing(capsys):
    with _progress.progress_on_stderr() as progress:
        progress("fitting", 0.5)
    assert capsys.readouterr() == ("", "")


def test_longer_work_writes_a_line_a_stage(capsys, monkeypatch):
    monkeypatch.setattr(_progress, "PATIENCE", 0.01)
    with _progress.progress_on_stderr() as progress:
        progress("reading [0]", 0.0)
        time.sleep(0.2)
        for fraction in (0.0, 0.5, 1.0):
            progress("fitting", fraction)
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.splitlines() == ["axffit: reading [0] ...", "axffit: fitting ..."]


def test_bars_vanish_at_the_end():
    stream = io.StringIO()
    bars = _progress._Bars(Console(file=stream, force_terminal=True, width=80))
    bars.begin()
    bars.update("fitting", 0.5)
    bars.update("rendering", 0.5)
    bars.end()
    assert "fitting" in stream.getvalue()
    bars.begin()  # a timer that comes late
    assert not bars._progress.live.is_started
