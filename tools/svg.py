"""Writes figures as SVG: log-log panels, shares over a logarithmic axis, and stacked shares. It needs only the standard
library."""
import math
from html import escape

COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555", "#a00000"]
PANEL_W, PANEL_H, LEFT, TOP, RIGHT, BOTTOM = 400, 300, 66, 34, 14, 44


def text(x, y, words, size=12, anchor="middle", turn=0):
    rotate = f' transform="rotate({turn} {x:.1f} {y:.1f})"' if turn else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}"{rotate}>{escape(words)}</text>'


def line(x1, y1, x2, y2, colour="#ddd"):
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}"/>'


def decade(k):
    return {0: "1", 1: "10", 2: "100"}.get(k, f"1e{k}")


def limits(values):
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    return low, max(high, low + 1)


class Axes:
    def __init__(self, left, top, points):
        self.left, self.top = left + LEFT, top + TOP
        self.w, self.h = PANEL_W - LEFT - RIGHT, PANEL_H - TOP - BOTTOM
        self.x, self.y = limits([p[0] for p in points]), limits([p[1] for p in points])

    def at(self, x, y):
        return (self.left + self.w * (math.log10(x) - self.x[0]) / (self.x[1] - self.x[0]),
                self.top + self.h * (self.y[1] - math.log10(y)) / (self.y[1] - self.y[0]))

    def frame(self, title, x_label, y_label):
        out = [text(self.left + self.w / 2, self.top - 10, title, 13)]
        for k in range(self.x[0], self.x[1] + 1):
            x = self.at(10.0 ** k, 10.0 ** self.y[0])[0]
            out += [line(x, self.top, x, self.top + self.h), text(x, self.top + self.h + 15, decade(k), 10)]
        every = 1 + (self.y[1] - self.y[0]) // 9
        for k in range(self.y[0], self.y[1] + 1, every):
            y = self.at(10.0 ** self.x[0], 10.0 ** k)[1]
            out += [line(self.left, y, self.left + self.w, y), text(self.left - 5, y + 4, decade(k), 10, "end")]
        out.append(text(self.left + self.w / 2, self.top + self.h + 34, x_label))
        out.append(text(self.left - 48, self.top + self.h / 2, y_label, turn=-90))
        return out


class ShareAxes:
    """A panel w x h with shares from 0 to 1 over a logarithmic axis from low to high. Labels of lines have the width
    `right`."""

    def __init__(self, w, h, low, high, right):
        self.left, self.top, self.w, self.h = 56, 12, w - 56 - right, h - 12 - 42
        self.low, self.high = math.log10(low), math.log10(high)

    def at(self, x, share):
        return (self.left + self.w * (math.log10(x) - self.low) / (self.high - self.low),
                self.top + self.h * (1 - share))

    def frame(self, x_label, y_label, ticks):
        right, bottom = self.left + self.w, self.top + self.h
        out = []
        for share in (0, 0.25, 0.5, 0.75, 1):
            y = self.at(10 ** self.low, share)[1]
            out += [line(self.left, y, right, y), text(self.left - 6, y + 4, f"{100 * share:g} %", 11, "end")]
        for tick in ticks:
            x = self.at(tick, 0)[0]
            out += [line(x, self.top, x, bottom), text(x, bottom + 16, f"{tick:,}".replace(",", " "), 11)]
        out.append(text(self.left + self.w / 2, bottom + 34, x_label))
        out.append(text(12, self.top + self.h / 2, y_label, turn=-90))
        return out

    def curve(self, points):
        """Returns the path of a step function: the share is that of the last x at or before."""
        path, before = "", None
        for x, y in (self.at(*point) for point in points):
            if before is None:
                path = f"M{x:.1f} {y:.1f}"
            elif abs(y - before) >= 0.05:
                path += f"H{x:.1f}V{y:.1f}"
            else:
                continue
            before = y
        return path + f"H{self.left + self.w:.1f}"


def spread(places, gap, low, high):
    """Returns the places, in the same order, moved so that they are at least `gap` apart and between low and high."""
    order = sorted(range(len(places)), key=lambda i: places[i])
    out = list(places)
    for n, i in enumerate(order):
        out[i] = max(out[i], out[order[n - 1]] + gap if n else low)
    for n, i in reversed(list(enumerate(order))):
        out[i] = min(out[i], out[order[n + 1]] - gap if n + 1 < len(order) else high)
    return out


def dot(x, y, colour, r=2.8):
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r}" fill="{colour}"/>'


def cross(x, y, colour, r=6):
    path = f"M{x - r:.1f},{y - r:.1f}l{2 * r},{2 * r}m0,{-2 * r}l{-2 * r},{2 * r}"
    return f'<path d="{path}" stroke="{colour}" stroke-width="2.4" fill="none"/>'


def series(axes, points, colour, style, name):
    """Draws points. line: joined in order; dash: the same with a dashed line; mark: crosses with their name beside
    them."""
    at = [axes.at(x, y) for x, y in points]
    if style == "mark":
        return [cross(x, y, colour) + text(x + 10, y - 4, name, 11, "start") for x, y in at]
    path, broken = " ".join(f"{x:.1f},{y:.1f}" for x, y in at), ' stroke-dasharray="5 3"' if style == "dash" else ""
    out = [f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.6"{broken}/>']
    return out[: len(at) > 1] + [dot(x, y, colour) for x, y in at]


def document(width, height, body, comment):
    safe = comment.replace("--", "- -")
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
            f'font-family="Helvetica, Arial, sans-serif">\n<!--\n{safe}\n-->\n'
            f'<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(body) + "\n</svg>\n")


def loglog(path, panels, x_label, y_label, comment, columns=2, styles=None):
    """Writes panels: {title: {name: [(x, y), ...]}}, with one legend for all below. styles: {name: line, dash or
    mark}."""
    body, names, styles = [], [], styles or {}
    for panel in panels.values():
        names += [name for name in panel if name not in names]
    for i, (title, panel) in enumerate(panels.items()):
        panel = {name: [(x, y) for x, y in points if x > 0 and y > 0] for name, points in panel.items()}
        axes = Axes(i % columns * PANEL_W, i // columns * PANEL_H, [p for points in panel.values() for p in points])
        body += axes.frame(title, x_label, y_label)
        for name, points in panel.items():
            body += series(axes, points, COLOURS[names.index(name) % len(COLOURS)], styles.get(name, "line"), name)
    columns = min(columns, len(panels))
    top = (len(panels) + columns - 1) // columns * PANEL_H
    per_row = max(1, columns * PANEL_W // 190)
    for i, name in enumerate(names):
        x, y = 20 + i % per_row * 190, top + 16 + i // per_row * 18
        colour = COLOURS[i % len(COLOURS)]
        body += [cross(x, y - 4, colour, 4) if styles.get(name) == "mark" else dot(x, y - 4, colour, 4),
                 text(x + 10, y, name, 12, "start")]
    height = top + 26 + 18 * ((len(names) + per_row - 1) // per_row)
    with open(path, "w") as file:
        file.write(document(columns * PANEL_W, height, body, comment))


def shares(path, bars, comment):
    """Writes bars: {label: {part: share}}, one horizontal bar each."""
    body, names, width = [], [], 800
    for bar in bars.values():
        names += [name for name in bar if name not in names]
    for i, (label, bar) in enumerate(bars.items()):
        x, y = 310.0, 14 + 30 * i
        body.append(text(302, y + 15, label, 12, "end"))
        for name, share in bar.items():  # medians need not add up to one
            w = share / sum(bar.values()) * (width - 330)
            colour = COLOURS[names.index(name) % len(COLOURS)]
            body.append(f'<rect x="{x:.1f}" y="{y}" width="{w:.1f}" height="20" fill="{colour}"/>')
            if share > 0.07:
                body.append(f'<g fill="white">{text(x + w / 2, y + 14, f"{100 * share:.0f} %", 11)}</g>')
            x += w
    top = 24 + 30 * len(bars)
    for i, name in enumerate(names):
        x = 20 + i * 104
        body += [f'<rect x="{x}" y="{top}" width="10" height="10" fill="{COLOURS[i % len(COLOURS)]}"/>',
                 text(x + 14, top + 9, name, 11, "start")]
    with open(path, "w") as file:
        file.write(document(width, top + 24, body, comment))
