"""Draws counted in bins against the density's own integral over them, and the power of that comparison.

The bins are polar about the middle of the densest draws: ``SECTORS`` sectors of azimuth, each cut into ``RINGS`` rings,
edges at the quantiles of a first sample. So every bin holds about as many draws as another, however narrow the lobe.
One more bin counts the draws that carry no light. Both numbers are odd or prime, so that no symmetry hides in them.

The density is integrated over each bin by Gauss-Legendre rules on rectangles of azimuth and relative polar angle, each
quartered until that changes nothing. Along an azimuth the integral ends where the density does, found by bisection: at
the surface's horizon, at that of a tilted normal, or where an exponential is smaller than any number.
"""

from dataclasses import dataclass

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from scipy.stats import chi2, ncx2

from axffit.brdf import AbstractBRDF
from axffit.testing.batches import in_batches, pdf, sample
from tests.brdf.models import MODELS

SECTORS, RINGS = 23, 3
PILOT = 2**15
BATCH = 2**18
TOLERANCE = 5e-8
"""Largest change of a rectangle's integral that ends its quartering; draws are known to 1e-4 of a bin at best."""

FALSE_ALARM = 1e-4
"""Probability that any of the suite's statistical tests of draws fails although all is right."""

POOLED_BELOW = 50.0
"""Bins with a smaller expectation are counted together."""

_NODES, _WEIGHTS = (0.5 * (v + s) for v, s in zip(np.polynomial.legendre.leggauss(6), (1.0, 0.0), strict=True))


@dataclass(frozen=True)
class Bins:
    """Polar bins about a direction: ``frame`` (3, 3), rows x, y and the middle; edges in radians."""

    frame: np.ndarray
    azimuths: np.ndarray
    """(SECTORS + 1,), from -pi to pi."""
    angles: np.ndarray
    """(SECTORS, RINGS + 1) polar angles, from 0 to pi."""

    def directions(self, azimuth: np.ndarray, angle: np.ndarray) -> np.ndarray:
        sine = np.sin(angle)
        local = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(angle)], axis=-1)
        return local @ self.frame

    def horizon(self, azimuth: np.ndarray) -> np.ndarray:
        """Polar angle at which the hemisphere ends along an azimuth."""
        x, y, z = self.frame[:, 2]
        return np.arctan2(z, -(np.cos(azimuth) * x + np.sin(azimuth) * y))


VIEWERS = np.array(
    [[np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)] for t, p in ((0.2, 0.6), (1.0, -2.0), (1.45, 0.6))]
)
"""11, 57 and 83 degrees from the normal; none is below a tilted normal of the table's models."""

CHI_SQUARE_TESTS, FURNACE_TESTS = len(MODELS) + 4, 3 * len(VIEWERS) * len(MODELS)
LEVEL = -np.expm1(np.log1p(-FALSE_ALARM) / (CHI_SQUARE_TESTS + FURNACE_TESTS))
"""Of one test (Šidák): ``test_chi2`` makes one a model, again for four with fewer draws; ``test_furnace`` one a model,
viewer and channel."""


def polar(frame: np.ndarray, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Azimuth and polar angle in the frame of the bins."""
    x, y, z = frame @ wi.T
    return np.arctan2(y, x), np.arctan2(np.hypot(x, y), z)


def lay(model: AbstractBRDF, wo: np.ndarray) -> tuple[Bins, tuple[float, float]]:
    """Bins for the draws of ``model``, and the wedge whose density :func:`perturbed` scales."""
    viewer = np.broadcast_to(wo, (PILOT, 3))
    draws = sample(model, viewer, np.random.default_rng(11).random((PILOT, 3)))
    density = pdf(model, draws, viewer)
    draws, density = draws[density > 0], density[density > 0]
    center = draws[density >= np.quantile(density, 0.75)].mean(axis=0)
    center /= np.linalg.norm(center)
    x = np.array([center[2], 0.0, -center[0]]) / np.hypot(center[0], center[2])
    frame = np.stack([x, np.cross(center, x), center])
    azimuth, angle = polar(frame, draws)
    azimuths = np.quantile(azimuth, np.linspace(0, 1, SECTORS + 1))
    azimuths[[0, -1]] = -np.pi, np.pi
    sector = np.clip(np.searchsorted(azimuths, azimuth, "right") - 1, 0, SECTORS - 1)
    angles = np.stack([np.quantile(angle[sector == k], np.linspace(0, 1, RINGS + 1)) for k in range(SECTORS)])
    angles[:, 0], angles[:, -1] = 0.0, np.pi
    bins = Bins(frame, azimuths, angles)
    return bins, _wedge(bins, azimuth)


def _wedge(bins: Bins, drawn: np.ndarray) -> tuple[float, float]:
    """Start and end of a wedge that holds a tenth of the hemisphere's solid angle and a tenth of the draws.

    There is one: wedges of a tenth of the solid angle hold, on average over where they start, a tenth of the draws, and
    their share changes continuously as they turn. It is neither the peak nor an empty corner, hence a fair choice.
    """
    phi = np.linspace(-np.pi, np.pi, 7201)
    solid = np.concatenate([[0], np.cumsum(1 - np.cos(bins.horizon(0.5 * (phi[1:] + phi[:-1]))))])
    solid *= 1.0 / solid[-1]
    start = np.linspace(0, 1, 400, endpoint=False)
    ends = np.stack([np.interp(start, solid, phi), np.interp((start + 0.1) % 1, solid, phi)], axis=1)
    ends[:, 1] += 2 * np.pi * (ends[:, 1] < ends[:, 0])
    share = ((drawn - ends[:, :1]) % (2 * np.pi) < (ends[:, 1:] - ends[:, :1])).mean(axis=1)
    first, last = ends[np.argmin(np.abs(share - 0.1))]
    return float(first), float(last)


def integrate(bins: Bins, wedge: tuple[float, float], density, integrand, tolerance: float = TOLERANCE):
    """Integrals over the bins of ``integrand(wi) -> (n, k)``, and of its part in the wedge.

    Returns:
        (bins, k) integrals, (bins, k) parts of them in the wedge, (bins, k) sums of the last changes: bounds on what
        the quadrature misses.
    """
    start, end = wedge
    edges = np.unique(np.concatenate([bins.azimuths, (np.array(wedge) + np.pi) % (2 * np.pi) - np.pi]))
    edges = edges[np.concatenate([[True], np.diff(edges) > 1e-12])]
    sector = np.clip(np.searchsorted(bins.azimuths, 0.5 * (edges[1:] + edges[:-1]), "right") - 1, 0, SECTORS - 1)
    count = len(sector)
    # Rows: azimuths from, to; relative angles from, to; the bin.
    ring = np.tile(np.arange(RINGS), count)
    boxes = np.stack([np.repeat(edges[:-1], RINGS), np.repeat(edges[1:], RINGS)], axis=1)
    boxes = np.concatenate([boxes, np.tile([0.0, 1.0], (len(boxes), 1))], axis=1)
    index = np.repeat(sector, RINGS) * RINGS + ring

    def rule(boxes, index):
        azimuth = boxes[:, :1] + (boxes[:, 1:2] - boxes[:, :1]) * _NODES
        stop = _ends(bins, density, azimuth.ravel()).reshape(azimuth.shape)
        rows = bins.angles.reshape(-1)[index // RINGS * (RINGS + 1) + index % RINGS + np.array([[0], [1]])]
        low, high = (np.minimum(row[:, None], stop) for row in rows)
        part = (boxes[:, 2:3] + (boxes[:, 3:] - boxes[:, 2:3]) * _NODES)[:, None, :]
        # Even steps in the innermost ring, even ratios in the others, which reach from a lobe's width to the horizon.
        even, low, high = (low == 0)[:, :, None], low[:, :, None], high[:, :, None]
        ratio = np.log(high / np.where(even, high, low))
        angle = np.where(even, high * part, low * np.exp(ratio * part))
        speed = np.where(even, high, ratio * angle)
        wi = bins.directions(np.broadcast_to(azimuth[:, :, None], angle.shape), angle)
        values = integrand(wi.reshape(-1, 3)).reshape(*angle.shape, -1)
        scale = (boxes[:, 1] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 2])
        return np.einsum("b,i,j,bij,bijk->bk", scale, _WEIGHTS, _WEIGHTS, speed * np.sin(angle), values, optimize=True)

    values = rule(boxes, index)
    size, channels = SECTORS * RINGS, values.shape[1]
    total, within, missed = (np.zeros((size, channels)) for _ in range(3))
    for _ in range(40):
        children = _quarters(boxes)
        finer = rule(children.reshape(-1, 4), np.repeat(index, 4)).reshape(len(boxes), 4, channels)
        change = np.abs(finer.sum(axis=1) - values)
        done = (change <= tolerance).all(axis=1)
        inside = (0.5 * (boxes[:, 0] + boxes[:, 1]) - start) % (2 * np.pi) < end - start
        np.add.at(total, index[done], finer[done].sum(axis=1))
        np.add.at(within, index[done & inside], finer[done & inside].sum(axis=1))
        np.add.at(missed, index[done], change[done])
        if done.all():
            return total, within, missed
        boxes, index = children[~done].reshape(-1, 4), np.repeat(index[~done], 4)
        values = finer[~done].reshape(-1, channels)
    raise AssertionError(f"{len(boxes)} rectangles are still rough after 40 quarterings, e.g. {boxes[0]}")


def _quarters(boxes: np.ndarray) -> np.ndarray:
    a, b, c, d = boxes.T
    m, n = 0.5 * (a + b), 0.5 * (c + d)
    rows = [(a, m, c, n), (m, b, c, n), (a, m, n, d), (m, b, n, d)]
    return np.stack([np.stack(row, axis=1) for row in rows], axis=1)


def _ends(bins: Bins, density, azimuth: np.ndarray) -> np.ndarray:
    """Polar angle at which the density ends along each azimuth."""
    low, high = np.zeros(len(azimuth)), bins.horizon(azimuth)
    # Nearly always the hemisphere's own horizon.
    open_end = density(bins.directions(azimuth, high * (1 - 1e-9))) > 0
    low = np.where(open_end, high, low)
    closed = np.flatnonzero(~open_end)
    for _ in range(50 if len(closed) else 0):
        middle = 0.5 * (low[closed] + high[closed])
        positive = density(bins.directions(azimuth[closed], middle)) > 0
        low[closed] = np.where(positive, middle, low[closed])
        high[closed] = np.where(positive, high[closed], middle)
    return low


@eqx.filter_jit
def _indices(model, fixed, u):
    """Bin of each draw; ``fixed``: viewer, frame, azimuths, tangents of half the polar angles (cheaper than angles)."""
    wo, frame, azimuths, tangents = fixed
    wi = model.sample(wo, u)
    x, y, z = frame @ wi.T
    sector = jnp.sum(jnp.arctan2(y, x)[None] >= azimuths[1:-1, None], axis=0)
    tangent = jnp.sqrt(x * x + y * y) / jnp.maximum(1.0 + z, 1e-300)
    ring = jnp.sum(tangent[None] >= tangents[:, 1:-1].T[:, sector], axis=0)
    return jnp.where(wi[:, 2] > 0, sector * RINGS + ring, SECTORS * RINGS)


def count(model: AbstractBRDF, wo: np.ndarray, bins: Bins, draws: int, seed: int) -> np.ndarray:
    """How many of ``draws`` (a multiple of ``BATCH``) fall in each bin and, last, carry no light."""
    rng, total = np.random.Generator(np.random.SFC64(seed)), np.zeros(SECTORS * RINGS + 1, int)
    fixed = [jnp.asarray(v) for v in (wo, bins.frame, bins.azimuths, np.tan(0.5 * bins.angles))]
    for _ in range(draws // BATCH):
        total += np.bincount(
            np.asarray(_indices(model, fixed, jnp.asarray(rng.random((BATCH, 3))))), minlength=len(total)
        )
    return total


def pool(expected: np.ndarray, *others: np.ndarray) -> list[np.ndarray]:
    """The arrays with all bins of small expectation in one, which takes the smallest other if it is small itself."""
    order = np.argsort(expected)
    small = int(np.searchsorted(expected[order], POOLED_BELOW))
    while small and expected[order[:small]].sum() < POOLED_BELOW:
        small += 1
    return [np.append(v[order[small:]], v[order[:small]].sum()) if small else v for v in (expected, *others)]


def perturbed(shares: np.ndarray, within: np.ndarray, scale: float) -> np.ndarray:
    """Shares of a density scaled by ``scale`` in the wedge, then everywhere so that as many draws carry light.

    Were that not done, the number of draws that carry light would betray the change at once.
    """
    changed = shares[:-1] + (scale - 1) * within
    return np.append(changed * (shares[:-1].sum() / changed.sum()), shares[-1])


@dataclass(frozen=True)
class Table:
    """What the density says of a model's draws for several viewers: one row a viewer."""

    viewers: np.ndarray
    bins: list[Bins]
    shares: list[np.ndarray]
    """(SECTORS * RINGS + 1,) each; the last is the share of draws that carry no light."""
    within: list[np.ndarray]
    """The parts of ``shares``, but for the last, in the wedge."""
    missed: list[np.ndarray]
    """Bounds on what the quadrature misses of ``shares``."""

    def wrong(self, scale: float) -> list[np.ndarray]:
        return [perturbed(share, part, scale) for share, part in zip(self.shares, self.within, strict=True)]

    def counts(self, model: AbstractBRDF, draws: int, seed: int) -> list[np.ndarray]:
        rows = enumerate(zip(self.viewers, self.bins, strict=True))
        return [count(model, wo, bins, draws, seed + k) for k, (wo, bins) in rows]

    def bias(self, draws: int) -> float:
        """Bound on what the quadrature's error adds to chi square on average."""
        rows = zip(self.shares, self.missed, strict=True)
        return sum(float(np.sum(draws * miss**2 / np.maximum(share, POOLED_BELOW / draws))) for share, miss in rows)


def tabulate(model: AbstractBRDF, viewers: np.ndarray) -> Table:
    """Bins and the density's integrals over them for every viewer."""
    columns = []
    for wo in viewers:
        density = density_of(model, wo)
        bins, wedge = lay(model, wo)
        total, within, missed = integrate(bins, wedge, density, lambda wi, density=density: density(wi)[:, None])
        dark, missed = 1.0 - total.sum(), np.append(missed[:, 0], missed.sum())
        assert dark > -missed[-1] - 1e-9, f"the density for {wo} integrates to {total.sum()}"
        columns.append((bins, np.append(total[:, 0], max(dark, 0.0)), within[:, 0], missed))
    return Table(viewers, *map(list, zip(*columns, strict=True)))


def density_of(model: AbstractBRDF, wo: np.ndarray):
    """The density for one viewer as a function of rows."""
    return lambda wi: in_batches(_pdf, model, wi, np.broadcast_to(wo, wi.shape), batch=4096)


@eqx.filter_jit
def _pdf(model, wi, wo):
    return model.pdf(wi, wo)


def chi_square(counts: list[np.ndarray], shares: list[np.ndarray]) -> tuple[float, int]:
    """Pearson's chi square of the viewers' counts together, and its degrees of freedom."""
    total, freedom = 0.0, 0
    for found, share in zip(counts, shares, strict=True):
        expected, found = pool(share * found.sum(), found)
        total += float(np.sum((found - expected) ** 2 / expected))
        freedom += len(expected) - 1
    return total, freedom


def p_value(counts: list[np.ndarray], shares: list[np.ndarray]) -> float:
    """Probability of counts as far from what ``shares`` say, or farther."""
    return float(chi2.sf(*chi_square(counts, shares)))


def power(shares: list[np.ndarray], wrong: list[np.ndarray], draws: int, level: float) -> float:
    """Probability that draws of ``shares``, ``draws`` a viewer, reject ``wrong`` (non-central chi square)."""
    distance, freedom = chi_square([share * draws for share in shares], wrong)
    return float(ncx2.sf(chi2.isf(level, freedom), freedom, distance))


def draws_needed(shares: list[np.ndarray], wrong: list[np.ndarray], level: float, wanted: float) -> int:
    """Fewest draws a viewer, a multiple of ``BATCH``, of that power."""
    low, high = 0, 1
    while power(shares, wrong, high * BATCH, level) < wanted:
        low, high = high, 2 * high
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if power(shares, wrong, middle * BATCH, level) < wanted else (low, middle)
    return high * BATCH
