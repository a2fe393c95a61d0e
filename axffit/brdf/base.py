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
from jaxtyping import Array, Float

from axffit._types import RGB, Angles, Channels, Direction, Directions, Scalar
from axffit.brdf.sampling import DOWN, Uniforms, choose, shares
from axffit.frames import NORMAL, tangent_frame, to_local, to_world
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

    @abc.abstractmethod
    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """Light direction for a viewer above the horizon, from three uniforms in [0, 1) (what a model implements)."""

    @abc.abstractmethod
    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """Density, per sr, of ``draw`` for directions above the horizon (what a model implements)."""

    @abc.abstractmethod
    def weight(self, wo: Direction) -> Scalar:
        """Rough estimate of the light reflected towards ``wo``: shares of a mixture's draws are set by it."""

    def masked_value(self, wi: Direction, wo: Direction) -> RGB:
        """Value for one pair of unit directions: ``value`` above the horizon, otherwise 0 with gradient 0."""
        visible = (wi[2] > 0) & (wo[2] > 0)
        normal = jnp.asarray(NORMAL, wi.dtype)
        value = self.value(jnp.where(visible, wi, normal), jnp.where(visible, wo, normal))
        return jnp.where(visible, value, jnp.zeros_like(value))

    def masked_draw(self, wo: Direction, u: Uniforms) -> Direction:
        """``draw`` for a viewer above the horizon; ``DOWN`` otherwise and for draws that end below it."""
        down, visible = jnp.asarray(DOWN, wo.dtype), wo[2] > 0
        wi = self.draw(jnp.where(visible, wo, jnp.asarray(NORMAL, wo.dtype)), u)
        return jnp.where(visible & (wi[2] > 0), wi, down)

    def masked_density(self, wi: Direction, wo: Direction) -> Scalar:
        """``density`` above the horizon, otherwise 0."""
        visible = (wi[2] > 0) & (wo[2] > 0)
        normal = jnp.asarray(NORMAL, wi.dtype)
        value = self.density(jnp.where(visible, wi, normal), jnp.where(visible, wo, normal))
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
        return self._batched("masked_value", wi, wo)

    def sample(self, wo: Directions, u: Float[Array, "... 3"]) -> Directions:
        """Light directions drawn in proportion to about f cos theta_i.

        Args:
            wo: unit directions to the viewer, (..., 3).
            u: three independent uniforms in [0, 1), (..., 3).

        Returns:
            wi (..., 3), of density :meth:`pdf`; (0, 0, -1) for draws that carry no light. f cos theta_i / pdf is the
            weight of a draw. The mirror reflection of a coat is not drawn (:meth:`axffit.brdf.ClearCoat.mirror`).
        """
        return self._batched("masked_draw", wo, u)

    def pdf(self, wi: Directions, wo: Directions) -> Angles:
        """Density of :meth:`sample` per steradian, (...); 0 below the horizon."""
        return self._batched("masked_density", wi, wo)

    def _batched(self, method: str, a: Float[Array, "... 3"], b: Float[Array, "... 3"]) -> Float[Array, "..."]:
        """The single-direction ``method`` over broadcast batches, in the dtype of the computation."""
        a, b = jnp.asarray(a), jnp.asarray(b)
        dtype = compute_dtype(a, b, *jax.tree.leaves(eqx.filter(self, eqx.is_inexact_array)))
        model = self.astype(dtype)
        shape = jnp.broadcast_shapes(a.shape, b.shape)
        a, b = (jnp.broadcast_to(v.astype(dtype), shape).reshape(-1, 3) for v in (a, b))
        values = jax.vmap(getattr(model, method))(a, b)
        return values.reshape(*shape[:-1], *values.shape[1:])

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

    def _shares(self, wo: Direction) -> Float[Array, " terms"]:
        return shares(jnp.stack([term.weight(wo) for term in self.terms]))

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """A draw of one term, chosen by the terms' weights."""
        index, u = choose(u, self._shares(wo))
        return jnp.stack([term.masked_draw(wo, u) for term in self.terms])[index]

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """Mixture of the terms' densities."""
        return jnp.sum(self._shares(wo) * jnp.stack([term.masked_density(wi, wo) for term in self.terms]))

    def weight(self, wo: Direction) -> Scalar:
        """Sum of the terms' weights."""
        return sum((term.weight(wo) for term in self.terms), jnp.zeros_like(wo[0]))


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

    def draw(self, wo: Direction, u: Uniforms) -> Direction:
        """A draw of ``base`` in its frame."""
        frame = tangent_frame(self.normal, self.rotation)
        local = self.base.masked_draw(to_local(frame, wo), u)
        return jnp.where(local[2] > 0, to_world(frame, local), jnp.asarray(DOWN, wo.dtype))

    def density(self, wi: Direction, wo: Direction) -> Scalar:
        """Density of ``base`` in its frame."""
        frame = tangent_frame(self.normal, self.rotation)
        return self.base.masked_density(to_local(frame, wi), to_local(frame, wo))

    def weight(self, wo: Direction) -> Scalar:
        """Weight of ``base`` in its frame."""
        local = to_local(tangent_frame(self.normal, self.rotation), wo)
        return jnp.where(local[2] > 0, self.base.weight(jnp.where(local[2] > 0, local, wo)), 0.0)
