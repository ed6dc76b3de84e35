"""Warps in every format as ITK reads them that is compiled for npm (@itk-wasm/transform-io and image-io), and the
transforms that it writes as supple reads them: places and vectors of all grid points to 1e-6 mm.
"""
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

import write_nrrd
from common import SKIPPED, Tally, program, run_supple
from factors import DIMS, GRIDS
from round_trips import BASIS

HERE = os.path.dirname(os.path.abspath(__file__))
MODULES = os.environ.get("SUPPLE_NPM") or os.path.join(HERE, os.pardir, os.pardir, "build", "npm", "node_modules")
GRID_NAMES = ["anisotropic", "flipped", "oblique_mirrored"]
FORMATS = [".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".h5"]
WITHIN_MM = 1e-6


def judge(files):
    """What ITK tells of each file, by its path."""
    done = subprocess.run(["node", os.path.join(HERE, "itk_wasm.mjs"), MODULES, *files], text=True,
                          capture_output=True, timeout=600)
    told = [json.loads(line) for line in done.stdout.split("\n") if line.startswith("{")]
    if done.returncode != 0 or len(told) != len(files):
        sys.exit(f"node: exit code {done.returncode}, {len(told)} answers for {len(files)} files: {done.stderr}")
    return {one.pop("file"): one for one in told}


def places(size, origin, spacing, direction):
    """The places of all grid points, LPS mm, i fastest."""
    axes = np.reshape(direction, (3, 3)) * spacing
    k, j, i = np.indices(size[::-1]).reshape(3, -1)
    return np.stack([i, j, k], 1) @ axes.T + origin


def grid_of(told):
    if "fixed" in told:
        fixed = np.array(told["fixed"])
        return fixed[:3].astype(int), fixed[3:6], fixed[6:9], fixed[9:]
    return told["size"], told["origin"], told["spacing"], told["direction"]


def supple(tally, command, start, end):
    done = run_supple("--quiet", command, start, *(["-o"] if command == "compose" else []), end)
    if done.returncode != 0:
        tally.report(os.path.basename(end), command, done.stderr.strip(), "a warp")
    return done.returncode == 0


def compare(tally, path, told, meant):
    tally.files += 1
    if "error" in told:
        tally.report(os.path.basename(path), "ITK", told["error"], "a warp")
        return
    values = np.fromfile(path + ".values", {"float32": "<f4", "float64": "<f8"}[told["type"]])
    found = places(*map(np.asarray, grid_of(told))), values.reshape(-1, 3)
    for what, ours, theirs in zip(("places", "vectors"), meant, found):
        apart = np.abs(ours - theirs).max() if ours.shape == theirs.shape else float("inf")
        if not apart <= WITHIN_MM:
            tally.report(os.path.basename(path), what, f"{apart} mm apart", f"{WITHIN_MM} mm at most")


def start(folder, grid_name):
    """The path of an NRRD that supple did not write, and its places and vectors."""
    affine = GRIDS[grid_name]
    vectors = np.random.default_rng(3).normal(size=(3, *DIMS), scale=4).astype(np.float32)
    source = write_nrrd.write_by_hand(
        os.path.join(folder, grid_name), {**BASIS, "type": "float32", "axes": "vector", "space": "LPS"}, affine,
        vectors)
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    return source, (places(DIMS, affine[:3, 3], spacing, affine[:3, :3] / spacing),
                    vectors.transpose(3, 2, 1, 0).reshape(-1, 3).astype(float))


def trips(tally, folder):
    meant = {}
    for grid_name in GRID_NAMES:
        source, warp = start(folder, grid_name)
        for extension in FORMATS:
            path = os.path.join(folder, f"{grid_name}_as_{extension[1:]}{extension}")
            if supple(tally, "convert", source, path):
                meant[path] = warp
    for path, told in judge(meant).items():
        compare(tally, path, told, meant[path])
    back = {}
    for path in [path for path in meant if path.endswith(".h5")]:
        for end in (".itk.h5", ".itk.tfm"):
            if supple(tally, "compose", path + end, path + end + ".nrrd"):
                back[path + end + ".nrrd"] = meant[path]
    for path, told in judge(back).items():
        compare(tally, path, told, back[path])


def main():
    missing = [name for name in ("transform-io", "image-io")
               if not os.path.exists(os.path.join(MODULES, "@itk-wasm", name))]
    if missing or not program("node", "node"):
        print("skipped: no node, or no @itk-wasm/transform-io and image-io (bash tools/setup.sh --with-judges)")
        sys.exit(SKIPPED)
    tally = Tally()
    with tempfile.TemporaryDirectory(prefix="supple_itk_wasm_") as folder:
        trips(tally, folder)
    tally.finish("warps by ITK as compiled for npm")


if __name__ == "__main__":
    main()
