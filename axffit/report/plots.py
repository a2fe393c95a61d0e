"""Plots as inline SVG: matplotlib's object interface, no pyplot, no state left behind.

The SVG takes the page's own text color and font (``currentColor``, inherited font), so it follows a light or a dark
page; it has no size of its own and fills its column.
"""

import io
import re
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator

from axffit.report.numbers import number

INK = "#010203"
"""Stands for the page's text color until the SVG is written."""

SERIES = ("#3b6fb6", "#1f9c94", "#8aa03a", "#d9912b", "#c4473a")
"""One color an angle of incidence, from steep to grazing; readable on white and on near-black."""

_STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "font.size": 10.0,
    "axes.facecolor": "none",
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": INK,
    "grid.alpha": 0.14,
    "grid.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
}


def to_svg(figure: Figure, *, label: str) -> str:
    """The figure as an ``<svg>`` element with an accessible ``label``; the same figure gives the same text."""
    stream = io.StringIO()
    figure.patch.set_alpha(0.0)
    with matplotlib.rc_context({**_STYLE, "svg.hashsalt": label}):
        FigureCanvasSVG(figure).print_svg(stream, metadata={"Date": None, "Creator": None})
    svg = stream.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    # Sizes in px of the view box; the family is the page's.
    svg = re.sub(r"font: (?:\w+ )*([\d.]+px)[^;\"]*", r"font-size: \1", svg)
    svg = svg.replace(INK, "currentColor")
    width, height = (float(x) for x in re.findall(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', svg)[0])
    opening = (
        f'<svg class="plot" role="img" viewBox="0 0 {width:g} {height:g}" xmlns:xlink="http://www.w3.org/1999/xlink">'
    )
    title = f"<title>{_escape(label)}</title>"
    return re.sub(r"<svg[^>]*>", lambda _: opening + title, svg, count=1).strip()


def _escape(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")


def _figure(width: float, height: float) -> Figure:
    with matplotlib.rc_context(_STYLE):
        return Figure(figsize=(width, height), layout="constrained")


def _shown_angles(view: np.ndarray, incidence: float) -> np.ndarray:
    """Which view angles get a dot: every 5°, and every 1° within 6° of the mirror direction, where lobes are narrow."""
    near = np.abs(view - incidence) <= 6.0
    step = np.where(near, 1.0, 5.0)
    offset = np.where(near, view - incidence, view)
    return np.abs(offset / step - np.round(offset / step)) < 1e-6


def lobes_log(curves: list[dict[str, Any]], *, label: str) -> str:
    """Lobes in the plane of incidence over the view angle, logarithmic: dots measured, lines modeled."""
    with matplotlib.rc_context(_STYLE):
        figure = _figure(5.4, 3.7)
        axes = figure.add_subplot()
        top = max(max(curve["measured"] + curve["modeled"]) for curve in curves)
        low = max(min(min(x for x in curve["modeled"] if x > 0) for curve in curves) / 2.5, top * 1e-5)
        for color, curve in zip(SERIES, curves, strict=False):
            view, incidence = np.array(curve["view_degrees"]), curve["incidence_degrees"]
            measured, modeled = np.array(curve["measured"]), np.array(curve["modeled"])
            dots = _shown_angles(view, incidence) & (measured > 0)
            axes.plot(
                view, np.where(modeled > 0, modeled, np.nan), color=color, linewidth=1.4, label=f"{incidence:.0f}°"
            )
            axes.plot(view[dots], measured[dots], "o", color=color, markersize=3.0, markerfacecolor="none", mew=0.9)
        axes.set_yscale("log")
        axes.set_ylim(low, top * 2.0)
        axes.set_xlim(-90, 90)
        axes.xaxis.set_major_locator(FixedLocator(range(-90, 91, 30)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:.0f}°".replace("-", "−")))
        # Where the axis spans few decades, 2 and 5 are labeled too.
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0,) if top > 300 * low else (1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: number(y)))
        axes.yaxis.set_minor_formatter(FuncFormatter(lambda y, _: ""))
        axes.grid(visible=True)
        axes.set_xlabel("view angle (light on the negative side)")
        axes.set_ylabel("luminance of f, 1/sr")
        axes.legend(title="incidence", frameon=False, fontsize=9, title_fontsize=9, loc="upper left", handlelength=1.2)
        return to_svg(figure, label=label)


LONGEST = 3.0
"""The polar plot shows lobes up to this many times the middle one."""


def lobes_polar(curves: list[dict[str, Any]], *, label: str) -> str:
    """The same lobes as a half circle; the radius is the cube root of f, so that diffuse part and peak both show.

    Drawn on plain axes: the half circle then fills its column, and labels stand where there is room.
    """
    with matplotlib.rc_context(_STYLE):
        figure = _figure(5.4, 3.2)
        axes = figure.add_subplot()
        peaks = sorted(max(curve["measured"] + curve["modeled"]) for curve in curves)
        # Lobes at grazing incidence may be ten times as long as the others: they are cut at the outer circle.
        shown = min(peaks[-1], LONGEST * peaks[len(peaks) // 2])
        top = float(np.cbrt(shown))
        _polar_grid(axes, top)
        outline = Circle((0.0, 0.0), top, transform=axes.transData)
        for color, curve in zip(SERIES, curves, strict=False):
            view, incidence = np.array(curve["view_degrees"]), curve["incidence_degrees"]
            measured, modeled = (np.cbrt(np.maximum(curve[name], 0.0)) for name in ("measured", "modeled"))
            dots = _shown_angles(view, incidence)
            (line,) = axes.plot(*_point(view, modeled), color=color, linewidth=1.4)
            line.set_clip_path(outline)
            dots &= measured <= top
            x, y = _point(view[dots], measured[dots])
            axes.plot(x, y, "o", color=color, markersize=3.0, markerfacecolor="none", mew=0.9)
            end, start = (_point(-incidence, r * top) for r in (1.02, 1.13))
            axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": color, "lw": 1.2, "shrinkA": 0})
        axes.set_xlim(-1.18 * top, 1.18 * top)
        axes.set_ylim(-0.24 * top, 1.18 * top)
        axes.set_aspect("equal")
        axes.set_axis_off()
        return to_svg(figure, label=label)


def _point(degrees: Any, radius: Any) -> tuple[Any, Any]:
    """Position of a direction at an angle from the normal, which points up."""
    angle = np.radians(degrees)
    return radius * np.sin(angle), radius * np.cos(angle)


def _polar_grid(axes: Axes, top: float) -> None:
    """Half circles at round values of f, rays every 30°, labels."""
    line = {"color": INK, "linewidth": 0.6, "zorder": 0}
    arc = np.linspace(-90, 90, 181)
    axes.plot(*_point(arc, top), alpha=0.35, **line)
    axes.plot([-top, top], [0, 0], alpha=0.5, **line)
    for value in _round_values(top**3):
        radius = np.cbrt(value)
        axes.plot(*_point(arc, radius), alpha=0.14, **line)
        axes.text(radius, -0.025 * top, number(value), ha="center", va="top", fontsize=8.5)
    axes.text(0.0, -0.13 * top, "f in 1/sr, radius its cube root; arrows: light", ha="center", va="top", fontsize=8.5)
    for degrees in range(-60, 61, 30):
        axes.plot(*zip((0.0, 0.0), _point(degrees, top), strict=True), alpha=0.14, **line)
        if degrees >= 0:
            x, y = _point(degrees, 1.03 * top)
            axes.text(x, y, f"{degrees}°", ha="center" if degrees == 0 else "left", va="bottom", fontsize=8.5)


def _round_values(top: float) -> list[float]:
    """Round values up to ``top`` whose cube roots are far enough apart to be labeled."""
    values: list[float] = []
    for share in (0.4, 0.7, 0.97):
        wanted = top * share**3
        power = 10.0 ** np.floor(np.log10(wanted))
        values.append(float(max(m * power for m in (1, 2, 5) if m * power <= wanted)))
    return sorted(set(values))


DIVERGING = ListedColormap(np.array(matplotlib.colormaps["RdBu_r"](np.linspace(0.06, 0.94, 256)))[:, :3])

RATIOS = (1.1, 1.25, 1.5, 2.0, 4.0, 8.0)
"""Ends of the scale of the failure map."""


def failure_heat_map(cells: dict[str, Any], *, label: str) -> str:
    """Mean log2(model / data) over half and difference angle; red where the model is too bright, blue too dark."""
    with matplotlib.rc_context(_STYLE):
        figure = _figure(5.4, 3.2)
        axes = figure.add_subplot()
        ratio = np.array([[np.nan if x is None else x for x in row] for row in cells["log2_ratio"]], float)
        half, difference = np.array(cells["half_edges_degrees"]), np.array(cells["difference_edges_degrees"])
        worst = 2.0 ** float(np.nanmax(np.abs(ratio))) if np.isfinite(ratio).any() else 1.0
        end = next((r for r in RATIOS if r >= worst), RATIOS[-1])
        limit = float(np.log2(end))
        mesh = axes.pcolormesh(
            np.sqrt(half / 90.0),
            difference,
            ratio,
            cmap=DIVERGING,
            norm=Normalize(-limit, limit),
            edgecolors="face",
            lw=0.2,
        )
        axes.patch.set(facecolor=INK, alpha=0.10)
        _angle_axes(axes)
        bar = figure.colorbar(mesh, ax=axes, pad=0.02, aspect=14, extend="both" if worst > end else "neither")
        bar.ax.yaxis.set_major_locator(FixedLocator([-limit, -limit / 2, 0.0, limit / 2, limit]))
        bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"× {number(2.0**y)}"))
        bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue]
        return to_svg(figure, label=label)


def _angle_axes(axes: Axes) -> None:
    """Half angle, dense at the mirror direction, against difference angle."""
    axes.set_xlim(0, 1)
    _half_angle_axis(axes)
    axes.yaxis.set_major_locator(FixedLocator(range(0, 91, 30)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:.0f}°"))
    axes.set_ylabel("difference angle")


def _half_angle_axis(axes: Axes) -> None:
    axes.xaxis.set_major_locator(FixedLocator(list(np.sqrt(np.array([0, 2, 5, 10, 20, 40, 60, 90]) / 90.0))))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{90 * x * x:.0f}°"))
    axes.set_xlabel("half angle (0°: the mirror direction)")


def coverage_heat_map(cells: dict[str, Any], *, label: str) -> str:
    """How many samples each cell of half and difference angle holds, logarithmic; cells without any are gray."""
    with matplotlib.rc_context(_STYLE):
        figure = _figure(5.4, 3.2)
        axes = figure.add_subplot()
        counts = np.array(cells["counts"], float)
        half, difference = np.array(cells["half_edges_degrees"]), np.array(cells["difference_edges_degrees"])
        shown = np.log10(np.where(counts > 0, counts, np.nan))
        top = max(float(np.log10(max(counts.max(), 1.0))), 0.5)
        mesh = axes.pcolormesh(
            np.sqrt(half / 90.0), difference, shown, cmap="viridis", norm=Normalize(0.0, top), edgecolors="face", lw=0.2
        )
        axes.patch.set(facecolor=INK, alpha=0.10)
        _angle_axes(axes)
        bar = figure.colorbar(mesh, ax=axes, pad=0.02, aspect=14)
        bar.ax.yaxis.set_major_locator(FixedLocator(range(int(top) + 1)))
        bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda y, _: number(10.0**y)))
        bar.set_label("samples")
        bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue]
        return to_svg(figure, label=label)


def value_scatter(points: dict[str, list[float]], *, label: str) -> str:
    """Samples over the half angle, logarithmic, colored by the difference angle; values of 0 and below are left out."""
    with matplotlib.rc_context(_STYLE):
        figure = _figure(5.4, 3.2)
        axes = figure.add_subplot()
        half, difference, value = (np.array(points[key]) for key in ("half_degrees", "difference_degrees", "value"))
        kept = value > 0
        dots = axes.scatter(
            np.sqrt(half[kept] / 90.0), value[kept], c=difference[kept], s=4.0, cmap="viridis", vmin=0, vmax=90, lw=0
        )
        axes.set_yscale("log")
        axes.set_xlim(0, 1)
        _half_angle_axis(axes)
        wide = value[kept].max() > 300 * value[kept].min()
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0,) if wide else (1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: number(y)))
        axes.yaxis.set_minor_formatter(FuncFormatter(lambda y, _: ""))
        axes.grid(visible=True)
        axes.set_ylabel("f, 1/sr")
        bar = figure.colorbar(dots, ax=axes, pad=0.02, aspect=14)
        bar.ax.yaxis.set_major_locator(FixedLocator(range(0, 91, 30)))
        bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:.0f}°"))
        bar.set_label("difference angle")
        bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue]
        return to_svg(figure, label=label)


def furnace_curve(rows: list[dict[str, Any]], *, label: str) -> str:
    """Albedo over the incidence: a line a channel for RGB, the mean, least and largest of more channels."""
    with matplotlib.rc_context(_STYLE):
        figure = _figure(5.4, 3.2)
        axes = figure.add_subplot()
        incidence = np.array([np.mean(row["incidence_degrees"]) for row in rows])
        albedo = np.array([row["albedo"] for row in rows])
        if albedo.shape[1] == 3:
            lines = list(zip(("red", "green", "blue"), (SERIES[4], SERIES[1], SERIES[0]), albedo.T, strict=True))
        else:
            named = (("largest", albedo.max), ("mean", albedo.mean), ("least", albedo.min))
            lines = [(name, SERIES[k], found(axis=1)) for k, (name, found) in enumerate(named)]
        for name, color, values in lines:
            axes.plot(incidence, values, "o-", color=color, linewidth=1.4, markersize=3.0, label=name)
        axes.axhline(1.0, color=INK, linewidth=0.8, alpha=0.5, linestyle="--")
        axes.set_xlim(0, 90)
        axes.set_ylim(bottom=min(0.0, float(albedo.min())))
        axes.xaxis.set_major_locator(FixedLocator(range(0, 91, 30)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:.0f}°"))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: number(y)))
        axes.grid(visible=True)
        axes.set_xlabel("polar angle of the light")
        axes.set_ylabel("albedo")
        axes.legend(frameon=False, fontsize=9)
        return to_svg(figure, label=label)
