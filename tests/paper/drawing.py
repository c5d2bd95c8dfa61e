# SPDX-License-Identifier: GPL-3.0-or-later
"""States as SVG, seen from the front, one panel beside the other."""

MARGIN = 6


class Montage:
    """Panels of one size in rows; each shows a part of the plane x, y to one scale."""

    def __init__(self, columns, width, height, scale):
        self.columns, self.width, self.height, self.scale = columns, width, height, scale
        self.panels = []

    def add(self, title, centre, areas, lines=(), hole=()):
        """`areas` are (corners, colour); `lines` (points, colour, width); `hole` closed walks, dark where a place
        is inside an odd number of them."""
        self.panels.append((title, centre, areas, lines, hole))

    def place(self, point, centre):
        return (f"{self.width / 2 + (point[0] - centre[0]) * self.scale:.1f},"
                f"{self.height / 2 + 9 - (point[1] - centre[1]) * self.scale:.1f}")

    def panel(self, index):
        title, centre, areas, lines, hole = self.panels[index]
        x = MARGIN + index % self.columns * (self.width + MARGIN)
        y = MARGIN + index // self.columns * (self.height + MARGIN)
        parts = [f'<svg x="{x}" y="{y}" width="{self.width}" height="{self.height}">',
                 f'<rect width="{self.width}" height="{self.height}" fill="#f7f5f2"/>']
        for colour in dict.fromkeys(colour for _, colour in areas):
            path = " ".join("M" + " L".join(self.place(p, centre) for p in points) + "Z"
                            for points, of in areas if of == colour)
            parts.append(f'<path d="{path}" fill="{colour}" stroke="#00000030" stroke-width="0.4"/>')
        if hole:
            path = " ".join("M" + " L".join(self.place(p, centre) for p in points) + "Z" for points in hole)
            parts.append(f'<path d="{path}" fill="#2b1512" fill-rule="evenodd"/>')
        for points, colour, width in lines:
            path = " ".join(self.place(p, centre) for p in points)
            parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width}" '
                         'stroke-linecap="round"/>')
        parts.append(f'<text x="6" y="15" font-family="sans-serif" font-size="12">{title}</text></svg>')
        return parts

    def write(self, path):
        rows = -(-len(self.panels) // self.columns)
        width = MARGIN + self.columns * (self.width + MARGIN)
        height = MARGIN + rows * (self.height + MARGIN)
        with open(path, "w", encoding="utf-8") as file:
            file.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">\n'
                       f'<rect width="{width}" height="{height}" fill="white"/>\n')
            for index in range(len(self.panels)):
                file.write("\n".join(self.panel(index)) + "\n")
            file.write("</svg>\n")
