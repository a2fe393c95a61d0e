"""``python -m axffit``: the command line."""

from axffit.cli import main

main()
