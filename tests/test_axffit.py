"""The top level: lazy, and each entry point names a real function."""

import subprocess
import sys

import pytest

import axffit


def test_importing_the_package_loads_no_heavy_module():
    heavy = {"jax", "numpy", "scipy", "h5py", "matplotlib", "optimistix"}
    code = f"import sys, axffit; print(sorted({heavy} & set(sys.modules)))"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "[]"


def test_an_unknown_attribute_is_named():
    with pytest.raises(AttributeError, match="'nothing_here'"):
        axffit.nothing_here  # noqa: B018


@pytest.mark.parametrize("name", [name for name in axffit.__all__ if not name.startswith("_")])
def test_each_entry_point_is_a_function(name):
    assert callable(getattr(axffit, name))
    assert name in dir(axffit)
