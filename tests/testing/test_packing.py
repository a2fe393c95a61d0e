"""What is checked of a target: every one passes on a real material, and a planted fault is named."""

from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest

from axffit.errors import InputError
from axffit.targets import TARGETS, unity_2018
from axffit.testing import packing
from tests.testing.materials import constant, mapped, plain

RAMP = mapped(np.linspace(0.1, 0.9, 4 * 4 * 3).reshape(4, 4, 3))


def checks(material, target):
    return dict(packing.checks(material, target))


def faulty(**functions):
    """unity_2018 with other functions."""
    module = ModuleType("faulty")
    vars(module).update({name: getattr(unity_2018, name) for name in ("NAME", "pack", "unpack", "validate")})
    vars(module).update(functions)
    return module


@pytest.mark.parametrize("target", TARGETS)
def test_every_target_passes(target):
    for run in checks(plain(diffusecolor=RAMP), TARGETS[target]).values():
        run()


def altered(factor=1.0, **textures):
    def unpack(packed):
        material = unity_2018.unpack(packed)
        diffuse = material.textures["diffusecolor"]
        levels = tuple((level * factor).astype(level.dtype) for level in diffuse.levels)
        return replace(
            material, textures={**material.textures, "diffusecolor": replace(diffuse, levels=levels)} | textures
        )

    return unpack


def without_a_texture(packed):
    material = unity_2018.unpack(packed)
    return replace(material, textures={k: v for k, v in material.textures.items() if k != "diffusecolor"})


def dropped(material):
    packed = unity_2018.pack(material)
    return replace(packed, textures=dict(list(packed.textures.items())[1:]))


def refused(material):
    raise InputError("no room")


def forgetful():
    """Unpacks what it should the first time only."""
    seen = []

    def unpack(packed):
        seen.append(packed)
        return (unity_2018.unpack if len(seen) == 1 else without_a_texture)(packed)

    return unpack


FAULTS = {
    "a dropped texture": ("obligations", faulty(pack=dropped), "obligations broken; "),
    "an illegal value": ("unpacks", faulty(unpack=altered(opacity=constant(2.0))), "no valid material: .*opacity"),
    "no packing": ("unpacks", faulty(pack=refused), "cannot be packed: no room"),
    "a drift of 1 %": ("stable", faulty(unpack=altered(1.01)), r"texture diffusecolor is .* at \(.*packed again"),
    "a texture that is gone": ("stable", faulty(unpack=forgetful()), "texture diffusecolor is in only one"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_named(name):
    check, target, message = FAULTS[name]
    with pytest.raises(AssertionError, match=message):
        checks(plain(diffusecolor=RAMP), target)[check]()


def test_a_step_of_a_half_is_no_drift():
    checks(plain(diffusecolor=RAMP), faulty(unpack=altered(1 + 2.0**-11)))["stable"]()
