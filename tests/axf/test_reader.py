import numpy as np

from axffit import axf


def test_a_file_with_awkward_names_comes_back(tmp_path):
    ior = axf.AxfTexture((np.full((1, 1, 1), 1.5, np.float16),))
    material = axf.AxfMaterial(
        "a/b%..", "näme", axf.MaterialKind.SVBRDF, textures={"clearcoatior": ior}, metadata={"x/y": ""}
    )
    axf.write(tmp_path / "a.axf", material)
    assert axf.read(tmp_path / "a.axf").material().identical(material)
