"""Passivity: whether a BRDF reflects more light than it receives."""

from collections.abc import Sequence
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np

from axffit.brdf import AbstractBRDF, ClearCoat, Sum
from axffit.frames import dot
from axffit.hemisphere import sample_cosine
from axffit.numerics import normalize
from axffit.testing.batches import Rays, evaluate, pdf, sample, viewers
from axffit.testing.failures import vector
from axffit.testing.structure import refraction, tilt

STANDARD_ERRORS = 5.0
"""How many standard errors above 1 the estimate of an albedo must lie to count."""

MOST_VIEWERS = 8


@dataclass(frozen=True)
class Passivity:
    """How much of the light a BRDF sends to each viewer.

    Attributes:
        wo: viewers, (n, 3).
        albedo: integral of f cos over the light directions, the coat's mirror reflection included, (n, 3).
        standard_error: of ``albedo``, which is estimated by draws, (n, 3).
        unenforceable: why an albedo above 1 breaks no law here, or None.
    """

    wo: np.ndarray
    albedo: np.ndarray
    standard_error: np.ndarray
    unenforceable: str | None

    @property
    def largest(self) -> float:
        """The largest albedo of all viewers and channels."""
        return float(np.max(self.albedo))

    @property
    def worst(self) -> int:
        """Index of the viewer that sees it."""
        return int(np.argmax(np.max(self.albedo, axis=1)))

    @property
    def is_passive(self) -> bool:
        """Whether no albedo is above 1 by more than chance."""
        return bool(np.all(self.albedo - STANDARD_ERRORS * self.standard_error <= 1.0 + 1e-9))

    def __str__(self) -> str:
        """The largest albedo and where it is seen."""
        index = self.worst
        channel = int(np.argmax(self.albedo[index]))
        error = self.standard_error[index, channel]
        return f"albedo {self.albedo[index, channel]:.4f} +- {error:.4f} seen from wo = {vector(self.wo[index])}"


def passivity_report(brdf: AbstractBRDF, wo: Rays, *, count: int = 4096, seed: int = 0) -> Passivity:
    """Directional albedos of ``brdf``.

    Half of the draws are the BRDF's own and half cosine-distributed, weighted by the density of the mixture, so that
    neither a narrow lobe nor a broad rest is missed.

    Args:
        brdf: one BRDF.
        wo: viewers (..., 3); at most 8 of those above the horizon, evenly spread over the list, are used.
        count: draws a viewer.
        seed: of the draws.
    """
    chosen = viewers(wo, MOST_VIEWERS)
    half = count // 2
    u = np.random.default_rng(seed).random((2 * half, 3)).astype(chosen.dtype)
    cosine_drawn = np.asarray(sample_cosine(jnp.asarray(u[half:, 1:])))
    albedo, error = np.empty(chosen.shape), np.empty(chosen.shape)
    for index, o in enumerate(chosen):
        viewer = np.broadcast_to(o, u.shape)
        wi = np.concatenate([sample(brdf, viewer[:half], u[:half]), cosine_drawn])
        cosine = np.maximum(wi[:, 2], 0)
        density = 0.5 * (pdf(brdf, wi, viewer) + cosine / np.pi)
        weight = np.divide(cosine, density, out=np.zeros_like(density), where=density > 0)
        estimates = (evaluate(brdf, wi, viewer) * weight[:, None]).reshape(2, half, 3)
        albedo[index] = estimates.mean(axis=(0, 1))
        # A stratum each for the two kinds of draws, whose means differ.
        error[index] = np.sqrt(np.sum(estimates.var(axis=1) / half, axis=0)) / 2
    albedo += _mirrored(brdf, chosen)
    return Passivity(chosen, albedo, error, gains(brdf) or tilt(brdf))


def gains(brdf: AbstractBRDF) -> str | None:
    """Why ``brdf`` may reflect more than it receives although nothing is wrong with it; None if it may not."""
    coat = refraction(brdf)
    return None if coat is None else f"a coat of index {float(coat.ior):.4g} refracts, without a 1/n² radiance factor"


def mean(reports: Sequence[Passivity]) -> Passivity:
    """Of a surface, from places on it and the same viewers: a texel may send out what its neighbor received."""
    albedo = np.mean([report.albedo for report in reports], axis=0)
    error = np.sqrt(np.sum([report.standard_error**2 for report in reports], axis=0)) / len(reports)
    return Passivity(reports[0].wo, albedo, error, None)


def passivity(brdf: AbstractBRDF, wi: Rays, wo: Rays) -> None:
    """No more light leaves than arrives: every viewer's albedo, the coat's mirror included, is at most 1.

    Enforced only where it is a law: not below a coat that refracts, which gains up to n², and not for a tilted shading
    normal, whose facet is not the plane the light falls on (:func:`passivity_report` says what it is there). Broken by
    colors above 1, and by ``"sdk"`` lobes weighted as if their albedo were not 4.
    """
    demand_passive(passivity_report(brdf, wo))


def demand_passive(report: Passivity) -> None:
    """Raise ``AssertionError`` if the law is one for the BRDF of the report, and is broken."""
    if report.unenforceable is None and not report.is_passive:
        raise AssertionError(f"passivity: {report} is above 1")


def _mirrored(brdf: AbstractBRDF, wo: np.ndarray) -> np.ndarray:
    """Share of the light that coats reflect as mirrors, which ``evaluate`` leaves out, (n, 3)."""
    match brdf:
        case Sum():
            return sum((_mirrored(term, wo) for term in brdf.terms), np.zeros_like(wo))
        case ClearCoat() if brdf.mirror_roughness is None:
            coat = brdf.astype(jnp.dtype(wo.dtype))
            assert isinstance(coat, ClearCoat)
            above = dot(jnp.asarray(wo), normalize(coat.normal)[None]) > 0
            share = [coat.mirror(jnp.asarray(v))[1] for v in wo]
            return np.where(np.asarray(above)[:, None], np.stack(share), 0.0)
    return np.zeros_like(wo)
