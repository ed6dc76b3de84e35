#!/usr/bin/env python3
"""Where every method takes landmarks of a face, as a Markdown table (docs/soft_tissue.md).

    python3 tools/landmarks.py [--scene SCENE.toml] [--points POINTS.csv] [--by X,Y,Z]
                               [--method NAME ...] [--threads N] [--write docs/soft_tissue.md]

The scene's last step that drags is solved by each method from rest, in a folder that is removed: the
scene's handles, pieces and anchors, without its pictures. Rows are landmarks of a CSV file (columns
name, x, y, z in LPS mm at rest), cells are how far they go: sideways (to the patient's left),
forward and up, in mm. Beside exact finite elements a row says how far each method is from them, at the
95th percentile over the voxels that these move by more than 1 % of the longest way. `--write` puts the table between the marks of that page. SUPPLE_BINARY names
the program.
"""
import argparse
import array
import csv
import json
import os
import subprocess
import sys
import tempfile
import tomllib

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROGRAM = os.environ.get("SUPPLE_BINARY", os.path.join(ROOT, "build/release/bin/supple"))
EXACT, MOVED_PART = "fem, exact", 0.01
BEGIN, END = "<!-- landmarks: tools/landmarks.py --write -->", "<!-- landmarks end -->"

# Keys that choose how a step is solved, and of the material beside the scene's own.
METHOD_KEYS = ("model", "fem", "springs", "relax", "no_relax", "limits")
METHODS = {
    "ECM": ({"no_relax": True}, {}),
    "relaxed": ({}, {"relax": True}),
    "by Poisson's ratio": ({}, {"relax": "poisson", "links": 6}),
    "fem, picture": ({"model": "fem", "fem": {"accuracy": "picture"}}, {}),
    EXACT: ({"model": "fem"}, {}),
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
    drags = [step for step in steps if any(key == "handles" or key.startswith("grab") for key in step)]
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


def displacements(state, folder, common):
    """u of all voxels, three floats each, LPS mm."""
    path = os.path.join(folder, "u.nrrd")
    run([PROGRAM, "export", state, "--direction", "material", "-o", path] + common)
    with open(path, "rb") as file:
        data = file.read()
    values = array.array("f")
    values.frombytes(data[data.index(b"\n\n") + 2:])
    return values


def error_p95(values, exact):
    """Of distances from the exact displacements, over what these move, in mm."""
    squares = [x * x + y * y + z * z for x, y, z in zip(exact[0::3], exact[1::3], exact[2::3])]
    least = MOVED_PART ** 2 * max(squares)
    errors = sorted(sum((values[3 * n + c] - exact[3 * n + c]) ** 2 for c in range(3)) ** 0.5
                    for n, square in enumerate(squares) if square > least)
    return errors[int(0.95 * (len(errors) - 1))]


def moved(args, scene, method):
    """Per landmark its way in mm, what the run says of itself, and all displacements."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.toml")
        with open(path, "w") as file:
            file.write(scene_of(scene, os.path.dirname(os.path.abspath(args.scene)), args.by, method))
        common = ["--quiet", "--force"] + (["--threads", str(args.threads)] if args.threads else [])
        before = os.times()
        report = json.loads(run([PROGRAM, "run", path, "-o", folder, "--json"] + common))
        after = os.times()
        out = os.path.join(folder, "moved.csv")
        state = os.path.join(folder, "moved.vdb")
        run([PROGRAM, "apply", state, "--points", args.points, "-o", out] + common)
        u = displacements(state, folder, common) if EXACT in (args.method or METHODS) else None
        at_rest, now = places(args.points), places(out)
    ways = {name: [b - a for a, b in zip(at_rest[name], now[name])] for name in at_rest}
    cpu_s = after.children_user + after.children_system - before.children_user - before.children_system
    return ways, cpu_s, end_of(report["steps"][-1]), u


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
        lines.append(f"| {name} | " + " | ".join(cell(ways[name]) for ways, *_ in found.values()) + " |")
    if EXACT in found:
        exact = found[EXACT][3]
        errors = ["" if u is exact else f"{error_p95(u, exact):.3f} mm" for *_, u in found.values()]
        lines.append("| p95 from exact | " + " | ".join(errors) + " |")
    lines.append("| ended | " + " | ".join(end for _, _, end, _ in found.values()) + " |")
    lines.append("| processor time | " + " | ".join(f"{cpu_s:.0f} s" for _, cpu_s, *_ in found.values()) + " |")
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
