"""The preview: a contact sheet of the recordings, with what moves and the likely crop drawn in."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from physpipe.core.geometry import Geometry
from physpipe.io.atomic import replacing
from physpipe.probing.findings import Finding
from physpipe.probing.movers import Spot
from physpipe.report import colours

SHOWN = 3
"""Frames of every recording."""
ROWS = 24
"""Recordings on a sheet, at most."""
WIDTH_INCHES, DPI = 14.0, 100
MOVES = "#ff2020"
"""Colour of the outline of all that moves, objects or not."""
LEAST_RADIUS_PX = 3.0


def save(path: Path, found: Sequence[Finding], geometries: Sequence[Geometry]) -> None:
    """Writes a PNG with a row a recording.

    Frames with what moves outlined and objects circled, then all places of the objects on the still background.
    """
    rows = list(zip(found, geometries, strict=True))[:ROWS]
    column = WIDTH_INCHES / (SHOWN + 1)
    heights = [column * each.film.height / each.film.width + 0.3 for each, _ in rows]
    figure = Figure(figsize=(WIDTH_INCHES, sum(heights)), dpi=DPI, layout="constrained")
    panels = figure.subplots(len(rows), SHOWN + 1, squeeze=False, gridspec_kw={"height_ratios": heights})
    for line, (finding, geometry) in zip(panels, rows, strict=True):
        _row(list(line), finding, geometry)
    with replacing(path) as temporary:
        FigureCanvasAgg(figure).print_png(temporary)


def _row(panels: Sequence[Axes], finding: Finding, geometry: Geometry) -> None:
    pairs = finding.film.pairs
    chosen = np.linspace(0, len(pairs) - 1, SHOWN + 2).round().astype(int)[1:-1]
    for number, at in enumerate(chosen):
        axes, picture = panels[number], pairs[at].first
        _show(axes, finding, picture, geometry)
        where = _when(finding, pairs[at].place)
        axes.set_title(f"{finding.source}, {where}" if number == 0 else where, fontsize=8)
        if finding.movers is not None:
            covered, _ = finding.scene.covered(finding.scene.first[at])
            if covered.any():
                axes.contour(covered, [0.5], colors=MOVES, linewidths=0.8)
            _circle(axes, finding.movers.objects[at])
    _show(panels[-1], finding, finding.scene.background, geometry)
    panels[-1].set_title("every place, early blue to late yellow", fontsize=8)
    if finding.movers is not None:
        spots = [(pair.place, *spot) for pair, each in zip(pairs, finding.movers.objects, strict=True) for spot in each]
        when, x, y, *_ = np.array(spots).T
        panels[-1].scatter(x, y, c=when, s=14, cmap="plasma", vmin=0, vmax=1, edgecolors="white", linewidths=0.4)


def _when(finding: Finding, place: float) -> str:
    length_s = finding.film.clock.length_s
    return f"{place * length_s:.1f} s" if np.isfinite(length_s) else f"image {round(place * finding.film.clock.frames)}"


def _show(axes: Axes, finding: Finding, picture: np.ndarray, geometry: Geometry) -> None:
    axes.imshow(picture)
    axes.set_axis_off()
    corner = (geometry.left / finding.film.reduction - 0.5, geometry.top / finding.film.reduction - 0.5)
    width, height = geometry.crop_width / finding.film.reduction, geometry.crop_height / finding.film.reduction
    for colour, line, style in (("black", 2.5, "-"), ("white", 1.2, "--")):
        axes.add_patch(Rectangle(corner, width, height, fill=False, edgecolor=colour, linewidth=line, linestyle=style))


def _circle(axes: Axes, spots: Sequence[Spot]) -> None:
    for spot in spots:
        for edge, line in (("black", 2.5), (colours.OBJECTS[0], 1.3)):
            radius = max(spot.diameter / 2, LEAST_RADIUS_PX)
            axes.add_patch(Circle((spot.x, spot.y), radius, fill=False, edgecolor=edge, linewidth=line))
