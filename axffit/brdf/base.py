"""What a BRDF is, and how BRDFs compose.

A BRDF is a module with one abstract method on single directions; batching and the horizon are handled here and
nowhere else. Its inexact array leaves are its parameters, so ``grad``, ``jit`` and ``vmap`` act on them, and a module
whose leaves carry a leading axis is a map of BRDFs for ``equinox.filter_vmap``. Composition is data: :class:`Sum` adds,
:class:`Framed` tilts and turns, :class:`axffit.brdf.ClearCoat` covers.
"""

import abc

import equinox as eqx
import jax
import jax.numpy as jnp

from axffit._types import RGB, Channels, Direction, Directions, Scalar
from axffit.frames import NORMAL, tangent_frame, to_local
from axffit.numerics import compute_dtype


def as_parameter(value) -> jax.Array:
    """``value`` as a floating array, its own floating type kept; the converter of every parameter field."""
    array = jnp.asarray(value)
    dtype = array.dtype if jnp.issubdtype(array.dtype, jnp.floating) else jnp.zeros(0).dtype
    return jax.lax.convert_element_type(array, dtype)


class AbstractBRDF(eqx.Module):
    """A reflectance f = dL_o / dE_i in 1/sr, linear RGB, without the cosine."""

    @abc.abstractmethod
    def value(self, wi: Direction, wo: Direction) -> RGB:
        """Value for one pair of unit directions that both lie above the horizon (what a model implements)."""

    def masked_value(self, wi: Direction, wo: Direction) -> RGB:
        """Value for one pair of unit directions: ``value`` above the horizon, otherwise 0 with gradient 0."""
        visible = (wi[2] > 0) & (wo[2] > 0)
        normal = jnp.asarray(NORMAL, wi.dtype)
        value = self.value(jnp.where(visible, wi, normal), jnp.where(visible, wo, normal))
        return jnp.where(visible, value, jnp.zeros_like(value))

    def evaluate(self, wi: Directions, wo: Directions) -> Channels:
        """BRDF value.

        Args:
            wi: unit directions to the light, (..., 3); they are not normalized here.
            wo: unit directions to the viewer, (..., 3); leading axes broadcast against those of ``wi``.

        Returns:
            f in 1/sr without the cosine, linear RGB, (..., 3). Below the horizon (wi_z <= 0 or wo_z <= 0) it is 0
            and so is its gradient. Computed in float64 if a direction or a parameter is, otherwise in float32.
        """
        wi, wo = jnp.asarray(wi), jnp.asarray(wo)
        dtype = compute_dtype(wi, wo, *jax.tree.leaves(eqx.filter(self, eqx.is_inexact_array)))
        model = self.astype(dtype)
        shape = jnp.broadcast_shapes(wi.shape, wo.shape)
        wi, wo = (jnp.broadcast_to(v.astype(dtype), shape).reshape(-1, 3) for v in (wi, wo))
        return jax.vmap(model.masked_value)(wi, wo).reshape(shape)

    def astype(self, dtype: jnp.dtype) -> "AbstractBRDF":
        """The same BRDF with every parameter in ``dtype``."""
        return jax.tree.map(lambda leaf: leaf.astype(dtype) if eqx.is_inexact_array(leaf) else leaf, self)

    def __add__(self, other: "AbstractBRDF") -> "Sum":
        """``a + b`` reflects what ``a`` and ``b`` reflect together."""
        return Sum((self, other))


class Sum(AbstractBRDF):
    """f = f_1 + f_2 + …, for example a diffuse term and a lobe."""

    terms: tuple[AbstractBRDF, ...]

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """Sum of the terms' values."""
        return sum((term.value(wi, wo) for term in self.terms), jnp.zeros_like(wi))


class Framed(AbstractBRDF):
    """``base`` in the frame of a shading normal, turned by an anisotropy angle.

    ``normal`` (3,) is in the surface's tangent frame and need not have unit length; ``rotation`` () in radians: the
    base's x axis becomes (cos g, sin g, 0) there (:func:`axffit.frames.tangent_frame`). Directions below the shading
    normal see 0.
    """

    base: AbstractBRDF
    normal: Direction = eqx.field(converter=as_parameter, default=NORMAL)
    rotation: Scalar = eqx.field(converter=as_parameter, default=0.0)

    def value(self, wi: Direction, wo: Direction) -> RGB:
        """Value of ``base`` for the directions as seen from its frame."""
        frame = tangent_frame(self.normal, self.rotation)
        return self.base.masked_value(to_local(frame, wi), to_local(frame, wo))
