"""For the users' own tests: the laws of reflectance as functions, and Hypothesis strategies.

- ``axffit.testing.laws``: ``law(brdf, wi, wo)`` raises ``AssertionError`` that says which pair of directions breaks
  the law and by how much. ``axffit.testing.directions`` has sets of pairs to run them on.
- ``axffit.testing.strategies``: directions, parameters, BRDFs, textures and AxF materials for Hypothesis.
- ``pytest --pyargs axffit.testing --axf paint.axf``: the laws on a material of your own (``docs/testing.md``).

Hypothesis and pytest come with the extra: ``pip install "axffit[testing]"``. pytest imports this package at every
start, so nothing is imported here.
"""
