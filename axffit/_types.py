"""Array aliases shared by every module; shapes are documented by the annotation."""

from jaxtyping import Array, Float, Int

Scalar = Float[Array, ""]
Direction = Float[Array, "3"]
Directions = Float[Array, "*batch 3"]
RGB = Float[Array, "3"]
Channels = Float[Array, "*batch 3"]
Angles = Float[Array, "*batch"]
Indices = Int[Array, "*batch"]
