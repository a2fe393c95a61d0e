"""Progress on stderr, for work over a second."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

ProgressCallback = Callable[[str, float], None]
"""Called with what is being done and how much of it is (0 to 1)."""

PATIENCE = 1.0
"""Seconds of silence: shorter work shows nothing."""


@contextmanager
def progress_on_stderr() -> Iterator[ProgressCallback]:
    """Gives the callback to hand to the library; shows a bar on a terminal, and a line for each stage elsewhere."""
    console = Console(stderr=True)
    display = _Bars(console) if console.is_terminal else _Lines(console)
    timer = threading.Timer(PATIENCE, display.begin)
    timer.daemon = True
    timer.start()
    try:
        yield display.update
    finally:
        timer.cancel()
        display.end()


class _Bars:
    """One bar a stage, gone at the end."""

    def __init__(self, console: Console):
        columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
        self._progress = Progress(*columns, console=console, transient=True)
        self._tasks = {}
        self._lock = threading.Lock()
        self._over = False

    def begin(self) -> None:
        with self._lock:
            if not self._over:
                self._progress.start()

    def update(self, stage: str, fraction: float) -> None:
        if stage not in self._tasks:
            for task in self._tasks.values():
                self._progress.update(task, completed=1.0)
            self._tasks[stage] = self._progress.add_task(stage, total=1.0)
        self._progress.update(self._tasks[stage], completed=fraction)

    def end(self) -> None:
        with self._lock:
            self._over = True
            self._progress.stop()


class _Lines:
    """One line a stage, as a log wants it."""

    def __init__(self, console: Console):
        self._console = console
        self._stage = ""
        self._patience_over = False
        self._lock = threading.Lock()

    def begin(self) -> None:
        with self._lock:
            self._patience_over = True
            self._show()

    def update(self, stage: str, fraction: float) -> None:
        del fraction
        with self._lock:
            if stage != self._stage:
                self._stage = stage
                self._show()

    def _show(self) -> None:
        if self._patience_over and self._stage:
            self._console.print(f"axffit: {self._stage} ...", markup=False, highlight=False, soft_wrap=True)

    def end(self) -> None:
        with self._lock:
            self._patience_over = False
