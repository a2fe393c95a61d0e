"""What a verb prints: the short form of its JSON."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

Content = Mapping[str, Any]

_NEVER_WRAP = 10_000
"""Characters a line: a number cut to fit a terminal is no number."""


def show(*parts: object) -> None:
    """Prints to stdout; nothing is cut or wrapped to the terminal's width, and no value is read as markup."""
    console = Console(width=_NEVER_WRAP, highlight=False, markup=False, emoji=False)
    for part in parts:
        console.print(part, soft_wrap=not isinstance(part, Table))


def table(columns: Iterable[str], rows: Iterable[Iterable[str]], *, text_columns: int = 1) -> Table:
    """A plain table; all but the first `text_columns` columns are numbers, aligned right."""
    made = Table(box=None, pad_edge=False, header_style="bold")
    for index, column in enumerate(columns):
        made.add_column(column, justify="left" if index < text_columns else "right", no_wrap=True)
    for row in rows:
        made.add_row(*row)
    return made


def verdict_parts(content: Content) -> list[object]:
    """A verdict: one row a texture, the levels above the textures, what is wrong, and the outcome."""
    from axffit.report.numbers import number, percent, significant
    from axffit.report.summary import engines

    rows = [
        (
            row["axf_name"] + (" (default)" if row["defaulted"] else ""),
            row["format"],
            " ".join(filter(None, (row["quantity"].replace("_", " "), _in_parentheses(row["unit"])))),
            *(significant(row[name]) for name in ("mean", "p95", "max")),
            number(row["tolerance"]),
            str(row["clamped"]),
            "within" if row["within"] else "OUTSIDE",
        )
        for row in content["textures"]
    ]
    columns = ("texture", "format", "error", "mean", "95 %", "max", "tolerance", "clamped", "")
    parts: list[object] = [
        f"{content['material']['name'] or content['material']['id']}, {engines(content)}",
        table(columns, rows, text_columns=3),
    ]
    parts += [
        f"reflectance, {row['title']}: {_bracket(row)} "
        f"(tolerance {number(row['tolerance'])}), " + ("within" if row["within"] else "OUTSIDE")
        for row in content["brdf"]["rows"]
    ]
    colors = [f"{each['illuminant']} {significant(each['max'], 2)}" for each in content["brdf"]["colors"]]
    if colors:
        parts.append(f"reflected color, largest dE2000 found: {', '.join(colors)}")
    expected = [f"{each['lighting']} {percent(each['light'], 2)}" for each in content["brdf"]["expected"]]
    if expected:
        parts.append(f"reflected light, expected error: {', '.join(expected)}")
    if not content["brdf"]["evaluated"]:
        parts.append(f"reflectance: not evaluated, {content['brdf']['reason']}")
    if content["lut"] is not None:
        lost = ", ".join(
            f"{check['check'].removeprefix('lut.')} {check['found']:.0f}" for check in content["lut"]["checks"]
        )
        parts.append(f"slice table: slices a shader does not find again: {lost}")
    parts += [f"note: {note}" for note in content["notes"]]
    parts += [f"OUTSIDE: {failure}" for failure in content["failures"]]
    return [*parts, content["summary"]]


def _bracket(row: Content) -> str:
    """[found, bound], or what was found and why there is no bound."""
    from axffit.report.numbers import significant

    if row["judged"] == "bound":
        return f"[found, bound] = [{significant(row['found'])}, {significant(row['bound'])}]"
    return f"{significant(row['found'])}, found only: {row['unproved']}"


def judged_parts(document: Content) -> list[object]:
    """Verdicts: all of it for a single one; else each one's summary, what is outside below it, and the outcome."""
    materials = document["materials"]
    if len(materials) == 1:
        return verdict_parts(materials[0]["verdict"])
    parts: list[object] = []
    for entry in materials:
        parts.append(f"{entry['file']}: {entry['verdict']['summary']}")
        parts += [f"  OUTSIDE: {failure}" for failure in entry["verdict"]["failures"]]
    return [*parts, document["summary"]]


def fit_parts(content: Content) -> list[object]:
    """A fit: its parameters with their standard errors, its metrics, and how it ended."""
    from axffit.report.numbers import significant

    rows = [
        (
            parameter["name"],
            parameter["status"],
            significant(parameter["value"]),
            "" if parameter["standard_error"] is None else f"± {significant(parameter['standard_error'], 2)}",
        )
        for parameter in content["parameters"]
    ]
    parts: list[object] = [f"{content['model']} fitted to {content['samples'].get('name') or 'samples'}"]
    if rows:
        parts.append(table(("parameter", "", "value", "standard error"), rows, text_columns=2))
    if content["metrics"] is not None:
        parts.append(metrics_line(content["metrics"]))
    parts += [f"note: {note}" for note in content["notes"]]
    return [*parts, content["advice"]]


def comparison_parts(content: Content, title: str) -> list[object]:
    """A comparison: its metrics overall and by region, and where the model fails."""
    from axffit.report.numbers import percent

    def degrees(pair: Sequence[float]) -> str:
        return f"{pair[0]:g} to {pair[1]:g}"

    rows = [
        (
            region["name"],
            degrees(region["theta_h_degrees"]),
            degrees(region["polar_degrees"]),
            percent(region["metrics"]["relative_cosine_rms"]),
            percent(region["bias"]),
            percent(region["log_share"]),
        )
        for region in content["regions"]
    ]
    columns = ("region", "theta_h (degrees)", "polar (degrees)", "relative error", "bias", "share of the log error")
    return [title, table(columns, rows), metrics_line(content["metrics"]), content["sentence"]]


def metrics_line(metrics: Content) -> str:
    """The metrics of a model on samples."""
    from axffit.report.numbers import count, percent, significant

    return (
        f"relative cosine RMS error {percent(metrics['relative_cosine_rms'])}, of the peak {percent(metrics['peak'])}, "
        f"log {significant(metrics['log'])}, cube root {significant(metrics['cube_root'])}, "
        f"on {count(metrics['sample_count'])} samples"
    )


def value_text(value: Any, *, exact: bool = False) -> str:
    """A property's value: floats to three digits, or to all nine of a float32; the zeros that end a list counted."""
    from axffit.report.numbers import significant

    if isinstance(value, list):
        end = len(value)
        while end > 1 and value[end - 1] == 0 and value[end - 2] == 0:
            end -= 1
        zeros = [f"{len(value) - end} more zeros"] if end < len(value) else []
        return "[" + ", ".join([*(value_text(each, exact=exact) for each in value[:end]), *zeros]) + "]"
    if isinstance(value, float):
        return f"{value:.9g}" if exact else significant(value)
    return "-" if value is None else str(value)


def _in_parentheses(text: str) -> str:
    return f"({text})" if text else ""
