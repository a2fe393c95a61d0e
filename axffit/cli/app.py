"""The verbs and their help."""

from typing import Annotated

import typer

from axffit import __version__
from axffit.cli import compare, demo, diff, export, fit, fit_maps, import_, inspect, measured, refit, verify

HELP = """What an AxF material reflects, which lobes explain a measurement,
what a texture format loses.

\b
Exit codes of every verb
  0   done; verify: within tolerance
  1   verify: outside tolerance; fit: not converged; diff: different
  2   unusable input: one line on stderr says which, and the mend
  70  a fault of axffit
"""

app = typer.Typer(
    name="axffit",
    help=HELP,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _show_version(wanted: bool) -> bool:  # noqa: FBT001 (typer calls it so)
    if wanted:
        typer.echo(f"axffit {__version__}")
        raise typer.Exit
    return wanted


_Version = Annotated[bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version.")]


@app.callback(help=HELP)
def root(*, version: _Version = False) -> None:
    """The options that come before a verb."""


for _name, _verb in {
    "inspect": inspect,
    "measured": measured,
    "diff": diff,
    "export": export,
    "import": import_,
    "verify": verify,
    "compare": compare,
    "fit": fit,
    "refit": refit,
    "fit-maps": fit_maps,
    "demo": demo,
}.items():
    app.command(name=_name, help=_verb.HELP)(_verb.command)
