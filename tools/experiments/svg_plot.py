# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots over a common horizontal axis, one panel above the other, as SVG that needs nothing else.

White ground and own colours, so that a page in dark mode shows them as one in light mode does.
"""
import math
from dataclasses import dataclass, field
from xml.sax.saxutils import escape

WIDTH, LEFT, RIGHT, TOP, BOTTOM, GAP = 960, 66, 244, 62, 52, 34
TEXT, QUIET, GRID, FRAME = "#1b1f24", "#57606a", "#e3e6ea", "#8c959f"


@dataclass
class Series:
    """Points (x, y); y None where nothing is known, which interrupts the line."""
    label: str
    points: list
    colour: str
    kind: str = "line"  # line; steps: a value holds until the next; marks: rings; ticks: triangles on the axis
    dash: str = ""
    width: float = 2.0


@dataclass
class Panel:
    label: str
    series: list = field(default_factory=list)
    height: int = 170


def nice_ticks(high, most=5):
    """0 and steps of 1, 2 or 5 times a power of ten, the last at or above `high`."""
    high = max(high, 1)
    step = 10 ** math.floor(math.log10(high / most)) if high > most else 1
    while math.ceil(high / step) > most:
        leading = round(step / 10 ** math.floor(math.log10(step)))
        step = step * 5 // 2 if leading == 2 else step * 2
    step = max(int(step), 1)
    return [step * i for i in range(math.ceil(high / step) + 1)]


def _text(x, y, words, *, size=13, anchor="start", colour=TEXT, extra=""):
    return (f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{colour}"{extra}>'
            f"{escape(words)}</text>")


def _runs(points):
    """Stretches of points without gaps."""
    run = []
    for point in points:
        if point[1] is None:
            if run:
                yield run
            run = []
        else:
            run.append(point)
    if run:
        yield run


class _Frame:
    """Where a panel's data go on the page."""

    def __init__(self, top, height, x_high, y_high):
        self.top, self.height, self.x_high, self.y_high = top, height, x_high, y_high

    def x(self, value):
        return LEFT + (WIDTH - LEFT - RIGHT) * value / self.x_high

    def y(self, value):
        return self.top + self.height * (1 - value / self.y_high)

    def bottom(self):
        return self.top + self.height


def _path(frame, run, steps):
    words = [f"M{frame.x(run[0][0]):.1f},{frame.y(run[0][1]):.1f}"]
    for x, y in run[1:]:
        if steps:
            words.append(f"H{frame.x(x):.1f}V{frame.y(y):.1f}")
        else:
            words.append(f"L{frame.x(x):.1f},{frame.y(y):.1f}")
    return "".join(words)


def _ring(x, y, colour):
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="#ffffff" stroke="{colour}" stroke-width="2"/>'


def _triangle(x, y, colour):
    return f'<path d="M{x:.1f},{y - 9:.1f}l5,9h-10z" fill="{colour}"/>'


def _stroke(series):
    if series.kind == "marks":  # the rings are what was measured
        return f' stroke="{series.colour}" stroke-width="1.2" stroke-opacity="0.5"'
    dash = f' stroke-dasharray="{series.dash}"' if series.dash else ""
    return f' stroke="{series.colour}" stroke-width="{series.width}"{dash}'


def _draw_series(frame, series):
    parts = [f'<g class="series"><title>{escape(series.label)}</title>']
    if series.kind == "ticks":
        parts += [_triangle(frame.x(x), frame.bottom(), series.colour) for x, _ in series.points]
    else:
        for run in _runs(series.points):
            parts.append(f'<path d="{_path(frame, run, series.kind == "steps")}" fill="none" '
                         f'stroke-linejoin="round"{_stroke(series)}/>')
        if series.kind == "marks":
            parts += [_ring(frame.x(x), frame.y(y), series.colour) for x, y in series.points if y is not None]
    return parts + ["</g>"]


def _draw_legend(frame, panel):
    parts, x = [], WIDTH - RIGHT + 18
    for i, series in enumerate(panel.series):
        y = frame.top + 10 + 22 * i
        if series.kind == "ticks":
            parts.append(_triangle(x + 14, y + 4, series.colour))
        else:
            parts.append(f'<path d="M{x},{y}h28" fill="none"{_stroke(series)}/>')
            if series.kind == "marks":
                parts.append(_ring(x + 14, y, series.colour))
        parts.append(_text(x + 36, y + 4.5, series.label))
    return parts


def _draw_panel(panel, top, x_high, x_ticks, last, x_label):
    known = [y for series in panel.series if series.kind != "ticks" for _, y in series.points if y is not None]
    ticks = nice_ticks(max(known, default=1), 4 if panel.height < 150 else 5)
    frame = _Frame(top, panel.height, x_high, ticks[-1])
    left, right, bottom = LEFT, WIDTH - RIGHT, frame.bottom()
    parts = [f'<g class="panel"><title>{escape(panel.label)}</title>']
    for tick in ticks:
        y = frame.y(tick)
        parts.append(f'<path d="M{left},{y:.1f}H{right}" stroke="{GRID}"/>')
        parts.append(_text(left - 8, y + 4.5, str(tick), anchor="end", colour=QUIET))
    for tick in x_ticks:
        x = frame.x(tick)
        parts.append(f'<path d="M{x:.1f},{top}V{bottom + 5}" stroke="{GRID}"/>')
        if last:
            parts.append(_text(x, bottom + 20, str(tick), anchor="middle", colour=QUIET))
    parts.append(f'<path d="M{left},{top}V{bottom}H{right}" fill="none" stroke="{FRAME}"/>')
    parts.append(_text(left, top - 9, panel.label, extra=' font-weight="600"'))
    for series in panel.series:
        parts += _draw_series(frame, series)
    parts += _draw_legend(frame, panel)
    if last:
        parts.append(_text((left + right) / 2, bottom + 42, x_label, anchor="middle"))
    return parts + ["</g>"]


def draw(title, description, x_label, x_high, panels):
    """@return an SVG document. Every panel starts at 0 and ends at or above its highest value."""
    x_high = max(x_high, 1)
    x_ticks = [tick for tick in nice_ticks(x_high, 8) if tick <= x_high]
    parts, top = [], TOP
    for panel in panels:
        parts += _draw_panel(panel, top, x_high, x_ticks, panel is panels[-1], x_label)
        top += panel.height + GAP
    height = top - GAP + BOTTOM
    head = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" '
            f'height="{height}" role="img" font-family="DejaVu Sans, Verdana, Helvetica, Arial, sans-serif">',
            f"<title>{escape(title)}</title>", f"<desc>{escape(description)}</desc>",
            f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>',
            _text(LEFT, 24, title, size=16, extra=' font-weight="600"')]
    return "\n".join(head + parts + ["</svg>"]) + "\n"
