"""Unit vectors in a texture: components, two components with the third rebuilt, and the octahedron.

Each encoding has ``encode`` (unit vectors [..., 3] -> codes [..., C]), ``decode`` (codes -> unit vectors) and
``angle_bound``, a proven bound in radians on the angle between a vector and what it comes back as, by rounding mode.
Below, d is the largest error of a stored component in the vector's own unit (`Stored.error`).
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .codec import ScalarCodec
from .floats import HALF, IeeeFloat
from .rerange import Identity, UnitOffset
from .unorm import Snorm, Unorm

# Re-ranging, normalizing and measuring an angle: a few roundings of float64 each.
_ARITHMETIC = 2.0**-48


@dataclass(frozen=True)
class Stored:
    """How a component in [-1, 1] is stored.

    Attributes:
        codec: the number format's channel.
        offset: whether 0.5 (x + 1) is stored instead of x, as an unsigned format must.
    """

    codec: ScalarCodec
    offset: bool = False

    def encode(self, components: np.ndarray, rounding: str) -> np.ndarray:
        """Codes of components, any shape."""
        return self.codec.encode(self._reranging.forward(components), rounding)

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """Components of codes."""
        return self._reranging.inverse(self.codec.decode(codes))

    def error(self, rounding: str) -> float:
        """d: the largest error of a component of (-1, 1); that of the codec, twice it behind the offset."""
        below_one = np.array([np.nextafter(1.0, 0.0)])
        bound = float(self.codec.error_bound(below_one, rounding)[0])
        return (2.0 if self.offset else 1.0) * bound + _ARITHMETIC

    @property
    def _reranging(self) -> Identity | UnitOffset:
        return UnitOffset() if self.offset else Identity()


@dataclass(frozen=True)
class UnitVectorEncoding(ABC):
    """What every encoding has.

    Attributes:
        stored: how each stored component is stored.
    """

    stored: Stored

    @property
    @abstractmethod
    def channels(self) -> int:
        """Stored components."""

    @abstractmethod
    def components(self, vectors: np.ndarray) -> np.ndarray:
        """Components [..., C] in [-1, 1] of unit vectors [..., 3]."""

    @abstractmethod
    def direction(self, components: np.ndarray) -> np.ndarray:
        """Unit vectors [..., 3] of components [..., C]."""

    @abstractmethod
    def angle_bound(self, rounding: str = "nearest_even") -> float:
        """Proven bound on the angle between a unit vector and its decoded one, radians."""

    def encode(self, vectors: np.ndarray, rounding: str = "nearest_even") -> np.ndarray:
        """Codes [..., C] of unit vectors [..., 3]."""
        return self.stored.encode(self.components(np.asarray(vectors, dtype=np.float64)), rounding)

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """Unit vectors [..., 3] of codes [..., C]."""
        return self.direction(self.stored.decode(codes))


@dataclass(frozen=True)
class Components(UnitVectorEncoding):
    """All three components; the decoded vector is normalized.

    Bound, for a decoded vector n + e with |e_i| <= d, of which only the part of e across n turns n:

    - In general the angle is at most asin |e| <= asin(sqrt(3) d).
    - SNORM toward zero: e_i has the sign of -n_i. The part across n is convex in e, hence largest where each |e_i| is 0
      or d: d² (k - (sum of those |n_i|)²), k of them not 0. That is at most 2 d² (k = 3: the sum is >= 1); and e
      shortens n by at most sqrt(3) d. So atan(sqrt(2) d / (1 - sqrt(3) d)).
    - Half of n: each component is multiplied by a factor in [1 - a, 1 + b]; a and b are 2^-11 (nearest), 2^-10 and 0
      (toward zero), 2^-10 each (floor). The largest angle of a diagonal matrix with entries in [m, M] has the sine
      (M - m) / (M + m) (Kantorovich). At most two components are below 2^-14 and err absolutely, by 2^-24 at most:
      together less than 2^-23 across n.
    - Half of 0.5 (n + 1) toward zero or floor: all e_i <= 0, d = 2^-10, and half of it where n_i < 0. If no n_i is
      negative: as for SNORM. Otherwise |e| <= sqrt(1 + 1 + 1/4) d, so asin(1.5 d), which is larger.
    """

    @property
    def channels(self) -> int:
        """Three."""
        return 3

    def components(self, vectors: np.ndarray) -> np.ndarray:
        """The vectors."""
        return vectors

    def direction(self, components: np.ndarray) -> np.ndarray:
        """The components, normalized; (0, 0, 1) where all are 0."""
        length = np.linalg.norm(components, axis=-1, keepdims=True)
        return np.where(length > 0, components / np.where(length > 0, length, 1.0), [0.0, 0.0, 1.0])

    def angle_bound(self, rounding: str = "nearest_even") -> float:
        """The bound of the class docstring."""
        d = self.stored.error(rounding)
        codec, downward = self.stored.codec, rounding != "nearest_even"
        if isinstance(codec, IeeeFloat):
            if self.stored.offset:
                return float(np.arcsin((1.5 if downward else np.sqrt(3)) * d))
            spread = {"nearest_even": (2.0**-11, 2.0**-11), "floor": (2.0**-10, 2.0**-10)}
            below, above = spread.get(rounding, (2.0**-10, 0.0))
            return float(np.arcsin((below + above) / (2 - below + above)) + 2.0**-23)
        if isinstance(codec, Snorm) and rounding == "toward_zero":
            return float(np.arctan(np.sqrt(2) * d / (1 - np.sqrt(3) * d)))
        return float(np.arcsin(np.sqrt(3) * d))


@dataclass(frozen=True)
class RebuiltZ(UnitVectorEncoding):
    """x and y; z = sqrt(max(0, 1 - x² - y²)), and the result normalized. Vectors with z >= 0 only.

    Bound: acos(1 - r), r = sqrt(2) d. (x, y) moves by r at most, and by no more after a point outside the unit disc has
    gone to its edge, since projecting onto a convex set brings points together. Let 2 p be the angle between two unit
    vectors of the upper hemisphere, m their bisector, t the direction of their chord, of length 2 sin p. As t is
    across m, t_z² <= 1 - m_z²; as both ends have z >= 0, |t_z| sin p <= m_z cos p. Together t_z² <= cos² p: the chord's
    horizontal length is 2 sin p sqrt(1 - t_z²) >= 2 sin² p = 1 - cos 2p. Hence 1 - cos 2p <= r.
    """

    @property
    def channels(self) -> int:
        """Two."""
        return 2

    def components(self, vectors: np.ndarray) -> np.ndarray:
        """x and y."""
        return vectors[..., :2]

    def direction(self, components: np.ndarray) -> np.ndarray:
        """x, y and the rebuilt z, normalized."""
        z = np.sqrt(np.maximum(1.0 - np.sum(components**2, axis=-1, keepdims=True), 0.0))
        vectors = np.concatenate([components, z], axis=-1)
        return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)

    def angle_bound(self, rounding: str = "nearest_even") -> float:
        """acos(1 - r)."""
        return float(np.arccos(1.0 - np.sqrt(2) * self.stored.error(rounding)))


@dataclass(frozen=True)
class Octahedral(UnitVectorEncoding):
    """n / (|x| + |y| + |z|) projected along z, its lower half folded outward (Meyer et al. 2010); any unit vector.

    Bound: 3 sqrt(2) d. The square's point moves by at most d along each axis, on a straight line inside the square,
    which the octahedron follows continuously. On a face |z| = 1 - |x| - |y|, so a step (du, dv) moves the point by
    |(du, dv, |du| + |dv|)| <= sqrt(6) d at most; a face lies 1 / sqrt(3) from the center, so the angle grows by at most
    sqrt(3) times that.
    """

    @property
    def channels(self) -> int:
        """Two."""
        return 2

    def components(self, vectors: np.ndarray) -> np.ndarray:
        """The point of the square [-1, 1]²."""
        point = vectors / np.sum(np.abs(vectors), axis=-1, keepdims=True)
        plane = point[..., :2]
        return np.where(point[..., 2:] < 0, _folded(plane), plane)

    def direction(self, components: np.ndarray) -> np.ndarray:
        """The point of the octahedron, normalized."""
        z = 1.0 - np.sum(np.abs(components), axis=-1, keepdims=True)
        vectors = np.concatenate([np.where(z < 0, _folded(components), components), z], axis=-1)
        return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)

    def angle_bound(self, rounding: str = "nearest_even") -> float:
        """3 sqrt(2) d."""
        return 3.0 * float(np.sqrt(2)) * self.stored.error(rounding)


def _folded(plane: np.ndarray) -> np.ndarray:
    """((1 - |y|) sign x, (1 - |x|) sign y): the triangles beyond |x| + |y| = 1 and those within, exchanged."""
    return (1.0 - np.abs(plane[..., ::-1])) * np.where(plane < 0, -1.0, 1.0)


UNIT_VECTORS: Mapping[str, UnitVectorEncoding] = {
    "RGB UNORM8": Components(Stored(Unorm(8), offset=True)),
    "RGB UNORM10": Components(Stored(Unorm(10), offset=True)),
    "RGB UNORM16": Components(Stored(Unorm(16), offset=True)),
    "RGB SNORM8": Components(Stored(Snorm(8))),
    "RGB SNORM16": Components(Stored(Snorm(16))),
    "RGB half of n": Components(Stored(HALF)),
    "RGB half of 0.5 (n + 1)": Components(Stored(HALF, offset=True)),
    "RG UNORM8 + z": RebuiltZ(Stored(Unorm(8), offset=True)),
    "RG UNORM16 + z": RebuiltZ(Stored(Unorm(16), offset=True)),
    "RG SNORM8 + z": RebuiltZ(Stored(Snorm(8))),
    "RG SNORM16 + z": RebuiltZ(Stored(Snorm(16))),
    "RG half + z": RebuiltZ(Stored(HALF)),
    "octahedral UNORM8": Octahedral(Stored(Unorm(8), offset=True)),
    "octahedral UNORM16": Octahedral(Stored(Unorm(16), offset=True)),
    "octahedral SNORM8": Octahedral(Stored(Snorm(8))),
    "octahedral SNORM16": Octahedral(Stored(Snorm(16))),
}
"""Every encoding by name."""
