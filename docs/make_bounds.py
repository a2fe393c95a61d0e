"""Writes the table of `docs/bounds.md`: [found, bound], their ratio, boxes and seconds of every class."""

import time
from pathlib import Path

from axffit.brdf import Schlick1994
from axffit.quantization.bounds import LOBES, Form, advised, bracket

ROUGHNESSES = (0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3, 0.6, 1.0)
REFLECTANCES = (0.04, 1.0)
START, END = "<!-- table -->\n", "<!-- end of table -->\n"


def table() -> str:
    """As Markdown; the first class of a model, which waits for JAX to compile, is computed twice."""
    lines = [
        f"| model | alpha | F0 | {' | '.join(f'({k}) found | ({k}) bound | ratio | boxes' for k in 'bc')} | CPU s |",
        "|---" * 12 + "|",
    ]
    for model in LOBES:
        bracket(Form(specular=model, fresnel=Schlick1994), advised(ROUGHNESSES[0]))
        for alpha in ROUGHNESSES:
            for f0 in REFLECTANCES:
                start = time.process_time()
                both = bracket(Form(specular=model, fresnel=Schlick1994), advised(alpha, f0))
                seconds = time.process_time() - start
                cells = [
                    f"{one.found:.3e} | {one.bound:.3e} | {one.bound / one.found:.3f} | {one.boxes}"
                    for one in (both["peak_relative"], both["log_ratio"])
                ]
                lines.append(f"| {model.__name__} | {alpha} | {f0} | {' | '.join(cells)} | {seconds:.1f} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    page = Path(__file__).with_name("bounds.md")
    before, rest = page.read_text(encoding="utf-8").split(START)
    _, after = rest.split(END)
    page.write_text(before + START + table() + END + after, encoding="utf-8")
