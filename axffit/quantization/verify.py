"""`verify`: pack a material for a target, read it back, and compare at every level."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import ModuleType

import jax
import numpy as np

from ..axf import AxfMaterial, AxfTexture, MaterialKind
from ..errors import InputError
from ..targets import PackedMaterial, PackedTexture, Problem, target_named
from ..targets.encoding import decode_rows
from ..targets.table import SLICE_TABLE
from . import diagnosis, mismatch
from .brdf_error import brdf_errors
from .brdf_verdict import BrdfVerdict
from .diagnosis import Fault
from .expected import Lighting
from .maps import MapErrors, map_errors
from .material_bounds import MaterialBounds, material_bounds
from .measures import has_color_science
from .samples import sample_texels
from .slice_lut import lut_json
from .tiles import centers, of_packed_texels, of_texels
from .tolerances import KINDS, Kind, Tolerances, default_tolerances, read_tolerances
from .verdict import Check, LutVerdict, TextureVerdict, Verdict

Progress = Callable[[str, float], None]
"""Called with what is being done and how much of it is (0 to 1)."""

TEXELS = {MaterialKind.SVBRDF: 256, MaterialKind.CAR_PAINT: 32}
"""Texels sampled for the BRDF level; of a car paint only the coat's normal differs between texels."""


def verify(
    material: AxfMaterial,
    target: str = "unity_2018",
    tolerance: Tolerances | Path | str | None = None,
    *,
    packed_for: str | None = None,
    read_by: str | None = None,
    formats: Mapping[str, str] | None = None,
    rounding: str | None = None,
    bounds: bool = True,
    lightings: Sequence[Lighting] = (),
    progress: Progress | None = None,
) -> Verdict:
    """What a target's textures lose of a material, and whether that is within tolerance.

    Args:
        material: the material, in AxF's ranges.
        target: name of the target (`targets.TARGETS`).
        tolerance: limits, or a TOML file of limits; None takes those of the package.
        packed_for: the target whose importer packs, where it is another one; None takes ``target``.
        read_by: the target whose shader reads, where it is another one; None takes ``target``.
        formats: AxF texture name to a number format other than the advised one.
        rounding: rounding mode of the encoders; None takes the target's own.
        bounds: whether the errors of the reflectance are bounded; without, what was found is judged, in less time.
        lightings: for the expected error of the reflectance, beside a uniform one.
        progress: called with what is being done and how much of it is (0 to 1).

    Raises:
        InputError: an unknown target, an unusable tolerance file or material, a format that is not allowed.
    """
    packer, reader = target_named(packed_for or target), read_by or target
    target_named(reader)
    tolerances = _tolerances(tolerance)
    report = progress or (lambda stage, fraction: None)
    report("packing textures", 0.0)
    packed = packer.pack(material, formats=formats, rounding=rounding)
    return verify_packed(
        material, packed, tolerances, read_by=reader, bounds=bounds, lightings=lightings, progress=progress
    )


def verify_packed(
    material: AxfMaterial,
    packed: PackedMaterial,
    tolerances: Tolerances | None = None,
    *,
    read_by: str | None = None,
    bounds: bool = True,
    lightings: Sequence[Lighting] = (),
    progress: Progress | None = None,
) -> Verdict:
    """The same for a material that someone packed: every texture is read as the target's shader would read it.

    Args:
        material: the original.
        packed: its textures and values for a target.
        tolerances: limits; None takes those of the package.
        read_by: the target whose shader reads; None takes the one it was packed for.
        bounds: as in `verify`.
        lightings: as in `verify`.
        progress: as in `verify`.

    Raises:
        InputError: a target is unknown, or the packed material is of another kind.
    """
    if packed.kind is not material.kind:
        raise InputError(
            f"{packed.id}: is packed as a {packed.kind.value}, but {material.id} is a {material.kind.value}"
        )
    packer, module = target_named(packed.target), target_named(read_by or packed.target)
    foreign = module is not packer
    defaults = {t.axf_name: packer.default_values(t.name) for t in packed.textures.values() if t.defaulted}
    packed = mismatch.read_by(material, packed, module.NAME) if foreign else packed
    tolerances = (tolerances or default_tolerances()).for_target(module.NAME)
    report = progress or (lambda stage, fraction: None)
    broken = module.validate(packed)
    problems = [*(mismatch.reader_problems(broken, packed) if foreign else broken), *_lost(material, packed)]
    unreadable = {problem.subject for problem in problems if problem.obligation.startswith("texture.")}
    errors: dict[str, MapErrors] = {}
    readable = [t for t in packed.textures.values() if t.name not in unreadable and t.axf_name != SLICE_TABLE]
    for number, texture in enumerate(readable):
        report("measuring map errors", number / len(readable))
        original = _original(material, texture, defaults)
        apart = tolerances.levels_apart(texture.axf_name)
        errors[texture.name] = map_errors(original, texture, module.reading(texture, packed.values), apart)
    report("measuring map errors", 1.0)
    textures = tuple(
        TextureVerdict.judged(t, module.reading(t, packed.values).formula, errors[t.name], tolerances) for t in readable
    )
    faults: list[Fault] = []
    if foreign:
        problems.extend(mismatch.misread(textures, packer.NAME, module.NAME))
    else:
        outside = {texture.packed.name for texture in textures if not texture.within}
        faults.extend(diagnosis.faults(material, packed, errors, outside))
        faults.extend(_table_faults(material, packed, module))
    return Verdict(
        id=material.id,
        name=material.name,
        kind=material.kind.value,
        target=module.NAME,
        packed_for=packer.NAME,
        textures=textures,
        lut=_lut_verdict(material, packed, module, tolerances),
        brdf=_brdf_verdict(material, packed, module, errors, tolerances, report, lightings, bounds=bounds),
        problems=tuple(problems),
        faults=tuple(faults),
        values=packed.values,
        notes=(*packed.notes, *_missing_measures()),
        tolerances=tolerances.source,
        error_maps={name: e.picture for name, e in errors.items()},
    )


def _tolerances(given: Tolerances | Path | str | None) -> Tolerances:
    if given is None:
        return default_tolerances()
    return given if isinstance(given, Tolerances) else read_tolerances(given)


def _missing_measures() -> tuple[str, ...]:
    if has_color_science():
        return ()
    return ("dE2000 is not measured: it needs colour-science (pip install axffit[color])",)


def _lost(material: AxfMaterial, packed: PackedMaterial) -> Iterator[Problem]:
    """Textures that AxF has and the packed material lacks, or holds in another size; those that AxF has not."""
    by_axf = {texture.axf_name: texture for texture in packed.textures.values()}
    module = target_named(packed.target)
    for name, texture in packed.textures.items():
        if module.texture_name(texture.axf_name, material.kind) != name:
            yield Problem("texture.name", name, f"is said to be AxF's {texture.axf_name}, which has another name here")
        elif not texture.defaulted and texture.axf_name != SLICE_TABLE and texture.axf_name not in material.textures:
            yield Problem("texture.extra", name, f"AxF has no {texture.axf_name}; leave it out, or call it a default")
    for key, original in material.textures.items():
        name = module.texture_name(key, material.kind)
        texture = by_axf.get(key)
        if name is None:
            continue
        if texture is None or texture.defaulted:
            yield Problem("texture.lost", name, f"AxF's {key} is not in the packed material; pack it")
            continue
        shapes = [level.shape[:-1] for level in texture.levels]
        wanted = [level.shape[:-1] for level in original.levels]
        if shapes != wanted:
            yield Problem("texture.shape", name, f"levels of {shapes}; AxF has {wanted}: keep every level and its size")


def _original(material: AxfMaterial, texture: PackedTexture, defaults: Mapping[str, np.ndarray]) -> AxfTexture:
    """AxF's texture; for a default the constant its packer meant, in float64."""
    if not texture.defaulted:
        return material.textures[texture.axf_name]
    values = defaults[texture.axf_name]
    return AxfTexture(tuple(np.broadcast_to(values, (*level.shape[:-1], values.size)) for level in texture.levels))


def _table_faults(material: AxfMaterial, packed: PackedMaterial, module: ModuleType) -> Iterator[Fault]:
    wanted = material.properties.get(SLICE_TABLE)
    table = next((t for t in packed.textures.values() if t.axf_name == SLICE_TABLE), None)
    if wanted is not None and table is not None:
        fault = diagnosis.table_fault(np.asarray(wanted), table, module.reading(table, packed.values))
        yield from () if fault is None else (fault,)


_HALF_DECODE = "half texel, float32 product"


def _lut_verdict(
    material: AxfMaterial, packed: PackedMaterial, module: ModuleType, tolerances: Tolerances
) -> LutVerdict | None:
    wanted = material.properties.get(SLICE_TABLE)
    table = next((t for t in packed.textures.values() if t.axf_name == SLICE_TABLE), None)
    if wanted is None or table is None:
        return None
    found = decode_rows(table.levels[0], module.reading(table, packed.values), table.number_format, 1).reshape(-1)
    entries = np.rint(found[: len(wanted)]).astype(np.int64)
    seen = np.resize(entries, len(wanted)) if entries.size else np.full(len(wanted), -1)
    content = lut_json(np.asarray(wanted))
    wrong = {int(k) for k in wanted[seen != wanted]}
    form = table.number_format
    held = "R8_UINT" if form.is_integer else _HALF_DECODE if form.is_float else "float32"
    lost = {
        rounding: {
            k
            for reading in content["readings"]
            if reading["rounding"] == rounding
            and (reading["decode"] == "R8_UINT") == form.is_integer
            and (rounding == "rounded" or reading["decode"] == held)
            for k in reading["failures_used"]
        }
        for rounding in ("truncated", "rounded")
    }
    checks = tuple(
        Check(f"lut.{rounding}", float(len(slices | wrong)), tolerances.get(f"lut.{rounding}"))
        for rounding, slices in lost.items()
    )
    facts = {"name": table.name, "format": table.format, "wrong": sorted(wrong)}
    return LutVerdict({**facts, **content}, checks)


def _brdf_verdict(
    material: AxfMaterial,
    packed: PackedMaterial,
    module: ModuleType,
    errors: Mapping[str, MapErrors],
    tolerances: Tolerances,
    report: Progress,
    lightings: Sequence[Lighting],
    *,
    bounds: bool,
) -> BrdfVerdict:
    report("measuring the reflectance", 0.0)
    by_axf = {packed.textures[name].axf_name: e for name, e in errors.items()}
    try:
        uv = sample_texels(material, by_axf, TEXELS[material.kind])
        some, seen = of_texels(material, uv), module.unpack(of_packed_texels(packed, material, uv))
        with jax.enable_x64(new_val=True):
            stage = lambda done: report("measuring the reflectance", done)  # noqa: E731
            found = brdf_errors(some, seen, centers(len(uv)), stage, lightings)
        proved = MaterialBounds((), 0, "left out on request")
        if bounds:
            report("bounding the reflectance", 0.0)
            largest: dict[Kind, float] = {kind: getattr(found, kind).value for kind in KINDS}
            proved = material_bounds(material, packed, largest, lambda done: report("bounding the reflectance", done))
    except InputError as error:
        return BrdfVerdict(None, None, (), str(error))
    return BrdfVerdict.judged(found.placed(uv), proved, tolerances)
