"""Write the synthetic packages: ``python data_synthetic/generate.py [--size 64|512] [--out DIR]``.

The files beside this script are those of size 64. Everything is made by the seeded generator in ``axffit.synthesis``
and labeled synthetic in the files.
"""

import argparse
from pathlib import Path

from axffit.synthesis import generate


def main() -> None:
    """Parse the command line, write the packages and name the files."""
    parser = argparse.ArgumentParser(description="Write axffit's synthetic packages.")
    parser.add_argument("--size", type=int, choices=(64, 512), default=64, help="texels along each side")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent, help="folder to write to")
    arguments = parser.parse_args()
    for path in generate(arguments.out, size=arguments.size):
        print(f"{path} ({path.stat().st_size / 1024:.0f} KiB)")


if __name__ == "__main__":
    main()
