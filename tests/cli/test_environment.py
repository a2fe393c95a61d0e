"""What the command line asks of JAX."""

import os

import pytest

from axffit.cli import _environment


@pytest.fixture(autouse=True)
def clean_environment(monkeypatch):
    for name in list(os.environ):
        if name.startswith("JAX_"):
            monkeypatch.delenv(name)
    # So that what the tested function sets is undone, too.
    monkeypatch.setattr(os, "environ", dict(os.environ))


def test_float64_and_a_cache_in_the_users_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(_environment, "cache_folder", lambda: tmp_path / "axffit")
    _environment.prepare_environment()
    assert os.environ["JAX_ENABLE_X64"] == "1"
    assert os.environ["JAX_COMPILATION_CACHE_DIR"] == str(tmp_path / "axffit" / "jax")
    assert (tmp_path / "axffit" / "jax").is_dir()


def test_the_users_own_cache_folder_stays(monkeypatch):
    os.environ["JAX_COMPILATION_CACHE_DIR"] = "elsewhere"
    monkeypatch.setattr(_environment, "cache_folder", lambda: pytest.fail("not asked for"))
    _environment.prepare_environment()
    assert os.environ["JAX_COMPILATION_CACHE_DIR"] == "elsewhere"


def test_no_cache_where_none_can_be_made(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(_environment, "cache_folder", lambda: tmp_path / "file")
    _environment.prepare_environment()
    assert "JAX_COMPILATION_CACHE_DIR" not in os.environ


@pytest.mark.parametrize(
    ("platform", "variables", "expected"),
    [
        ("linux", {"XDG_CACHE_HOME": "/c"}, "/c/axffit"),
        ("linux", {"HOME": "/home/me", "XDG_CACHE_HOME": ""}, "/home/me/.cache/axffit"),
        ("darwin", {"HOME": "/Users/me"}, "/Users/me/Library/Caches/axffit"),
        ("win32", {"LOCALAPPDATA": "/local"}, "/local/axffit"),
    ],
)
def test_cache_folder_by_the_custom_of_the_platform(monkeypatch, platform, variables, expected):
    monkeypatch.setattr(_environment.sys, "platform", platform)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
        os.environ[name] = value
    assert _environment.cache_folder().as_posix() == expected
