"""Draws figures with linear axes and line drawings of nets as SVG, with numpy alone. A figure is panels over a
caption."""
import math
import os
import sys
import textwrap

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from svg import document, line, text  # noqa: E402

BLUE, RED, CYAN, BLACK, GREY, ORANGE = "#0050b0", "#d22b2b", "#00808a", "#111111", "#999999", "#d55e00"
WIDTH, LEFT, TOP, RIGHT, BOTTOM = 800, 74, 40, 20, 50


def figure(path, panels, caption, source):
    """Writes a figure. panels: list of (body, height). The caption is wrapped below them. `source` goes into the file
    as a comment."""
    body, y = [], 0
    for part, height in panels:
        body.append(f'<g transform="translate(0 {y})">' + "\n".join(part) + "</g>")
        y += height
    for words in textwrap.wrap(caption, 104):
        y += 18
        body.append(text(20, y, words, 13, "start"))
    with open(path, "w") as file:
        file.write(document(WIDTH, y + 14, body, source))


def legend(entries, x, y):
    """Draws a legend. entries: (name, colour, kind), where kind is line, dash or dot."""
    out = []
    for name, colour, kind in entries:
        if kind == "dot":
            out.append(f'<circle cx="{x + 12:.1f}" cy="{y - 4:.1f}" r="3.5" fill="{colour}"/>')
        else:
            out.append(path_of([(x, y - 4), (x + 24, y - 4)], colour, 2, kind == "dash"))
        out.append(text(x + 30, y, name, 12, "start"))
        x += 56 + 6.4 * len(name)
    return out


def path_of(points, colour, width=1.5, dashed=False):
    words = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dash = ' stroke-dasharray="6 4"' if dashed else ""
    return f'<polyline points="{words}" fill="none" stroke="{colour}" stroke-width="{width}"{dash}/>'


def ticks(low, high, n=6):
    """Returns round numbers between low and high."""
    step = 10.0 ** math.floor(math.log10((high - low) / n))
    step *= min((m for m in (1, 2, 5, 10) if (high - low) / (m * step) <= n), default=10)
    return [k * step for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def number(value):
    return f"{value:.10g}" if abs(value) > 1e-12 else "0"


class Plot:
    """One panel with linear axes; with log_y the y axis has powers of ten. Curves, dots and marks are added before it
    is drawn."""

    def __init__(self, x, y, x_range, y_range, height=330, title="", log_y=False):
        self.labels, self.title, self.height, self.log_y = (x, y), title, height, log_y
        self.x_range, self.y_range = x_range, [math.log10(v) for v in y_range] if log_y else list(y_range)
        self.w, self.h = WIDTH - LEFT - RIGHT, height - TOP - BOTTOM
        self.body, self.names = [], []

    def at(self, x, y):
        y = math.log10(y) if self.log_y else y
        return (LEFT + self.w * (x - self.x_range[0]) / (self.x_range[1] - self.x_range[0]),
                TOP + self.h * (self.y_range[1] - y) / (self.y_range[1] - self.y_range[0]))

    def curve(self, x, y, name, colour, dashed=False):
        self.body.append(path_of([self.at(*p) for p in zip(x, y)], colour, 1.8, dashed))
        self.names.append((name, colour, "dash" if dashed else "line"))
        return self

    def dots(self, x, y, name, colour, radius=2.6):
        self.body += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="{radius}" fill="{colour}"/>'
                      for a, b in (self.at(*p) for p in zip(x, y))]
        if name:
            self.names.append((name, colour, "dot"))
        return self

    def level(self, y, words, above=True):
        """Marks a number of the paper by a horizontal line."""
        a, b = self.at(self.x_range[0], y), self.at(self.x_range[1], y)
        self.body += [path_of([a, b], ORANGE, 1.3, True),
                      f'<g fill="{ORANGE}">{text(b[0] - 4, b[1] + (-5 if above else 14), words, 12, "end")}</g>']
        return self

    def upright(self, x, words):
        """Marks a number of the paper by a vertical line."""
        a, b = self.at(x, self.floor()), (self.at(x, self.floor())[0], TOP)
        self.body += [path_of([a, b], ORANGE, 1.3, True),
                      f'<g fill="{ORANGE}">{text(b[0] + 5, b[1] + 14, words, 12, "start")}</g>']
        return self

    def floor(self):
        return 10.0 ** self.y_range[0] if self.log_y else self.y_range[0]

    def draw(self):
        """Returns (body, height) for figure()."""
        out, bottom = [], TOP + self.h
        for t in ticks(*self.x_range, 8):
            x = self.at(t, self.floor())[0]
            out += [line(x, TOP, x, bottom, "#e4e4e4"), text(x, bottom + 16, number(t), 11)]
        decades = range(math.ceil(self.y_range[0]), math.floor(self.y_range[1]) + 1)
        for t in [10.0 ** k for k in decades] if self.log_y else ticks(*self.y_range):
            y = self.at(self.x_range[0], t)[1]
            out += [line(LEFT, y, LEFT + self.w, y, "#e4e4e4"), text(LEFT - 6, y + 4, number(t), 11, "end")]
        out.append(f'<rect x="{LEFT}" y="{TOP}" width="{self.w}" height="{self.h}" fill="none" stroke="#888"/>')
        out += [text(LEFT + self.w / 2, bottom + 38, self.labels[0], 13),
                text(20, TOP + self.h / 2, self.labels[1], 13, turn=-90)]
        if self.title:
            out.append(text(LEFT, 24, self.title, 13, "start"))
        beside = 7.2 * len(self.title) + 30 if self.title else 0
        return out + self.body + legend(self.names, LEFT + beside, 24), self.height


class View:
    """Orthographic line drawing. Heights are enlarged so that a shallow surface shows its curvature."""

    def __init__(self, points, heights=1.0, azimuth=-58, elevation=32, height=430):
        a, e = math.radians(azimuth), math.radians(elevation)
        self.axes = np.array([[-math.sin(a), math.cos(a), 0.0],
                              [-math.sin(e) * math.cos(a), -math.sin(e) * math.sin(a), math.cos(e)]])
        self.heights, self.height = heights, height
        flat = self.flat(points)
        low, high = flat.min(0), flat.max(0)
        self.scale = min((WIDTH - 60) / (high - low)[0], (height - 80) / (high - low)[1])
        self.middle = (low + high) / 2
        self.body, self.names = [], []

    def flat(self, points):
        return (np.asarray(points) * [1, 1, self.heights]) @ self.axes.T

    def at(self, points):
        flat = (self.flat(points) - self.middle) * self.scale
        return np.column_stack([WIDTH / 2 + flat[:, 0], (self.height + 20) / 2 - flat[:, 1]])

    def cables(self, points, ends, name, colour, width=1.2, dashed=False):
        at = self.at(points)
        words = " ".join(f"M{at[i][0]:.1f} {at[i][1]:.1f}L{at[j][0]:.1f} {at[j][1]:.1f}" for i, j in ends)
        dash = ' stroke-dasharray="4 3"' if dashed else ""
        self.body.append(f'<path d="{words}" fill="none" stroke="{colour}" stroke-width="{width}"{dash}/>')
        self.names.append((name, colour, "dash" if dashed else "line"))
        return self

    def nodes(self, points, name, colour, radius=3.2):
        self.body += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{colour}"/>' for x, y in self.at(points)]
        self.names.append((name, colour, "dot"))
        return self

    def bar(self, length_m, origin):
        """Draws lengths along both axes of the plane, from a corner."""
        out = []
        for way, word in ((np.array([1.0, 0, 0]), "x"), (np.array([0, 1.0, 0]), "y")):
            a, b = self.at([np.array(origin), np.array(origin) + length_m * way])
            out += [path_of([a, b], "#555", 1.4), text(*(b + (b - a) * 0.18 + [0, 4]), f"{word}", 12)]
        a, b = self.at([np.array(origin), np.array(origin) + length_m * np.array([1.0, 0, 0])])
        self.body += out + [text(*(a + [0, 18]), f"{length_m:g} m", 11)]
        return self

    def draw(self):
        return self.body + legend(self.names, 20, 24), self.height
