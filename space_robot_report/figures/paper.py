"""One figure of a paper as a picture: panels over time, then charts of numbers, grids and maps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.colors import is_color_like

from space_robot_msgs_py.errors import LogError, SpecError
from space_robot_report.figures.chart import draw_chart, plain
from space_robot_report.figures.curves import Curve, curves_of
from space_robot_report.figures.grid import draw_grid
from space_robot_report.figures.pictures import own_settings, plt
from space_robot_report.figures.stability_map import draw_stability
from space_robot_studies.reproduce.manifest import Drawing, Figure
from space_robot_studies.reproduce.reproduction import FigureResult

WIDTH, HEIGHT, ALONE = 8.0, 2.6, 4.0
LOOK = {
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "font.size": 9.5,
    "grid.alpha": 0.3,
    "legend.fontsize": "small",
    "legend.frameon": False,
}
# A legend longer than this stands beside nothing but itself.
MAX_LEGEND = 14


def check_colors(figure: Figure, key: str) -> None:
    """Refuse a color that matplotlib does not know.

    Raises:
        SpecError: with the key path.
    """
    for part in ("panels", "charts"):
        for index, drawing in enumerate(getattr(figure, part)):
            for name, style in drawing.style.items():
                if style.color is not None and not is_color_like(style.color):
                    where = f"{key}.{part}.{index}.style.{name}"
                    raise SpecError("not a color", key=where, value=style.color, accepted="red, '#a0b0c0', C0, ...")


def draw_figure(result: FigureResult, path: Path) -> bool:
    """Draw a finished figure into a PNG file.

    Returns:
        Whether there was anything to draw.

    Raises:
        LogError: the picture cannot be written.
    """
    figure = result.figure
    rows = len(figure.panels) + len(figure.charts) + len(figure.grids) + len(figure.maps)
    if not rows:
        return False
    with own_settings(LOOK):
        size = (WIDTH, ALONE if rows == 1 else HEIGHT * rows)
        picture, axes = plt.subplots(rows, 1, figsize=size, layout="constrained", squeeze=False)
        try:
            free = iter(axes[len(figure.panels) :, 0])
            _draw_panels(result, axes[: len(figure.panels), 0])
            for chart in figure.charts:
                axis = next(free)
                draw_chart(axis, chart, result)
                _dress(axis, chart, str(chart.measure.quantity))
            for grid in figure.grids:
                draw_grid(next(free), grid, result)
            for wanted in figure.maps:
                draw_stability(next(free), wanted)
            picture.savefig(path, dpi=130, format="png")
        except OSError as error:
            raise LogError(f"the picture cannot be written: {error.strerror or error}", key=str(path)) from None
        finally:
            plt.close(picture)
    return True


def _draw_panels(result: FigureResult, axes: Any) -> None:
    for axis, panel in zip(axes, result.figure.panels, strict=True):
        for index, curve in enumerate(curves_of(panel, result)):
            # What the manifest names first lies on top.
            _draw_curve(axis, curve, 3.0 / (1 + index) + 1.0)
        axis.margins(x=0.0)
        axis.set_xlim(left=panel.after or None, right=panel.before)
        _dress(axis, panel, ", ".join(panel.signals))
    for axis, panel in zip(axes[:-1], result.figure.panels[:-1], strict=True):
        last = result.figure.panels[-1]
        if (panel.after, panel.before) == (last.after, last.before):
            axis.sharex(axes[-1])
            axis.tick_params(labelbottom=False)
        else:
            axis.set_xlabel("time [s]")
    if len(axes):
        axes[-1].set_xlabel("time [s]")


def _draw_curve(axis: Any, curve: Curve, zorder: float) -> None:
    axis.plot(
        curve.time,
        curve.values,
        color=curve.color,
        linestyle=curve.line,
        linewidth=curve.width,
        alpha=curve.alpha,
        label=plain(curve.label) or "_",
        drawstyle="steps-post" if curve.held else "default",
        zorder=zorder,
    )


def _dress(axis: Any, drawing: Drawing, shown: str) -> None:
    axis.set_yscale(drawing.y_scale)
    if drawing.limits is not None:
        axis.set_ylim(*drawing.limits)
    axis.set_title(plain(drawing.label or shown), loc="left", fontsize="medium")
    handles, labels = axis.get_legend_handles_labels()
    if len(handles) > 1 or (handles and drawing.legend):
        columns = 1 + (len(handles) - 1) // MAX_LEGEND
        axis.legend(handles, labels, loc="center left", bbox_to_anchor=(1.0, 0.5), ncols=columns)
