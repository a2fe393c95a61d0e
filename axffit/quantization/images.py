"""Errors of pictures: what an eye, and a plain sum of squares, make of a picture before and after.

Pictures are (H, W, 3) as a display takes them: sRGB values (IEC 61966-2-1, transfer curve included) in [0, 1], not
rounded to 8 bits, so that an error below one step of a display still has a number. The measures:

- FLIP (Andersson et al. 2020, "A difference evaluator for alternating images"), by its authors' own package, for
  low dynamic range and 67 pixels a degree: 0 is equal, 1 the largest difference, about what one sees when flipping
  between the two;
- dE2000 (CIE 142-2001) pixel by pixel under D65, by colour-science;
- PSNR = -10 log10(mean (a - b)²) in decibels, the mean over pixels and channels.
"""

import importlib.util
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import InputError
from .measures import has_color_science

PIXELS_PER_DEGREE = 67.0
"""FLIP's default viewer: 0.7 m before a 4K display 0.7 m wide."""

PERCENTILE = 0.99
"""What `ImageErrors` states beside mean and maximum: all but the worst hundredth of the pixels."""


@dataclass(frozen=True)
class Summary:
    """One measure over the pixels of a picture."""

    mean: float
    p99: float
    max: float


@dataclass(frozen=True, eq=False)
class ImageErrors:
    """How far two pictures differ.

    Attributes:
        pixels: how many were judged.
        flip: FLIP, or None without the package flip-evaluator.
        delta_e_2000: dE2000, or None without colour-science.
        psnr: in decibels; infinite for equal pictures.
        flip_map: FLIP of every pixel (H, W), or None.
        delta_e_map: dE2000 of every pixel (H, W), or None.
    """

    pixels: int
    flip: Summary | None
    delta_e_2000: Summary | None
    psnr: float
    flip_map: np.ndarray | None
    delta_e_map: np.ndarray | None

    def to_json(self) -> dict[str, Any]:
        """The numbers; what was not measured, and the infinite PSNR of equal pictures, is null."""

        def numbers(summary: Summary | None) -> dict[str, float] | None:
            return None if summary is None else {"mean": summary.mean, "p99": summary.p99, "max": summary.max}

        return {
            "pixels": self.pixels,
            "flip": numbers(self.flip),
            "delta_e_2000": numbers(self.delta_e_2000),
            "psnr_db": self.psnr if np.isfinite(self.psnr) else None,
        }


def has_flip() -> bool:
    """Whether the optional package flip-evaluator is installed."""
    return importlib.util.find_spec("flip_evaluator") is not None


def image_errors(before: np.ndarray, after: np.ndarray, judged: np.ndarray | None = None) -> ImageErrors:
    """FLIP, dE2000 and PSNR of two pictures.

    Args:
        before: the reference, sRGB values in [0, 1], (H, W, 3).
        after: the other picture, of the same shape.
        judged: (H, W) booleans, the pixels that count, such as those an object covers; None takes all. FLIP still
            sees the whole pictures, since it filters over neighbors.

    Raises:
        InputError: shapes that differ, values outside [0, 1], or no pixel to judge.
    """
    before, after = _checked(before, "before"), _checked(after, "after")
    if before.shape != after.shape:
        raise InputError(f"pictures of shapes {before.shape} and {after.shape}: render both at one size")
    judged = np.ones(before.shape[:2], bool) if judged is None else np.asarray(judged, bool)
    if judged.shape != before.shape[:2] or not judged.any():
        raise InputError(
            f"judged pixels {judged.shape}, {int(judged.sum())} of them set: give booleans of shape "
            f"{before.shape[:2]} with at least one set"
        )
    flip = flip_map(before, after) if has_flip() else None
    delta_e = delta_e_map(before, after) if has_color_science() else None
    return ImageErrors(
        pixels=int(judged.sum()),
        flip=None if flip is None else _summary(flip[judged]),
        delta_e_2000=None if delta_e is None else _summary(delta_e[judged]),
        psnr=psnr(before[judged], after[judged]),
        flip_map=flip,
        delta_e_map=delta_e,
    )


def flip_map(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """FLIP of every pixel (H, W), 0 to 1, of sRGB pictures in [0, 1].

    Raises:
        ImportError: flip-evaluator is not installed (`has_flip`).
    """
    import flip_evaluator

    reference, test = (np.ascontiguousarray(picture, np.float32) for picture in (before, after))
    options = {"inputsRGB": True, "applyMagma": False, "computeMeanError": False}
    # Without its color map the package repeats the error on three channels.
    errors, _, _ = flip_evaluator.evaluate(reference, test, "LDR", **options, parameters={"ppd": PIXELS_PER_DEGREE})
    errors = np.asarray(errors, np.float64)
    return errors[..., 0] if errors.ndim == 3 else errors


def delta_e_map(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """dE2000 under D65 of every pixel (H, W) of sRGB pictures in [0, 1].

    Raises:
        ImportError: colour-science is not installed (`has_color_science`).
    """
    import colour

    white = colour.RGB_COLOURSPACES["sRGB"].whitepoint
    lab = [colour.XYZ_to_Lab(colour.sRGB_to_XYZ(picture), white) for picture in (before, after)]
    return np.asarray(colour.delta_E(lab[0], lab[1], method="CIE 2000"))


def psnr(before: np.ndarray, after: np.ndarray) -> float:
    """-10 log10(mean (a - b)²), in decibels, of values whose peak is 1; infinite where they are equal."""
    squared = float(np.mean((np.asarray(before, np.float64) - after) ** 2))
    return float("inf") if squared == 0.0 else -10.0 * float(np.log10(squared))


def _checked(picture: np.ndarray, name: str) -> np.ndarray:
    values = np.asarray(picture)
    if values.ndim != 3 or values.shape[2] != 3 or values.dtype.kind != "f":
        raise InputError(f"{name}: {values.dtype} {values.shape}; give floats of shape (H, W, 3)")
    if not np.all((values >= 0.0) & (values <= 1.0)):
        raise InputError(f"{name}: values from {values.min():g} to {values.max():g}; give sRGB values in [0, 1]")
    return values.astype(np.float64)


def _summary(values: np.ndarray) -> Summary:
    return Summary(float(values.mean()), float(np.quantile(values, PERCENTILE)), float(values.max()))
