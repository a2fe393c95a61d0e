"""Array aliases shared by every module; shapes are documented by the annotation."""

from jaxtyping import Array, Float

Scalar = Float[Array, ""]
Direction = Float[Array, "3"]
Directions = Float[Array, "... 3"]
RGB = Float[Array, "3"]
Channels = Float[Array, "... 3"]
Angles = Float[Array, "..."]
