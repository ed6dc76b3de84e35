#!/usr/bin/env python3
"""Pictures of a drag by a supple.Renderer that is kept, beside new ones, as a table of Markdown
(docs/benchmarks/renderer.md).

    PYTHONPATH=build/release/python /usr/bin/python3 tools/renderer_speed.py HEAD
        [--grab I,J,K] [--step MM] [--count N] [--size PIXELS]

A ball of tissue is led step by step along j; each drag has a picture. Times are medians of
processor time, all threads together; pictures are compared bit for bit.
"""
import argparse
import time

import numpy as np

import supple


def timed(work):
    begin = time.process_time()
    result = work()
    return result, 1000 * (time.process_time() - begin)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("volume")
    parser.add_argument("--material", default="ct-head")
    parser.add_argument("--preset", default="Skin")
    parser.add_argument("--grab", default="128,242,26")
    parser.add_argument("--step", type=float, default=0.3)
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--size", type=int, default=512)
    args = parser.parse_args()
    session = supple.Session(args.volume, args.material)
    view = {"preset": args.preset, "size": [args.size, args.size]}
    kept = supple.Renderer(session)
    _, first = timed(lambda: kept.render(**view))
    handle = {"grab_ball": [int(n) for n in args.grab.split(",")], "radius": 5.0, "no_relax": True}
    rows = {"drag": [], "kept": [], "new": []}
    rays = []
    for _ in range(args.count):
        rows["drag"].append(timed(lambda: session.drag(by=[0, args.step, 0], **handle))[1])
        picture, spent = timed(lambda: kept.render(**view))
        rows["kept"].append(spent)
        rays.append(picture.report.rays)
        other, spent = timed(lambda: supple.Renderer(session).render(**view))
        rows["new"].append(spent)
        assert np.array_equal(picture.array, other.array)
    print(f"| {args.size} × {args.size} pixels, {session.elements} elements | processor ms |\n"
          "|---|---|")
    print(f"| first picture | {first:.0f} |")
    names = {"drag": "a drag", "new": "its picture by a new `Renderer`",
             "kept": f"its picture by the one that is kept, {np.median(rays):.0f} pixels marched"}
    for name in ("drag", "kept", "new"):
        print(f"| {names[name]} | {np.median(rows[name]):.0f} |")


if __name__ == "__main__":
    main()
