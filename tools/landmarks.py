#!/usr/bin/env python3
"""Where every method takes landmarks of a face, as a Markdown table (docs/soft_tissue.md).

    python3 tools/landmarks.py [--scene SCENE.toml] [--points POINTS.csv] [--by X,Y,Z]
                               [--method NAME ...] [--threads N] [--write docs/soft_tissue.md]

The scene's last step that drags is solved by each method from rest, in a folder that is removed: the
scene's handles, pieces and anchors, without its pictures. Rows are landmarks of a CSV file (columns
name, x, y, z in LPS mm at rest), cells are how far they go: sideways (to the patient's left),
forward and up, in mm. `--write` puts the table between the marks of that page. SUPPLE_BINARY names
the program.
"""
import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
import tomllib

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROGRAM = os.environ.get("SUPPLE_BINARY", os.path.join(ROOT, "build/release/bin/supple"))
BEGIN, END = "<!-- landmarks: tools/landmarks.py --write -->", "<!-- landmarks end -->"

# Keys that choose how a step is solved, and of the material beside the scene's own.
METHOD_KEYS = ("model", "fem", "springs", "relax", "no_relax", "limits")
METHODS = {
    "ECM": ({"no_relax": True}, {}),
    "relaxed": ({}, {"relax": True}),
    "by Poisson's ratio": ({}, {"relax": "poisson", "links": 6}),
    "fem, picture": ({"model": "fem", "fem": {"accuracy": "picture"}}, {}),
    "fem, exact": ({"model": "fem"}, {}),
}


def toml(value):
    """A value in one line of TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {toml(of)}" for key, of in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return repr(value)


def scene_of(scene, folder, by, method):
    """The text of the scene as this method solves it."""
    step_keys, material_keys = METHODS[method]
    at = lambda path: os.path.join(folder, path)
    volume = dict(scene["volume"], path=at(scene["volume"]["path"]))
    material = dict(scene.get("material", {}))
    if "table" in material:
        material["table"] = at(material["table"])
    material.update(material_keys)
    steps = [dict(step) for step in scene["step"]]
    drags = [step for step in steps if "grab" in step or "handles" in step]
    for step in drags:
        for key in METHOD_KEYS:
            step.pop(key, None)
        step.update(step_keys)
    if by:
        drags[-1]["by"] = by
    lines = []
    for name, table in [("[volume]", volume), ("[material]", material)] + [("[[step]]", s) for s in steps]:
        lines += [name] + [f"{key} = {toml(value)}" for key, value in table.items()]
    return "\n".join(lines + ["[output]", 'state = "moved.vdb"', ""])


def end_of(step):
    """How the step came to its end, in few words."""
    if "fem" in step:
        return f"{step['fem']['iterations']} iterations"
    relaxed = step.get("relax")
    return f"pass {relaxed['passes']}, by its {relaxed['ended_by']}" if relaxed else ""


def run(command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stderr.strip()}")
    return done.stdout


def places(path):
    with open(path, newline="") as file:
        return {row["name"]: [float(row[axis]) for axis in "xyz"] for row in csv.DictReader(file)}


def moved(args, scene, method):
    """Per landmark its way in mm, and what the run says of itself."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.toml")
        with open(path, "w") as file:
            file.write(scene_of(scene, os.path.dirname(os.path.abspath(args.scene)), args.by, method))
        common = ["--quiet", "--force"] + (["--threads", str(args.threads)] if args.threads else [])
        before = os.times()
        report = json.loads(run([PROGRAM, "run", path, "-o", folder, "--json"] + common))
        after = os.times()
        out = os.path.join(folder, "moved.csv")
        run([PROGRAM, "apply", os.path.join(folder, "moved.vdb"), "--points", args.points, "-o", out] + common)
        at_rest, now = places(args.points), places(out)
    ways = {name: [b - a for a, b in zip(at_rest[name], now[name])] for name in at_rest}
    cpu_s = after.children_user + after.children_system - before.children_user - before.children_system
    return ways, cpu_s, end_of(report["steps"][-1])


def table(args):
    with open(args.scene, "rb") as file:
        scene = tomllib.load(file)
    found = {}
    for method in args.method or METHODS:
        print(f"{method} …", file=sys.stderr, flush=True)
        found[method] = moved(args, scene, method)
    # Sideways is x of LPS, forward is -y, up is z.
    cell = lambda way: " / ".join(f"{part + 0.0:.2f}".replace("-0.00", "0.00") for part in (way[0], -way[1], way[2]))
    lines = ["| sideways / forward / up, mm | " + " | ".join(found) + " |", "|---" * (len(found) + 1) + "|"]
    for name in places(args.points):
        lines.append(f"| {name} | " + " | ".join(cell(ways[name]) for ways, _, _ in found.values()) + " |")
    lines.append("| ended | " + " | ".join(end for _, _, end in found.values()) + " |")
    lines.append("| processor time | " + " | ".join(f"{cpu_s:.0f} s" for _, cpu_s, _ in found.values()) + " |")
    return "\n".join(lines)


def write(page, text):
    with open(page) as file:
        whole = file.read()
    if BEGIN not in whole or END not in whole:
        sys.exit(f"{page}: found no marks of a table, expected {BEGIN}")
    head, rest = whole.split(BEGIN, 1)
    with open(page, "w") as file:
        file.write(head + BEGIN + "\n" + text + "\n" + END + rest.split(END, 1)[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default=os.path.join(ROOT, "docs/scenes/head_upper_jaw.toml"))
    parser.add_argument("--points", default=os.path.join(ROOT, "docs/scenes/face_landmarks.csv"))
    parser.add_argument("--by", type=lambda text: [float(part) for part in text.split(",")])
    parser.add_argument("--method", action="append", choices=METHODS)
    parser.add_argument("--threads", type=int)
    parser.add_argument("--write", metavar="PAGE.md")
    args = parser.parse_args()
    text = table(args)
    if args.write:
        write(args.write, text)
    else:
        print(text)


if __name__ == "__main__":
    main()
