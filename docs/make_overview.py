"""Draws docs/images/overview.png, the picture of the README: ``python docs/make_overview.py``."""

import tempfile
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from axffit import axf, fitting, measured, preview, synthesis
from axffit.measured import mbsdf
from axffit.targets import unity_2018

SIZE = 320
OUT = Path(__file__).parent / "images" / "overview.png"


def main() -> None:
    """Renders the spheres and sets them side by side."""
    with tempfile.TemporaryDirectory() as folder:
        packages = Path(folder)
        synthesis.generate(packages, size=512, packages=("brushed_carbon", "noisy_car_paint"))
        carbon = axf.read(packages / "brushed_carbon" / "brushed_carbon.axf").material()
        samples_file = packages / "noisy_car_paint" / "noisy_car_paint.mbsdf"
        table, samples = mbsdf.interpolant(samples_file), measured.read(samples_file)
    packed = unity_2018.pack(carbon)
    fitted = fitting.fit("carpaint+coat", samples)
    if fitted.model is None or fitted.metrics is None:
        raise RuntimeError(f"the bundled samples were not fitted: {fitted.outcome.value}")
    error = 100 * fitted.metrics.relative_cosine_rms
    spheres = [
        ("an AxF material", preview.render_sphere(carbon, size=SIZE, repeats=2.0)),
        ("packed for Unity", preview.render_sphere(packed, size=SIZE, repeats=2.0)),
        ("a sampled car paint, 1 % noise", preview.render_scene(table, preview.sphere_scene(SIZE)).base),
        (
            f"lobes and color table fitted, {error:.1f} % off",
            preview.render_scene(fitted.model, preview.sphere_scene(SIZE)).base,
        ),
    ]
    figure = Figure(figsize=(4 * 3.2, 3.6), dpi=100)
    FigureCanvasAgg(figure)
    for k, (caption, radiance) in enumerate(spheres):
        axes = figure.add_axes((0.25 * k + 0.005, 0.11, 0.24, 0.88))
        axes.imshow(preview.to_display(radiance))
        axes.set_axis_off()
        axes.set_title(caption, y=-0.11, fontsize=11)
    OUT.parent.mkdir(exist_ok=True)
    figure.savefig(OUT, metadata={"Software": None})


if __name__ == "__main__":
    main()
