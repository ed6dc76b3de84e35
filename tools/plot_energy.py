#!/usr/bin/env python3
"""Draws how the energy of the plucked membrane of `supple bench springs` changes with time.

    supple bench springs --only pluck --json springs.json
    python3 tools/plot_energy.py springs.json docs/images/springs_energy.svg

One panel per stiffness, frames and energy (over that at the start) on logarithmic axes.
"""
import json
import math
import sys

FRAMES = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]
COLOURS = {"explicit": "#c44e52", "implicit": "#4c72b0", "xpbd": "#55a868", "projective": "#8172b3"}
LABELS = {"explicit": "symplectic Euler", "implicit": "implicit Euler", "xpbd": "XPBD",
          "projective": "projective dynamics"}
LEAST = 1e-6  # of the energy axis
WIDTH, HEIGHT, LEFT, TOP, GAP = 220, 200, 56, 48, 24


def place(panel, frame, ratio):
    x = LEFT + panel * (WIDTH + GAP) + WIDTH * math.log10(frame) / 3
    y = TOP + HEIGHT * math.log10(max(ratio, LEAST) / 10) / math.log10(LEAST / 10)
    return f"{x:.1f},{y:.1f}"


def text(x, y, content, anchor="middle", colour="#333"):
    return (f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}" fill="{colour}">'
            f"{content}</text>")


def draw_panel(panel, stiffness, rows):
    x0 = LEFT + panel * (WIDTH + GAP)
    out = [f'<rect x="{x0}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>',
           text(x0 + WIDTH / 2, TOP - 8, f"k = {stiffness:g} N/m")]
    for power in range(0, 4):
        x = x0 + WIDTH * power / 3
        out.append(text(x, TOP + HEIGHT + 16, f"{10 ** power}"))
    for power in range(1, int(math.log10(LEAST)) - 1, -1):
        y = TOP + HEIGHT * (power - 1) / (math.log10(LEAST) - 1)
        out.append(f'<line x1="{x0}" x2="{x0 + WIDTH}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>')
        if panel == 0:
            out.append(text(x0 - 6, y + 4, f"1e{power}", "end"))
    for row in rows:
        points = [(frame, row[f"energy_{frame}"]) for frame in FRAMES if f"energy_{frame}" in row]
        line = " ".join(place(panel, frame, ratio) for frame, ratio in points if ratio >= LEAST)
        colour = COLOURS[row["integrator"]]
        out.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
    return out


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1]) as file:
        rows = [row for row in json.load(file)["rows"] if row["case"] == "pluck"]
    if not rows:
        sys.exit(f"{sys.argv[1]}: rows: found none of case pluck, expected those of bench springs")
    stiffnesses = sorted({row["stiffness"] for row in rows})
    width = LEFT + len(stiffnesses) * (WIDTH + GAP)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{TOP + HEIGHT + 44}" '
           'font-family="sans-serif" font-size="12">', '<rect width="100%" height="100%" fill="#fff"/>']
    for n, (name, colour) in enumerate(COLOURS.items()):
        out.append(text(LEFT + n * 160, 18, LABELS[name], "start", colour))
    for panel, stiffness in enumerate(stiffnesses):
        out += draw_panel(panel, stiffness, [row for row in rows if row["stiffness"] == stiffness])
    out.append(text(width / 2, TOP + HEIGHT + 36, "frames of 20 ms"))
    with open(sys.argv[2], "w") as file:
        file.write("\n".join(out + ["</svg>"]) + "\n")


if __name__ == "__main__":
    main()
