"""Reads hostile files in forked children with limits: ``python -m tests.axf.hostile_driver FIRST COUNT OUT.json``.

What can be read is written and read again, and must be the same.

A program of its own, since children are forked from a process in which JAX has started nothing. A child takes the
inputs in turn and writes what came of each to shared memory; where one ends it, the next child goes on behind.
"""

import collections
import contextlib
import faulthandler
import json
import mmap
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from pathlib import Path

import h5py
import h5py.h5o
import numpy as np

from axffit import axf, spectrum
from axffit.axf.material import same_extras
from axffit.errors import InputError
from tests.axf import hostile

SECONDS = 5
"""Longest time one input may take, on the clock."""

MEMORY = 2**30
"""Address space beyond what the process has before it reads."""

_BATCH = 500
_PENDING, _MAKING = b"\0", b"g"
_READ, _UNWRITABLE, _REFUSED, _STARVED, _MEMORY, _LOST, _OTHER = b"r", b"u", b"i", b"s", b"m", b"l", b"o"
_WORDS = {
    _READ: "read",
    _UNWRITABLE: "read, not written",
    _REFUSED: "refused",
    _STARVED: "refused for memory that it did not touch",
    _MEMORY: "memory",
    _LOST: "not the same when written",
    _OTHER: "other",
}
_BAD = (_MEMORY, _LOST, _OTHER)


def main(first: int, count: int, out: Path) -> None:
    """Reads the inputs and writes how often each outcome came, which were bad, and how many had valid headers."""
    outcomes, valid = mmap.mmap(-1, count), mmap.mmap(-1, count)
    # colour-science takes a second to import; children inherit it. Without it spectra stay what they are.
    with contextlib.suppress(InputError):
        spectrum.weights(tuple(np.linspace(400.0, 700.0, spectrum.SAMPLES)))
    start = time.perf_counter()
    bad: dict[int, str] = {}
    with tempfile.TemporaryDirectory() as folder:
        done = 0
        while done < count:
            end = min(done + _BATCH, count)
            status = _in_child(first, done, end, outcomes, valid, Path(folder))
            finished = end
            if status != 0:
                # The one at work has no outcome yet.
                finished = next(k for k in range(done, end) if outcomes[k : k + 1] in (_PENDING, _MAKING))
                what = "making it" if outcomes[finished : finished + 1] == _MAKING else "reading it"
                ending = os.waitstatus_to_exitcode(status)
                bad[first + finished] = f"{what}: ended with {ending} (negative: signal)"
                outcomes[finished : finished + 1] = _OTHER
                finished += 1
            done = finished
        for k in range(count):
            if outcomes[k : k + 1] == _MEMORY and _touched(first + k, Path(folder)) < MEMORY:
                outcomes[k : k + 1] = _STARVED
    counts = collections.Counter(_WORDS[outcomes[k : k + 1]] for k in range(count))
    for k in range(count):
        if outcomes[k : k + 1] in _BAD:
            bad.setdefault(first + k, _WORDS[outcomes[k : k + 1]])
    content = {
        "count": count,
        "outcomes": counts,
        "valid_headers": sum(valid[k] for k in range(count)),
        "bad": bad,
        "seconds": time.perf_counter() - start,
    }
    out.write_text(json.dumps(content, indent=1))


def _fork(work: Callable[[], None]) -> int:
    """The process id of a child that does the work; it ends with 70, and a traceback, where that raises."""
    child = os.fork()
    if child:
        return child
    try:
        work()
        os._exit(0)
    except BaseException:
        traceback.print_exc()
        os._exit(70)


def _in_child(first: int, start: int, end: int, outcomes: mmap.mmap, valid: mmap.mmap, folder: Path) -> int:
    """Status of a child that reads inputs in turn."""

    def work() -> None:
        faulthandler.enable()
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        path = folder / "hostile.axf"
        for k in range(start, end):
            outcomes[k : k + 1] = _MAKING
            path.write_bytes(hostile.make(first + k, folder))
            outcomes[k : k + 1] = _PENDING
            _limit(MEMORY)
            signal.setitimer(signal.ITIMER_REAL, SECONDS)
            outcome = _read(path, first + k)
            valid[k] = _headers_are_valid(path)
            signal.setitimer(signal.ITIMER_REAL, 0)
            _limit(None)
            outcomes[k : k + 1] = outcome

    return os.waitpid(_fork(work), 0)[1]


def _touched(number: int, folder: Path) -> int:
    """Bytes of memory that reading the input takes when nothing limits its address space.

    libhdf5 asks the system for what a damaged header says before it finds that the file is shorter: address space
    that is never touched and given back at once.
    """
    receive, send = os.pipe()

    def work() -> None:
        path = folder / "hostile.axf"
        path.write_bytes(hostile.make(number, folder))
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        signal.alarm(SECONDS)
        _read(path, number)
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        os.write(send, str(grown * 1024).encode())

    child = _fork(work)
    os.close(send)
    os.waitpid(child, 0)
    answer = os.read(receive, 32)
    os.close(receive)
    return int(answer) if answer else MEMORY


def _limit(beyond: int | None) -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    soft = hard if beyond is None else pages * resource.getpagesize() + beyond
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def _read(path: Path, number: int) -> bytes:
    try:
        content = axf.read(path)
    except InputError as error:
        cause: BaseException | None = error
        while cause is not None:
            # A refusal for want of memory means that the reader asked for more than it may.
            if isinstance(cause, MemoryError) or "memory allocation" in str(cause):
                print(f"{number}: {error}", file=sys.stderr)
                return _MEMORY
            cause = cause.__cause__
        return _REFUSED
    return _written(content, path, number)


def _written(content: axf.AxfFile, path: Path, number: int) -> bytes:
    again = path.with_name("again.axf")
    try:
        axf.write(again, content)
    except InputError as error:
        print(f"{number}: {error}", file=sys.stderr)
        return _UNWRITABLE
    found = axf.read(again)
    pairs = zip(found.materials, content.materials, strict=True)
    same = all(a.identical(b) for a, b in pairs) and same_extras(found.extras, content.extras)
    return _READ if same else _LOST


def _headers_are_valid(path: Path) -> bool:
    """Whether superblock and the header of every object are, as HDF5 itself sees it."""
    try:
        with h5py.File(path, "r") as file:
            seen = 0

            def look(_: bytes, info: h5py.h5o.ObjInfo) -> None:
                nonlocal seen
                seen += 1

            h5py.h5o.visit(file.id, look, info=True)
            return seen > 0
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, InputError):
        return False


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3]))
