import dataclasses
import json

import jsonschema
import numpy as np
import pytest

from axffit import axf
from axffit.axf.difference import schema
from axffit.cli import dispatch
from axffit.synthesis import metallic_paint

PAINT = metallic_paint(64)
BARELY = dataclasses.replace(
    PAINT, properties={**PAINT.properties, "IOR": np.nextafter(np.float32(1.5), np.float32(2))}
)


@pytest.fixture
def files(tmp_path):
    paths = []
    for name, material in (("a", PAINT), ("b", BARELY)):
        paths.append(str(tmp_path / f"{name}.axf"))
        axf.write(paths[-1], axf.AxfFile((material,)))
    return paths


def test_the_same(files, capsys):
    assert dispatch(["diff", files[0], files[0]]) == 0
    assert "the same, bit for bit" in capsys.readouterr().out


def test_the_last_bit_of_a_property_shows(files, tmp_path, capsys):
    assert dispatch(["diff", *files, "--json", str(tmp_path / "d.json")]) == 1
    (line,) = (line for line in capsys.readouterr().out.splitlines() if "IOR" in line)
    assert line.split() == ["property", "IOR", "1.5", "1.50000012"]
    content = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))
    jsonschema.validate(content, schema(), cls=jsonschema.Draft202012Validator)


def test_materials_of_other_names(tmp_path, capsys):
    path = tmp_path / "two.axf"
    axf.write(path, axf.AxfFile((PAINT, dataclasses.replace(PAINT, id="second"))))
    chosen = ["--material", "metallic_paint", "--other-material", "second"]
    assert dispatch(["diff", str(path), str(path), *chosen]) == 1
    (line,) = (line for line in capsys.readouterr().out.splitlines() if line.startswith("id"))
    assert line.split() == ["id", "metallic_paint", "second"]
    assert dispatch(["diff", str(path), str(path), "--material", "third"]) == 2
    assert "third" in capsys.readouterr().err
