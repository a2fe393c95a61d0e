"""The command line: one file a verb, each with a ``run(...)`` that needs no command line.

Nothing here imports JAX, HDF5 or matplotlib before a verb runs, so that help is there at once.
Exit codes: 0 done or within tolerance, 1 outside tolerance or not converged, 2 unusable input, 70 a fault of axffit.
"""

import sys
import traceback
from collections.abc import Sequence

from axffit.errors import InputError

UNUSABLE_INPUT = 2
# Not 1, which a script would take for a verdict; the number is EX_SOFTWARE of sysexits.h.
FAULT_OF_AXFFIT = 70


def main(arguments: Sequence[str] | None = None) -> None:
    """Runs the command line and leaves the process with its exit code.

    Args:
        arguments: what follows the program's name; None takes them from the process.
    """
    from axffit.cli._environment import prepare_environment

    prepare_environment()
    try:
        code = dispatch(sys.argv[1:] if arguments is None else arguments)
    except Exception as fault:
        traceback.print_exc()
        print("axffit: this is a fault of axffit, not of your input: please report the lines above", file=sys.stderr)
        raise SystemExit(FAULT_OF_AXFFIT) from fault
    sys.exit(code)


def dispatch(arguments: Sequence[str]) -> int:
    """Runs one command and returns its exit code; bad input becomes one line on stderr, a fault of axffit is raised.

    Args:
        arguments: what follows the program's name.
    """
    from axffit.cli.app import app

    try:
        app(list(arguments), prog_name="axffit")
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    except InputError as error:
        return _refuse(str(error))
    except OSError as error:
        named = f"{error.filename}: {error.strerror}" if error.filename else str(error)
        return _refuse(f"{named} (check the path and its permissions)")
    return 0


def _refuse(message: str) -> int:
    print("axffit:", " ".join(message.split()), file=sys.stderr)
    return UNUSABLE_INPUT
