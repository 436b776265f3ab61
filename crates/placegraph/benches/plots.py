"""Two kinds of plots as SVG."""

import math
from html import escape

COLORS = ["#1b6ca8", "#c8553d", "#588157", "#8a5a9e", "#d08c2e", "#4a4e69", "#2a9d8f", "#9b2226"]
HEAD = ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" width="{w}" height="{h}" font-family="sans-serif" '
        'font-size="13">\n<rect width="{w}" height="{h}" fill="white"/>\n')


def lines(curves, x_name, y_name):
    """Curves of points over two logarithmic axes."""
    width, height, left, top, right, bottom = 760, 420, 70, 20, 210, 50
    points = [point for curve in curves.values() for point in curve]
    if not points:
        return HEAD.format(w=width, h=height) + "</svg>\n"
    ends = [(math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))) for values in zip(*points)]
    (x0, x1), (y0, y1) = ends

    def place(x, y):
        return (left + (math.log10(x) - x0) / (x1 - x0) * (width - left - right),
                height - bottom - (math.log10(y) - y0) / (y1 - y0) * (height - top - bottom))

    svg = HEAD.format(w=width, h=height)
    for power in range(x0, x1 + 1):
        x, y = place(10**power, 10**y0)
        svg += f'<line x1="{x:.0f}" y1="{top}" x2="{x:.0f}" y2="{y:.0f}" stroke="#ddd"/>\n'
        svg += f'<text x="{x:.0f}" y="{y + 18:.0f}" text-anchor="middle">{10**power:,}</text>\n'
    for power in range(y0, y1 + 1):
        x, y = place(10**x0, 10**power)
        svg += f'<line x1="{x:.0f}" y1="{y:.0f}" x2="{width - right}" y2="{y:.0f}" stroke="#ddd"/>\n'
        svg += f'<text x="{x - 6:.0f}" y="{y + 4:.0f}" text-anchor="end">{10.0**power:g}</text>\n'
    svg += f'<text x="{(left + width - right) / 2}" y="{height - 10}" text-anchor="middle">{escape(x_name)}</text>\n'
    svg += f'<text transform="translate(16 {height / 2}) rotate(-90)" text-anchor="middle">{escape(y_name)}</text>\n'
    for number, (name, curve) in enumerate((name, curve) for name, curve in curves.items() if curve):
        color = COLORS[number % len(COLORS)]
        places = [place(*point) for point in curve]
        svg += f'<polyline points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in places)}" fill="none" stroke="{color}" stroke-width="2"/>\n'
        svg += "".join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{color}"/>\n' for x, y in places)
        y = top + 12 + 20 * number
        svg += f'<rect x="{width - right + 14}" y="{y - 9}" width="12" height="8" fill="{color}"/>\n'
        svg += f'<text x="{width - right + 32}" y="{y}">{escape(name)}</text>\n'
    return svg + "</svg>\n"


def bars(rows, unit):
    """A bar for every name."""
    width, left, step = 760, 190, 26
    height = step * len(rows) + 16
    largest = max((value for _, value in rows), default=1)
    svg = HEAD.format(w=width, h=height)
    for number, (name, value) in enumerate(rows):
        y, length = 8 + step * number, value / largest * (width - left - 120)
        svg += f'<text x="{left - 8}" y="{y + 15}" text-anchor="end">{escape(name)}</text>\n'
        svg += f'<rect x="{left}" y="{y + 3}" width="{length:.1f}" height="16" fill="{COLORS[0]}"/>\n'
        svg += f'<text x="{left + length + 6:.1f}" y="{y + 15}">{value:.1f} {escape(unit)}</text>\n'
    return svg + "</svg>\n"
