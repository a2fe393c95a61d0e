"""Named parameters with standard errors of several colored lobes."""

import numpy as np

from axffit.fitting.estimates import Estimates, LinearEstimator, channel_name
from axffit.fitting.models import ROUGHNESS_BOUNDS, Shapes
from axffit.fitting.multilobe import LobesModel
from axffit.fitting.separable import SeparableProblem, Weights
from axffit.fitting.uncertainty import parameter_covariance


def multilobe_estimates(problem: SeparableProblem, model: LobesModel, shapes: Shapes, weights: Weights) -> Estimates:
    """Diffuse color; of each lobe roughness, color s and, where it has one of its own, F0 and s F0; a shared F0."""
    values, roughness = np.asarray(weights), np.asarray(shapes.roughness)
    m, channels = values.shape
    count, each = model.lobes, model.f0 == "each"
    size = 2 if each else 1
    lobes = values[1:].reshape(count, size, channels)
    on = np.any(lobes > 0, axis=(1, 2))
    low, high = ROUGHNESS_BOUNDS
    shared = None if shapes.f0 is None else float(shapes.f0)
    free_shapes = list(on & (roughness > low * 1.001) & (roughness < high * 0.999))
    if shared is not None:
        free_shapes.append(bool(on.any()))
    # As for one lobe: a term takes part in every channel of which any has it.
    free_terms = np.concatenate([[True], np.repeat(on, size)])
    free = np.concatenate([np.array(free_shapes, bool), np.tile(free_terms, channels)])
    make = LinearEstimator(parameter_covariance(problem, shapes, weights, free), conditional=False)
    first = len(free_shapes)
    for c in range(channels):
        diffuse = float(values[0, c])
        make.estimate(channel_name("diffuse", c, channels), diffuse, make.unit(first + c * m), at_bound=diffuse == 0)
    for k in range(count):
        lit = bool(on[k])
        make.roughness(f"roughness {k + 1}", float(roughness[k]), k, active=lit)
        for c in range(channels):
            index = first + c * m + 1 + size * k
            name = channel_name(f"{{}} {k + 1}", c, channels)
            if not each:
                s = float(lobes[k, 0, c])
                make.estimate(name.format("specular"), s, make.unit(index), at_bound=s == 0)
                continue
            p, q = (float(part) for part in lobes[k, :, c])
            s, in_p, in_q = p + q, make.unit(index), make.unit(index + 1)
            vague = s > 0 and make.split_undetermined(p, q, in_p, in_q)
            in_f0 = (q * in_p - p * in_q) / s**2 if s > 0 else 0.0 * in_p
            f0, edge = (p / s if s > 0 else 1.0), s > 0 and (p == 0 or q == 0)
            make.estimate(name.format("specular"), s, in_p + in_q, at_bound=s == 0, undetermined=vague)
            make.estimate(name.format("f0"), f0, in_f0, high=1.0, at_bound=edge, undetermined=vague or s == 0)
            make.estimate(name.format("specular x f0"), p, in_p, at_bound=p == 0)
    if shared is not None:
        on_edge = shared in (0.0, 1.0)
        make.estimate("f0", shared, make.unit(count), high=1.0, at_bound=on_edge, undetermined=not on.any())
    return make.estimates()
