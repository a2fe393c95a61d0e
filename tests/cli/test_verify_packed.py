"""`axffit verify --packed`: faults planted in the files of an exported folder are named, and end in 1."""

import json
from pathlib import Path
from types import SimpleNamespace

import jsonschema
import numpy as np
import pytest

from axffit import axf
from axffit.cli import dispatch
from axffit.quantization.document import schema
from axffit.targets import unity_2018
from axffit.textures import format_named
from axffit.textures.files import CONTAINERS, StoredFile, TextureImage, load, save
from axffit.textures.unorm import linear_to_srgb
from tests.targets import materials

pytestmark = pytest.mark.usefixtures("few_texels")

DIFFUSE, NORMAL = "_SVBRDF_DiffuseColorMap_sRGB", "_SVBRDF_NormalMap"
ROTATION, COLORS = "_SVBRDF_AnisotropicRotationAngleMap", "_CarPaint_BRDFColorMap_sRGB"
FLAKES, LUT = "_CarPaint_BTFFlakesMap_sRGB", "_CarPaint_thetaFI_sliceLUTMap"
SCALE = "_CarPaint_BRDFColorMap_Scale"


def ward():
    return materials.ward(size=8)


def paint():
    return materials.paint(size=8)


class Folder:
    """An exported material: its `material.json`, and its image files as codes."""

    def __init__(self, path: Path):
        self.path = path
        self.content = json.loads((path / "material.json").read_text())

    def entry(self, name):
        return next(entry for entry in self.content["textures"] if entry["name"] == name)

    def codes(self, name):
        entry = self.entry(name)
        files = [StoredFile(**file) for file in entry["files"]]
        shapes = [tuple(level) for level in entry["levels"]]
        return load(self.path, files, CONTAINERS[entry["container"]], entry["format"], shapes).levels

    def store(self, name, levels):
        """Writes codes over those of a texture, into files of the same names."""
        entry = self.entry(name)
        image = TextureImage(entry["format"], tuple(np.ascontiguousarray(level) for level in levels))
        stored = save(self.path, name, image, CONTAINERS[entry["container"]])
        assert [file.file for file in stored] == [file["file"] for file in entry["files"]]

    def encode(self, name, numbers, rounding="nearest_even"):
        """Stores numbers in the texture's own range, one array a level."""
        form = format_named(self.entry(name)["format"])
        levels = []
        for level in numbers:
            full = np.ones((*level.shape[:-1], form.channels))
            full[..., : level.shape[-1]] = level
            levels.append(form.encode(full, rounding))
        self.store(name, levels)

    def decoded(self, name):
        form = format_named(self.entry(name)["format"])
        return [form.decode(level)[..., : self.entry(name)["channels"]] for level in self.codes(name)]

    def save(self):
        (self.path / "material.json").write_text(json.dumps(self.content))


def floor(folder):
    normal = ward().textures["normal"].data.astype(np.float64)
    folder.encode(NORMAL, [0.5 * (normal + 1)], "floor")


def other_range(folder):
    angle = ward().textures["anisrotation"].data.astype(np.float64)
    folder.encode(ROTATION, [(angle / (np.pi / 2) % 2 + 1) % 2 / 2])


def green_red(folder):
    folder.store(NORMAL, [level[..., [1, 0, 2, 3]] for level in folder.codes(NORMAL)])


def srgb(folder):
    folder.encode(DIFFUSE, [linear_to_srgb(level) for level in folder.decoded(DIFFUSE)])


def off_by_one(folder):
    folder.store(LUT, [level + np.uint8(1) for level in folder.codes(LUT)])


def rebuilt(folder):
    levels = folder.decoded(FLAKES)[:1]
    for _ in folder.codes(FLAKES)[1:]:
        d, h, w, c = levels[-1].shape
        levels.append(levels[-1].reshape(d, h // 2, 2, w // 2, 2, c).mean(axis=(2, 4)))
    folder.encode(FLAKES, levels)


def let_through(folder):
    folder.encode(DIFFUSE, [ward().textures["diffusecolor"].data])


def uncounted(folder):
    folder.entry(DIFFUSE)["counts"] |= {"clamped": 0, "excess": 0.0}


def unscaled(folder):
    assert folder.content["values"][SCALE] == pytest.approx(2.5, rel=0.01)
    folder.content["values"][SCALE] = 1.0


def cut_off(folder):
    folder.content["values"][SCALE] = 1.0
    folder.encode(COLORS, [np.clip(paint().textures["brdfcolors"].data, 0.0, 1.0)])


EIGHT_BITS = ("--texture-format", "brdfcolors=RGBA8_UNORM_SRGB")
PLANTED = {
    "floor instead of round": (ward, (), floor, "floor_rounding", NORMAL),
    "an angle over the other target's range": (ward, (), other_range, "range_of_another_target", ROTATION),
    "G and R swapped in a normal map": (ward, (), green_red, "channels_swapped", NORMAL),
    "an sRGB curve on a linear map": (ward, (), srgb, "srgb_curve", DIFFUSE),
    "a slice table off by one": (paint, (), off_by_one, "lut_off_by_one", LUT),
    "mips rebuilt": (paint, (), rebuilt, "mips_rebuilt", FLAKES),
    "negatives let through": (ward, (), let_through, "negatives_let_through", DIFFUSE),
    "negatives clamped and not counted": (ward, (), uncounted, "negatives_uncounted", DIFFUSE),
    "a scale left at 1 beside a divided texture": (paint, EIGHT_BITS, unscaled, "scale_left_at_one", SCALE),
    "a scale left at 1 and the texture cut off": (paint, EIGHT_BITS, cut_off, "scale_left_at_one", SCALE),
}


@pytest.fixture
def exported(tmp_path, capsys):
    """A function that writes a material and exports it: its file, the folder of the export and its own in it."""

    def make(material, *options):
        file, out = tmp_path / f"{material.id}.axf", tmp_path / "out"
        axf.write(file, material)
        assert dispatch(["export", str(file), "--out", str(out), *options]) == 0
        capsys.readouterr()
        return SimpleNamespace(file=file, out=out, folder=Folder(out / material.id))

    return make


@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_fault_is_named(name, exported, tmp_path, capsys):
    make, options, plant, fault, subject = PLANTED[name]
    place = exported(make(), *options)
    plant(place.folder)
    place.folder.save()
    verdicts = tmp_path / "verdicts.json"
    assert dispatch(["verify", str(place.file), "--packed", str(place.out), "--json", str(verdicts)]) == 1
    shown = capsys.readouterr().out
    assert f"OUTSIDE: fault.{fault}: {subject}: " in shown
    document = json.loads(verdicts.read_text())
    jsonschema.validate(document, schema())
    (entry,) = document["materials"]
    assert entry["packed"] == str(place.folder.path)
    verdict = entry["verdict"]
    assert [(each["fault"], each["subject"]) for each in verdict["faults"]] == [(fault, subject)]
    assert not verdict["within"]
    assert verdict["failures"][0].startswith(f"fault.{fault}: {subject}: ")
    assert f"fault.{fault}" in verdict["summary"]


@pytest.mark.parametrize(("make", "options"), [(ward, ()), (paint, ("--format", "ktx2"))])
def test_what_was_exported_is_judged_as_if_packed_here(make, options, exported, tmp_path, capsys):
    place = exported(make(), *options)
    results = [tmp_path / name for name in ("packed.json", "here.json")]
    assert dispatch(["verify", str(place.file), "--packed", str(place.out), "--json", str(results[0])]) == 0
    assert dispatch(["verify", str(place.file), "--json", str(results[1])]) == 0
    packed, here = (json.loads(path.read_text())["materials"][0]["verdict"] for path in results)
    assert packed == here


def test_textures_of_one_engine_read_by_another(exported, capsys):
    place = exported(ward())
    assert dispatch(["verify", str(place.file), "--packed", str(place.folder.path), "--read-by", "hdrp_10"]) == 1
    shown = capsys.readouterr().out.splitlines()
    assert shown[0] == "synthetic Ward, packed for unity_2018, read by hdrp_10"
    assert [line for line in shown if line.startswith("OUTSIDE: mismatch: _SVBRDF_AnisoRotationMap")]
    assert "ward packed for unity_2018, read by hdrp_10: " in shown[-1]


def test_materials_find_their_folder_by_id_or_by_name(exported, tmp_path, capsys):
    place = exported(ward())
    both = tmp_path / "both.axf"
    axf.write(both, axf.AxfFile((ward(), paint())))
    assert dispatch(["verify", str(both), "--packed", str(place.out), "--material", "ward"]) == 0
    assert dispatch(["verify", str(both), "--packed", str(place.out)]) == 2
    assert "holds no material 'paint' of" in capsys.readouterr().err
    # Another program may have called it otherwise.
    place.folder.content["material"]["id"] = "Ward_01"
    place.folder.save()
    assert dispatch(["verify", str(both), "--packed", str(place.out), "--material", "ward"]) == 0
    assert dispatch(["verify", str(place.file), "--packed", str(place.out)]) == 2
    assert "it holds 'Ward_01'; choose with --material" in capsys.readouterr().err
    assert dispatch(["verify", str(both), "--packed", str(place.out), "--material", "paint"]) == 2
    assert "is packed as a SVBRDF, but paint is a CarPaint2" in capsys.readouterr().err


def no_folder(place):
    return place.out / "gone"


def target_too(place):
    return place.out, "--target", "unity_2018"


def twice(place):
    copy = place.out / "copy"
    copy.mkdir()
    for file in place.folder.path.iterdir():
        (copy / file.name).write_bytes(file.read_bytes())
    return place.out


def cut_short(place):
    (place.folder.path / f"{NORMAL}.png").write_bytes(b"\x89PNG")
    return place.out


def list_for_a_number(place):
    place.folder.content["values"]["_SVBRDF_heightMapMax_mm"] = [1.0, 2.0]
    place.folder.save()
    return place.out


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (no_folder, "gone: no such folder"),
        (target_too, "--target and --packed-for have no place"),
        (twice, "copy and ward both hold 'ward'"),
        (cut_short, f"{NORMAL}.png"),
        (list_for_a_number, "material.json: cannot be read as unity_2018"),
    ],
)
def test_a_folder_that_cannot_be_used_is_named(make, says, exported, capsys):
    place = exported(ward())
    found = make(place)
    folder, *more = found if isinstance(found, tuple) else (found,)
    assert dispatch(["verify", str(place.file), "--packed", str(folder), *more]) == 2
    assert says in capsys.readouterr().err


def test_the_files_themselves_are_what_is_planted(exported):
    """The helper of these tests reads and writes codes as the export did."""
    place = exported(ward())
    packed = unity_2018.pack(ward())
    assert np.array_equal(place.folder.codes(NORMAL)[0], packed.textures[NORMAL].levels[0])
    before = (place.folder.path / f"{NORMAL}.png").read_bytes()
    place.folder.store(NORMAL, place.folder.codes(NORMAL))
    assert (place.folder.path / f"{NORMAL}.png").read_bytes() == before
