"""Draws plots as SVG with the standard library alone."""

import math
from xml.sax.saxutils import escape

WIDTH, HEIGHT = 640, 420
LEFT, RIGHT, TOP, BOTTOM = 80, 180, 48, 56
# the palette of Okabe and Ito, which colour-blind readers can tell apart
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]
UNITS = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1, ""), (1e-3, "m"), (1e-6, "µ"))


def short(value):
    for size, prefix in UNITS:
        if value >= size:
            return f"{value / size:g}{prefix}"
    return f"{value:g}"


def text(x, y, content, anchor="middle", size=13, extra=""):
    return (f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}" {extra}>'
            f"{escape(content)}</text>")


def page(parts, height=HEIGHT):
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif">\n'
            f'<rect width="{WIDTH}" height="{height}" fill="white"/>\n' + "\n".join(parts) + "\n</svg>\n")


def decades(values):
    low, high = min(values), max(values)
    return 10 ** math.floor(math.log10(low)), 10 ** math.ceil(math.log10(high))


def log_log_plot(title, x_label, y_label, curves):
    """`curves`: name to [(x, y), …], all positive."""
    points = [point for curve in curves.values() for point in curve]
    x_low, x_high = decades([x for x, _ in points])
    y_low, y_high = decades([y for _, y in points])
    plot_width, plot_height = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM

    def x_of(x):
        return LEFT + plot_width * math.log(x / x_low) / math.log(x_high / x_low)

    def y_of(y):
        return TOP + plot_height * (1 - math.log(y / y_low) / math.log(y_high / y_low))

    parts = [text(LEFT + plot_width / 2, 26, title, size=16)]
    tick = x_low
    while tick <= x_high * 1.001:
        parts.append(f'<path d="M{x_of(tick):.1f} {TOP}V{TOP + plot_height}" stroke="#dddddd"/>')
        parts.append(text(x_of(tick), TOP + plot_height + 20, short(tick)))
        tick *= 10
    tick = y_low
    while tick <= y_high * 1.001:
        parts.append(f'<path d="M{LEFT} {y_of(tick):.1f}H{LEFT + plot_width}" stroke="#dddddd"/>')
        parts.append(text(LEFT - 8, y_of(tick) + 4, short(tick), anchor="end"))
        tick *= 10
    parts.append(text(LEFT + plot_width / 2, HEIGHT - 12, x_label))
    middle = TOP + plot_height / 2
    parts.append(text(20, middle, y_label, extra=f'transform="rotate(-90 20 {middle:.1f})"'))
    ends = []
    for colour, (name, curve) in zip(COLOURS, curves.items()):
        path = " ".join(f"{x_of(x):.1f},{y_of(y):.1f}" for x, y in curve)
        parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        parts += [f'<circle cx="{x_of(x):.1f}" cy="{y_of(y):.1f}" r="3" fill="{colour}"/>' for x, y in curve]
        ends.append([y_of(curve[-1][1]) + 4, name, colour])
    ends.sort()
    for before, after in zip(ends, ends[1:]):
        after[0] = max(after[0], before[0] + 16)  # names do not overlap
    for y, name, colour in ends:
        parts.append(text(LEFT + plot_width + 10, y, name, anchor="start", extra=f'fill="{colour}"'))
    return page(parts)


def stacked_bars(title, unit, bars):
    """`bars`: [(name, [(part, value), …]), …], all with the same parts."""
    total = max(sum(value for _, value in parts) for _, parts in bars)
    left, right, top, height = 225, 30, 84, 56
    width = WIDTH - left - right
    out = [text(WIDTH / 2, 26, title, size=16)]
    x = left
    for colour, (part, _) in zip(COLOURS, bars[0][1]):
        out.append(f'<rect x="{x}" y="46" width="14" height="14" fill="{colour}"/>')
        out.append(text(x + 20, 58, part, anchor="start"))
        x += 120
    for row, (name, parts) in enumerate(bars):
        y, x = top + row * height, left
        out.append(text(left - 10, y + height / 2 + 4, name, anchor="end"))
        for colour, (_, value) in zip(COLOURS, parts):
            length = width * value / total
            out.append(f'<rect x="{x:.1f}" y="{y + 6:.1f}" width="{length:.1f}" height="{height - 12:.1f}" '
                       f'fill="{colour}"/>')
            if length > 28:
                out.append(text(x + length / 2, y + height / 2 + 4, f"{value:.1f}", extra='fill="white"'))
            x += length
    bottom = top + len(bars) * height
    out.append(text(left + width / 2, bottom + 20, unit))
    return page(out, bottom + 36)
