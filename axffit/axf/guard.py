"""Untrusted HDF5 is read by another process first, since libhdf5 itself may crash on it or never come back.

Measured with HDF5 2.0.0 over files with changed bytes: about one in 30 000 ends the process that opens it or keeps it
for ever, in ways too many to look for beforehand (`heaps` and `filters` do look for two of them). One process is
started for all files, with the first, and again after a file that ended it; a file costs its reading once more.
"""

import atexit
import contextlib
import json
import os
import queue
import subprocess
import sys
import threading
from pathlib import Path

from ..errors import InputError

SECONDS = 3.0
"""Time that 500 nodes of a file may take."""

BYTES_PER_SECOND = 2e7
"""Declared values that must be read in a second beyond that: a tenth of what a slow machine unpacks."""

_START_SECONDS = 60.0
_HERE = Path(__file__).resolve().parent

# The package stands there without its __init__, which would import JAX: a second in place of a fifth.
_PROGRAM = f"""
import sys, types
package = sys.modules["axffit.axf"] = types.ModuleType("axffit.axf")
package.__path__ = [{str(_HERE)!r}]
from axffit.axf.guard_process import main
main()
"""
# -P and a path of our own: what lies in the working folder is not imported.
_COMMAND = (sys.executable, "-P", "-c", _PROGRAM)


def check(path: str | Path) -> None:
    """Refuse a file that crashes libhdf5 or that it does not come back from.

    Raises:
        InputError: it does, or no process could be started to find out.
    """
    with _LOCK:
        guard = _running()
        try:
            guard.ask(os.path.abspath(path))
        except InputError as error:
            guard.end()
            raise InputError(f"{path}: damaged HDF5: {error}; get a fresh copy of the file") from None


class _Guard:
    """The other process, and the thread that waits for its answers."""

    def __init__(self) -> None:
        self.owner = os.getpid()
        paths = os.pathsep.join(filter(None, (str(_HERE.parents[1]), *sys.path)))
        try:
            self.process = subprocess.Popen(
                _COMMAND,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": paths},
                text=True,
            )
        except OSError as error:
            raise InputError(f"no process can be started to read untrusted files first ({error})") from error
        self.answers: queue.SimpleQueue[str] = queue.SimpleQueue()
        threading.Thread(target=self._listen, daemon=True).start()
        if self._answer(_START_SECONDS) != "ready":
            self.end()
            raise InputError("the process that reads untrusted files first does not start")

    @property
    def is_usable(self) -> bool:
        """Whether it runs, and belongs to this process and not to one that this was forked from."""
        return self.owner == os.getpid() and self.process.poll() is None

    def ask(self, path: str) -> None:
        assert self.process.stdin is not None
        try:
            self.process.stdin.write(json.dumps(path) + "\n")
            self.process.stdin.flush()
        except OSError:
            raise InputError("HDF5's library crashed") from None
        answer = "walking"
        while answer == "walking":
            answer = self._answer(SECONDS)
        if answer.startswith("declared "):
            answer = self._answer(SECONDS + int(answer.split()[1]) / BYTES_PER_SECOND)
        if answer != "done":
            raise InputError("HDF5's library crashes on it")

    def _answer(self, seconds: float) -> str:
        try:
            return self.answers.get(timeout=seconds)
        except queue.Empty:
            raise InputError(f"HDF5's library does not come back from it within {seconds:.0f} s") from None

    def _listen(self) -> None:
        assert self.process.stdout is not None
        with contextlib.suppress(OSError, ValueError):
            for line in self.process.stdout:
                self.answers.put(line.strip())
        self.answers.put("")

    def end(self) -> None:
        if self.owner != os.getpid():
            return
        self.process.kill()
        self.process.wait()
        with contextlib.suppress(OSError):
            for stream in (self.process.stdin, self.process.stdout):
                if stream is not None:
                    stream.close()


_LOCK = threading.Lock()
_GUARDS: list[_Guard] = []


def _running() -> _Guard:
    if _GUARDS and not _GUARDS[0].is_usable:
        _GUARDS.pop().end()
    if not _GUARDS:
        _GUARDS.append(_Guard())
    return _GUARDS[0]


@atexit.register
def _end() -> None:
    while _GUARDS:
        _GUARDS.pop().end()
