"""Light reflected at one point: the integral of f L cos over the hemisphere, and the mirror of a coat."""

import jax.numpy as jnp
import numpy as np

from axffit._types import RGB, Direction
from axffit.brdf import AbstractBRDF, ClearCoat
from axffit.frames import dot, reflect, tangent_frame, to_local, to_world
from axffit.numerics import normalize
from axffit.preview.environment import AbstractEnvironment
from axffit.preview.sampling import (
    Samples,
    lobe_density,
    sample_cosine,
    sample_visible_lobe,
)


def reflected_radiance(
    brdf: AbstractBRDF, environment: AbstractEnvironment, frame, wo: Direction, lobe_normal: Direction, samples: Samples
) -> RGB:
    """Radiance towards the viewer at one point of a surface, linear RGB (3,).

    Args:
        brdf: the reflectance at the point.
        environment: what the point sees; nothing shadows it.
        frame: (3, 3), rows tangent, bitangent and normal in the scene.
        wo: unit direction to the viewer in that frame, wo_z > 0.
        lobe_normal: (3,) where the lobes stand, in that frame: a guess that only steers the samples.
        samples: how many samples, and where.
    """
    lobe_frame = tangent_frame(lobe_normal)
    view = to_local(lobe_frame, wo)
    # Lower views only steer the samples as if they were this high.
    view = normalize(view.at[2].set(jnp.maximum(view[2], 0.02)))
    drawn = [to_world(lobe_frame[None], sample_visible_lobe(view, r, samples.lobe)) for r in samples.lobe_roughness]
    drawn.append(sample_cosine(samples.cosine))
    drawn.extend(to_local(frame[None], light.sample(samples.light)) for light in environment.lights)
    wi = jnp.concatenate(drawn)

    in_scene, in_lobe = to_world(frame[None], wi), to_local(lobe_frame[None], wi)
    cosine = jnp.maximum(wi[:, 2], 0.0)
    densities = [lobe_density(in_lobe, view, roughness) for roughness in samples.lobe_roughness]
    densities.append(cosine / jnp.pi)
    densities.extend(light.density(in_scene) for light in environment.lights)
    counts = [len(x) for x in drawn]
    expected = [count * density for count, density in zip(counts, densities, strict=True)]
    starts = np.cumsum([0, *counts])
    own = jnp.concatenate([x[starts[k] : starts[k + 1]] for k, x in enumerate(expected)])
    weight = cosine * own / jnp.maximum(sum(x * x for x in expected), 1e-20)
    value = brdf.evaluate(wi, jnp.broadcast_to(wo, wi.shape)) * environment.radiance(in_scene)
    return jnp.sum(value * weight[:, None], axis=0)


def mirrored_radiance(brdf: AbstractBRDF, environment: AbstractEnvironment, frame, wo: Direction) -> RGB:
    """The coat's mirror term, linear RGB (3,): coat Fresnel × the surroundings seen in the coat; 0 without a coat.

    A coat that is offered as a narrow lobe (``mirror_roughness``) is part of ``brdf.evaluate`` and adds nothing here.
    """
    if not isinstance(brdf, ClearCoat) or brdf.mirror_roughness is not None:
        return jnp.zeros_like(wo)
    normal = brdf.normal / jnp.sqrt(dot(brdf.normal, brdf.normal))
    cosine = dot(wo, normal)
    mirrored = reflect(wo, normal)
    # A tilted coat may mirror the view to below the surface; the horizon is what it would show.
    mirrored = mirrored.at[2].set(jnp.maximum(mirrored[2], 0.0))
    seen = environment.radiance(to_world(frame, mirrored))
    reflectance = brdf.color * brdf.reflectance(jnp.maximum(cosine, 1e-4))
    return jnp.where(cosine > 0.0, reflectance * seen, 0.0)
