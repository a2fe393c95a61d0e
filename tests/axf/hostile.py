"""Seeded hostile .axf files: HDF5 made to be odd, and files with changed bytes.

`make(number)` gives the same bytes on every run: even numbers are HDF5 built through h5py's low-level interface with
AxF's names and unusual types, layouts and links; odd numbers are such files, or one that axffit wrote, with bytes
changed, cut or moved, half of the changes near the file's own structures.
"""

import random
import re
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from axffit import axf

_NAMES = [
    *("DiffuseModel", "SpecularModel", "ClearCoat", "CarPaintModel", "TransparencyFilter", "com.xrite.Resources"),
    *("com.xrite.Representations", "axffit.Material", "Metadata", "Properties", "Color", "Normal", "Lobes", "Fresnel"),
    *("Color_1", "Lobes_1", "IOR", "Data", "WidthMM", "HeightMM", "Level1", "Wavelengths", "CT_diffuse", "CT_coeffs"),
    *("CT_F0s", "CT_spreads", "thetaFI_sliceLUT", "max_thetaI", "num_thetaF", "num_thetaI", "cc_no_refraction"),
    *("BRDFcolors", "BTFflakes", "Preview", "Id", "Name", "Class", "TypeKey", "Variant", "Textures", "BTF", "note"),
]
_TEXTS = [b"com.xrite.GGXSpecularModel", b"com.xrite.WardSpecularModel", b"Duer2006", b"SVBRDF", b"CarPaint2", b"\xff"]
_SHAPES = [(), (1,), (3,), (31,), (0,), (1, 1, 3), (2, 2, 1), (4, 3, 3), (2, 2, 31), (2, 2, 2, 3), (5, 4), (2, 2, 0, 3)]
_FILTERS: list[dict[str, Any]] = [
    {},
    {"compression": "gzip"},
    {"compression": "lzf"},
    {"shuffle": True, "fletcher32": True},
]
_SIGNATURES = re.compile(rb"OHDR|OCHK|TREE|SNOD|HEAP|GCOL|FRHP|FHDB|FHIB|BTHD|BTLF|BTIN|FSHD|FADB|EAHD|\x89HDF")


def make(number: int, folder: Path) -> bytes:
    """The hostile file of that number; ``folder`` takes its first draft."""
    chance = random.Random(number)
    if number % 2 == 0:
        return _odd(chance, folder / "odd.h5")
    return _changed(chance, _written(chance, folder) if chance.random() < 0.3 else _odd(chance, folder / "odd.h5"))


def _changed(chance: random.Random, content: bytes) -> bytes:
    """The content with some bytes changed, cut or moved."""
    data = bytearray(content)
    places = [found.start() for found in _SIGNATURES.finditer(content)]
    for _ in range(chance.choice([1, 1, 2, 4, 16])):
        if places and chance.random() < 0.6:
            at = min(chance.choice(places) + chance.randrange(160), len(data) - 1)
        else:
            at = chance.randrange(len(data))
        change = chance.random()
        if change < 0.85:
            data[at] = chance.choice(
                [0, 1, 127, 128, 255, data[at] ^ (1 << chance.randrange(8)), chance.randrange(256)]
            )
        elif change < 0.95:
            length = chance.randrange(1, 64)
            source = chance.randrange(len(data))
            piece = data[source : source + length]
            data[at : at + len(piece)] = piece
        else:
            width = chance.choice([4, 8])
            data[at : at + width] = chance.choice([0, 2**31 - 1, 2**32 - 1, len(data)]).to_bytes(width, "little")
    if chance.random() < 0.05:
        del data[chance.randrange(1, len(data)) :]
    return bytes(data)


def _written(chance: random.Random, folder: Path) -> bytes:
    """A file of axffit's own writer."""
    rng = np.random.default_rng(chance.randrange(8))

    def texture(*shape: int) -> axf.AxfTexture:
        return axf.AxfTexture((rng.random(shape).astype(np.float32),), 1.0, 1.0)

    paint = axf.AxfMaterial(
        "paint",
        "paint",
        axf.MaterialKind.CAR_PAINT,
        specular_model="CookTorrance",
        textures={"brdfcolors": texture(4, 4, 3)},
        properties={"CT_diffuse": 0.2, "CT_coeffs": [0.1], "CT_F0s": [0.1], "CT_spreads": [0.2], "IOR": 1.5},
    )
    cloth = axf.AxfMaterial(
        "cloth",
        "cloth",
        axf.MaterialKind.SVBRDF,
        anisotropic=True,
        textures={"diffusecolor": texture(12, 12, 3), "specularlobe": texture(3, 3, 2)},
        metadata={"note": "hostile"},
    )
    path = folder / "written.axf"
    axf.write(path, axf.AxfFile((paint, cloth) if chance.random() < 0.5 else (cloth,)))
    return path.read_bytes()


def _odd(chance: random.Random, path: Path) -> bytes:
    """HDF5 below AxF's own groups, of any type, layout, filter and link."""
    path.unlink(missing_ok=True)
    options: dict[str, Any] = {"libver": chance.choice(["earliest", ("earliest", "v110"), "latest"])}
    if chance.random() < 0.05:
        options["userblock_size"] = 512
    with h5py.File(path, "w", **options) as file:
        if chance.random() < 0.8:
            for part in ("major", "minor", "revision"):
                file.attrs[f"axf.version.{part}"] = np.uint32(1) if chance.random() < 0.97 else np.float32(-1.5)
        if chance.random() < 0.2:
            file.attrs["axffit.version"] = b"1"
        root = file.create_group("com.xrite.Materials", track_order=chance.random() < 0.3)
        for number in range(chance.choice([0, 1, 1, 1, 2])):
            material = root.create_group(f"m{number}")
            if chance.random() < 0.7:
                material["com.xrite.Resources/DiffuseModel/Color/Data"] = _numbers(chance, (2, 2, 3))
            _fill(chance, material, chance.randrange(1, 14), 0)
    return path.read_bytes()


def _fill(chance: random.Random, group: h5py.Group, count: int, depth: int) -> None:
    for _ in range(count):
        name = chance.choice(_NAMES) + chance.choice(["", "", "", "_1", "é"])
        if name in group:
            continue
        kind = chance.random()
        if kind < 0.25 and depth < 5:
            _fill(chance, group.create_group(name, track_order=chance.random() < 0.2), chance.randrange(4), depth + 1)
        elif kind < 0.35:
            _link(chance, group, name)
        elif kind < 0.5:
            holder = group if not len(group) else group[chance.choice(list(group))] if _real(group) else group
            for index in range(chance.choice([1, 1, 3, 12])):
                _attribute(chance, holder, f"{name}{index}")
        else:
            _dataset(chance, group, name)


def _real(group: h5py.Group) -> bool:
    return all(isinstance(group.get(name, getlink=True), h5py.HardLink) for name in group)


def _link(chance: random.Random, group: h5py.Group, name: str) -> None:
    kind = chance.random()
    if kind < 0.5:
        group[name] = h5py.SoftLink(chance.choice(["/", ".", name, "/com.xrite.Materials", "/nowhere/a"]))
    elif kind < 0.8:
        group[name] = chance.choice([group, group.file["/"], group.parent])
    elif kind < 0.98:
        group[name] = np.dtype([("x", "f4"), ("y", "i8")])
    else:
        group[name] = h5py.ExternalLink("/nowhere.h5", "/x")


def _type(chance: random.Random) -> Any:
    return chance.choice(
        [
            *("f4", "f4", "f4", "f2", "f8", ">f4", "i4", "u1", "u8", ">i2", "c8", "bool", "S7", "V5"),
            h5py.string_dtype(),
            h5py.string_dtype("ascii"),
            h5py.string_dtype("utf-8", 9),
            h5py.vlen_dtype(np.float32),
            h5py.enum_dtype({"A": 0, "B": 1}, basetype="i1"),
            h5py.ref_dtype,
            h5py.regionref_dtype,
            np.dtype([("x", "f4"), ("y", "S3"), ("z", "i2", (2,))]),
            np.dtype([("t", h5py.string_dtype()), ("v", "f8")]),
            np.dtype([("r", h5py.ref_dtype), ("v", "u2")]),
            np.dtype(("f4", (3,))),
        ]
    )


def _numbers(chance: random.Random, shape: tuple[int, ...]) -> np.ndarray:
    values = np.random.default_rng(chance.randrange(2**32)).random(shape).astype(np.float32)
    special = chance.random()
    if values.size and special < 0.1:
        values.reshape(-1)[0] = chance.choice([np.nan, np.inf, -1.0, 1e38, 300.0])
    return values


def _content(chance: random.Random, group: h5py.Group, dtype: Any, shape: tuple[int, ...]) -> Any:
    """Values of the type, or None for none."""
    dtype = np.dtype(dtype)
    if h5py.check_string_dtype(dtype) is not None:
        return np.full(shape, chance.choice(_TEXTS), object if dtype.kind == "O" else dtype)
    if h5py.check_ref_dtype(dtype) is h5py.Reference:
        values = np.empty(shape, dtype)
        values[...] = group.ref
        return values
    if dtype.kind in "fiu" and dtype.names is None and h5py.check_enum_dtype(dtype) is None:
        with np.errstate(all="ignore"):
            return (_numbers(chance, shape) * chance.choice([1, 1, 5, 100])).astype(dtype)
    return None


def _dataset(chance: random.Random, group: h5py.Group, name: str) -> None:
    dtype, shape = _type(chance), chance.choice(_SHAPES)
    options: dict[str, Any] = {}
    if shape and 0 not in shape and chance.random() < 0.4:
        options["chunks"] = tuple(chance.randrange(1, n + 1) for n in shape)
        if np.dtype(dtype).kind in "fiu":
            options |= chance.choice(_FILTERS)
        if chance.random() < 0.3:
            options["maxshape"] = (None, *shape[1:])
    rare = chance.random()
    if rare < 0.005:
        group.create_dataset(name, shape or (1,), "f4", external=[("/nowhere.raw", 0, 4 * max(1, int(np.prod(shape))))])
    elif rare < 0.01:
        virtual = h5py.VirtualLayout((2, 2, 3), "f4")
        virtual[0] = h5py.VirtualSource("/nowhere.h5", "data", (2, 3))
        group.create_virtual_dataset(name, virtual)
    elif rare < 0.02:
        huge = chance.choice([(2**20, 2**20, 3), (2**40,), (30_000, 30_000, 3)])
        group.create_dataset(name, huge, "f4", chunks=tuple(min(n, 64) for n in huge))
    elif rare < 0.05:
        group.create_dataset(name, data=h5py.Empty("f4"))
    elif rare < 0.08:
        space = h5py.h5s.create_simple((2, 2, 3))
        properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        properties.set_layout(h5py.h5d.COMPACT)
        kind = chance.choice([h5py.h5t.STD_B8LE, h5py.h5t.IEEE_F32BE, h5py.h5t.STD_U64LE])
        h5py.h5d.create(group.id, name.encode(), kind, space, properties)
    else:
        content = _content(chance, group, dtype, shape)
        if content is None or chance.random() < 0.1:
            group.create_dataset(name, shape, dtype, **options)
        else:
            group.create_dataset(name, shape, dtype, data=content, **options)


def _attribute(chance: random.Random, holder: Any, name: str) -> None:
    dtype, shape = _type(chance), chance.choice([(), (1,), (3,), (40,)])
    content = _content(chance, holder if isinstance(holder, h5py.Group) else holder.parent, dtype, shape)
    holder.attrs.create(
        name, h5py.Empty("f4") if content is None else content, dtype=None if content is None else dtype
    )
