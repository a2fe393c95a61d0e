"""An export that is killed, fails or is refused leaves the one before as it was, and nothing half done."""

import errno
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axffit.axf import AxfFile
from axffit.errors import InputError
from axffit.targets import folder, folder_swap
from tests.targets.materials import paint, ward, with_texture

FILE = AxfFile((ward(), paint()))


def content_of(out: Path) -> dict[str, bytes]:
    """Every file below, by its path; unfinished folders of a killed run are left out."""
    return {
        str(path.relative_to(out)): path.read_bytes()
        for path in sorted(out.rglob("*"))
        if path.is_file() and not path.relative_to(out).parts[0].startswith(folder_swap.PREFIX)
    }


def changed() -> AxfFile:
    """The same ids with other textures."""
    return AxfFile((with_texture(ward(), "diffusecolor", np.full((8, 8, 3), 0.25)), paint(seed=3)))


CHILD = """
import os, signal, sys
from pathlib import Path
from axffit.targets import folder, folder_swap
from tests.targets.test_folder_swap import changed

step, calls = int(sys.argv[2]), 0

def dies_at_step(function):
    def wrapped(*arguments, **options):
        global calls
        if calls == step:
            os.kill(os.getpid(), signal.SIGKILL)
        calls += 1
        return function(*arguments, **options)
    return wrapped

folder.save = dies_at_step(folder.save)
folder_swap._flush = dies_at_step(folder_swap._flush)
folder_swap._exchange = dies_at_step(folder_swap._exchange)
folder.write(changed(), Path(sys.argv[1]))
print("finished after", calls)
"""


def run_child(out: Path, step: int) -> subprocess.CompletedProcess:
    command = [sys.executable, "-c", CHILD, str(out), str(step)]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=Path(__file__).parents[2])


# Of an export over an earlier one: 17 textures written, 22 files and folders made durable, 2 exchanges, 1 last flush.
STEPS = 42


def check_killed(folder_of_test: Path, steps: list[int]) -> None:
    """Kills exports at steps, negative ones counted from the end, and looks at what they leave."""
    after = folder_of_test / "after"
    folder.write(changed(), after)
    expected = content_of(after)
    total = STEPS
    for step in steps:
        out = folder_of_test / f"killed at {step}"
        folder.write(FILE, out)
        before = content_of(out)
        done = run_child(out, step % total)
        assert done.returncode == -signal.SIGKILL, done.stdout + done.stderr
        found = content_of(out)
        for name in ("ward", "paint"):
            part, old, new = (
                {key: value for key, value in whole.items() if key.startswith(name)}
                for whole in (found, before, expected)
            )
            assert part in (old, new), f"killed at step {step}: {name} is neither the old nor the new one"
        # The last steps are: exchange, exchange, and flush of the folder.
        if step % total <= total - 3:
            assert found == before
        if step == -1:
            assert found == expected
        assert len(folder.read(out).materials) == 2
        folder.write(changed(), out)
        assert content_of(out) == expected


needs_kill = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")


@needs_kill
def test_a_killed_export_leaves_what_was_there(tmp_path):
    check_killed(tmp_path, [-2])


@needs_kill
@pytest.mark.slow
def test_an_export_killed_anywhere_leaves_what_was_there(tmp_path):
    folder.write(FILE, tmp_path / "finished")
    finished = run_child(tmp_path / "finished", -1)
    assert finished.stdout.split()[-1:] == [str(STEPS)], finished.stderr
    check_killed(tmp_path, [*range(0, 40, 4), -3, -1])


@pytest.mark.parametrize("fails_at", [0, 5, 12, 16])
def test_a_failing_write_leaves_what_was_there(fails_at, tmp_path, monkeypatch):
    out = tmp_path / "out"
    folder.write(FILE, out)
    before = content_of(out)
    calls = []
    save = folder.save

    def full_disk(*arguments):
        calls.append(arguments)
        if len(calls) > fails_at:
            raise OSError(errno.ENOSPC, "No space left on device", str(arguments[0]))
        return save(*arguments)

    monkeypatch.setattr(folder, "save", full_disk)
    with pytest.raises(OSError, match="No space left"):
        folder.write(changed(), out)
    assert content_of(out) == before
    assert sorted(path.name for path in out.iterdir()) == ["paint", "ward"]
    with pytest.raises(OSError, match="No space left"):
        folder.write(changed(), tmp_path / "new" / "deep")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out"]


@pytest.mark.parametrize("can_exchange", [True, False])
def test_a_folder_that_cannot_be_moved_takes_the_others_back(can_exchange, tmp_path, monkeypatch):
    out = tmp_path / "out"
    folder.write(FILE, out)
    before = content_of(out)
    rename = os.rename
    if not can_exchange:
        monkeypatch.setattr(folder_swap, "_exchange", lambda first, second: False)

    def refuses_new_names(source, target):
        if Path(target).name == "other":
            raise PermissionError(errno.EACCES, "Permission denied", str(target))
        rename(source, target)

    monkeypatch.setattr(os, "rename", refuses_new_names)
    three = AxfFile((*changed().materials, replace(paint(), id="other")))
    with pytest.raises(PermissionError):
        folder.write(three, out)
    assert content_of(out) == before
    assert sorted(path.name for path in out.iterdir()) == ["paint", "ward"]


def test_without_an_exchange_the_old_folder_steps_aside(tmp_path, monkeypatch):
    out, again = tmp_path / "out", tmp_path / "again"
    folder.write(changed(), out)
    monkeypatch.setattr(folder_swap, "_exchange", lambda first, second: False)
    folder.write(FILE, again)
    folder.write(changed(), again)
    assert content_of(again) == content_of(out)
    rename = os.rename

    def fails_second(source, target):
        if Path(target) == again / "ward" and Path(source).name == "ward":
            raise OSError(errno.EIO, "Input/output error", str(target))
        rename(source, target)

    monkeypatch.setattr(os, "rename", fails_second)
    with pytest.raises(OSError, match="Input/output"):
        folder.write(FILE, again)
    assert content_of(again) == content_of(out)


def test_a_folder_below_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("text")
    with pytest.raises(InputError, match="cannot be written"):
        folder.write(FILE, tmp_path / "file" / "out")


def test_what_others_wrote_is_never_replaced(tmp_path):
    folder.write(FILE, tmp_path)
    (tmp_path / "ward" / "notes.txt").write_text("mine")
    (tmp_path / "readme.txt").write_text("also mine")
    before = content_of(tmp_path)
    with pytest.raises(InputError, match=r"holds notes\.txt, which axffit export did not write"):
        folder.write(changed(), tmp_path)
    assert content_of(tmp_path) == before
    # The other material's folder may be replaced; what lies beside stays.
    folder.write(changed(), tmp_path, material="paint")
    assert content_of(tmp_path)["readme.txt"] == b"also mine"
    assert content_of(tmp_path)["ward/notes.txt"] == b"mine"
    other = tmp_path / "other"
    (other / "paint").mkdir(parents=True)
    (other / "paint" / "photo.png").write_bytes(b"mine")
    with pytest.raises(InputError, match=r"photo\.png"):
        folder.write(FILE, other)
    (other / "paint" / "photo.png").unlink()
    folder.write(FILE, other)
    (tmp_path / "link").mkdir()
    (tmp_path / "link" / "ward").symlink_to(other)
    with pytest.raises(InputError, match="is no folder"):
        folder.write(FILE, tmp_path / "link")


IDS = ["../evil", "/etc/evil", "a/../../b", "..", "NUL", "Paint", "paint", "x" * 400, "C:\\evil", "\nline", "ä"]


def test_nothing_is_written_outside_whatever_the_ids(tmp_path):
    out = tmp_path / "deep" / "out"
    file = AxfFile(tuple(replace(paint(), id=id, name=id) for id in IDS))
    exported = folder.write(file, out)
    assert {path for path in tmp_path.rglob("*")} == {tmp_path / "deep", out, *out.rglob("*")}
    assert len(list(out.iterdir())) == len(IDS)
    assert all(item.folder.parent == out for item in exported)
    assert [material.id for material in folder.read(out).materials] == IDS
    # The same material has the same folder when it is exported alone.
    for id in IDS:
        (alone,) = folder.write(file, out, material=id)
        assert alone.folder in {item.folder for item in exported}
    assert len(list(out.iterdir())) == len(IDS)
