"""How many texels of a 256² surface end at the best minimum, how fast, and with errors that cover the truth?

    python -m experiments.09_texel_fit

Made GGX texels (roughness .08 to .5), 64 random lights and viewers within 75 degrees, Gaussian noise of 1 % of each
value (and 1e-5 of a black one), stated to the fit. Two models of 7 parameters. A texel is at the best minimum if its
cost is within 1e-6 of the least that the solver finds from its own start, from the truth and from a random start.
"""

import resource
import sys
import time
from typing import Any

import jax
import numpy as np

from axffit.fitting.texels.batch import Outcome, fit_texels
from axffit.fitting.texels.maps import maps_of, reduced_chi_square
from axffit.fitting.texels.problem import TexelModel
from axffit.fitting.texels.synthetic import made, true_maps
from experiments import common

SIDE, CHUNK, SMALL = 256, 4096, 512
NOISE, FLOOR, RANDOM_STARTS = 0.01, 1e-3, 1
DEMANDED = 0.999
MODELS = {
    "diffuse and specular RGB, roughness": (TexelModel(normal=False), 3),
    "diffuse, specular, two roughnesses, rotation, normal": (TexelModel(anisotropic=True), 1),
}


def _random_start(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    start = rng.normal(0.0, 0.1, shape)
    start[0] = rng.uniform(np.log(0.03), np.log(0.8), shape[1])
    return start


def counted(name: str, texels: int, seed: int) -> dict[str, Any]:
    """Counts over some texels of a model: best minima, outcomes, intervals that cover the truth; and CPU seconds."""
    model, channels = MODELS[name]
    surface = made(model, texels, channels=channels, noise=NOISE, floor=FLOOR, seed=seed)
    values, precisions = np.asarray(surface.samples.values), np.asarray(surface.samples.precisions)
    rng = np.random.default_rng([seed, 2])

    def fitted(start: np.ndarray | None = None):
        return fit_texels(model, surface.wi, surface.wo, values, precisions, start)

    begin = time.process_time()
    fit = fitted()
    seconds = time.process_time() - begin
    starts = [surface.theta] + [_random_start(rng, surface.theta.shape) for _ in range(RANDOM_STARTS)]
    others = [fitted(start).cost for start in starts]
    least = np.min([fit.cost, *others], axis=0)
    truth, covered = true_maps(model, surface), {}
    for key, map_ in maps_of(model, fit).items():
        off = map_.values - truth[key]
        off = (off + np.pi / 2) % np.pi - np.pi / 2 if key == "anisrotation" else off
        # The third component of an upright normal is quadratic in its tilt: no interval by linearization.
        for channel in range(min(len(off), 2) if key == "normal" else len(off)):
            known = np.isfinite(map_.errors[channel])
            inside = np.abs(off[channel][known]) <= 1.959964 * map_.errors[channel][known]
            covered[f"{key} {channel}"] = [int(known.sum()), int(inside.sum())]
    return {
        "texels": texels,
        "at_best": int(np.count_nonzero(fit.cost <= least * (1 + 1e-6))),
        "random_start_at_best": int(np.count_nonzero(others[-1] <= least * (1 + 1e-6))),
        "outcomes": {entry.name: int(np.count_nonzero(fit.outcome == entry)) for entry in Outcome},
        "chi_square_mean": float(np.mean(reduced_chi_square(model, fit, precisions))),
        "covered": covered,
        "cpu_seconds": seconds,
    }


def _summed(parts: list[dict[str, Any]]) -> dict[str, Any]:
    total: dict[str, Any] = {
        key: sum(part[key] for part in parts) for key in ("texels", "at_best", "random_start_at_best")
    }
    total["outcomes"] = {key: sum(part["outcomes"][key] for part in parts) for key in parts[0]["outcomes"]}
    total["chi_square_mean"] = float(np.mean([part["chi_square_mean"] for part in parts]))
    coverage = {key: np.sum([part["covered"][key] for part in parts], axis=0) for key in parts[0]["covered"]}
    total["coverage"] = {key: float(inside / known) for key, (known, inside) in coverage.items()}
    total["with_interval"] = {key: float(known / total["texels"]) for key, (known, _) in coverage.items()}
    # The first chunk compiles.
    total["cpu_us_a_texel"] = 1e6 * float(np.median([part["cpu_seconds"] for part in parts[1:]])) / CHUNK
    return total


def subset() -> dict[str, Any]:
    """512 texels of each model, without the time."""
    small = {name: counted(name, SMALL, seed=10_000) for name in MODELS}
    return {"small": {name: {k: v for k, v in row.items() if k != "cpu_seconds"} for name, row in small.items()}}


def report(data: dict[str, Any]) -> str:
    """report.md."""
    rows, coverage = [], []
    for name, row in data["models"].items():
        share = row["at_best"] / row["texels"]
        finished, left = row["outcomes"]["FINISHED"], row["outcomes"]["NOT_CONVERGED"]
        random = row["random_start_at_best"] / row["texels"]
        rows.append((name, f"{100 * share:.4f} %", f"{100 * random:.2f} %", finished, left, row["cpu_us_a_texel"]))
        coverage += [(name, key, row["coverage"][key], row["with_interval"][key]) for key in row["coverage"]]
    return "\n\n".join(
        [
            "# How many texels end at the best minimum?",
            str(__doc__).split("\n\n", 2)[2].replace("\n", " "),
            common.table(
                (
                    "7 parameters",
                    "at the best minimum",
                    "one random start",
                    "finished by optimistix",
                    "not converged",
                    "CPU µs a texel",
                ),
                rows,
            ),
            "The few others end in another valley. Mean reduced chi-square over all texels, theirs included: "
            f"{', '.join(format(row['chi_square_mean'], '.3g') for row in data['models'].values())}.",
            f"Demanded: {100 * DEMANDED:.1f} %. Peak memory of the run: {data['peak_mib']:.0f} MiB.",
            "## Share of 95 % intervals that cover the truth",
            common.table(("7 parameters", "map", "covers", "texels with an interval"), coverage),
        ]
    )


def main() -> None:
    """The whole surface of each model, chunk by chunk."""
    models = {}
    for name in MODELS:
        models[name] = _summed([counted(name, CHUNK, seed) for seed in range(SIDE * SIDE // CHUNK)])
        print(name, models[name], flush=True)
    unit = 2**20 if sys.platform == "darwin" else 2**10
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit
    data = {"side": SIDE, "images": 64, "noise": NOISE, "models": models, "peak_mib": peak, **subset()}
    common.write(__file__, data, report(common.rounded(data)))


if __name__ == "__main__":
    jax.config.update("jax_enable_x64", True)  # noqa: FBT003
    main()
