#!/usr/bin/env python3
"""Plans of example scenes beside what came of them, as a Markdown table (docs/economy.md).

    python3 tools/plan_outcomes.py [--limit SECONDS] [SCENE.toml ...]

Runs every scene of docs/scenes whose volume is there with `supple run --plan --json --threads 1`, in
a folder that is removed. Times are processor time, which other work on the machine hardly changes. SUPPLE_BINARY names the program. Scenes that take longer than the limit are named.
"""
import argparse
import glob
import json
import os
import subprocess
import sys
import tempfile
import tomllib

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROGRAM = os.environ.get("SUPPLE_BINARY", os.path.join(ROOT, "build/release/bin/supple"))


def volume_of(scene):
    with open(scene, "rb") as file:
        path = tomllib.load(file).get("volume", {}).get("path")
    return path and os.path.join(os.path.dirname(scene), path)


def outcome_of(scene, folder, limit_s):
    command = [PROGRAM, "run", scene, "-o", folder, "--force", "--quiet", "--plan", "--json",
               "--threads", "1"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=limit_s)
    if run.returncode != 0:
        raise RuntimeError(run.stderr.strip() or f"exit code {run.returncode}")
    return json.loads(run.stdout)["outcome"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--limit", type=float, default=120)
    options = parser.parse_args()
    scenes = options.scenes or sorted(glob.glob(os.path.join(ROOT, "docs/scenes/*.toml")))
    print("| scene | memory planned, MB | was | planned / was | time planned, s | was | planned / was |")
    print("|---|---|---|---|---|---|---|")
    left_out, within_memory, within_time, count = [], 0, 0, 0
    for scene in scenes:
        volume = volume_of(scene)
        if not volume:
            continue  # a material or a look
        name = os.path.splitext(os.path.basename(scene))[0]
        if not os.path.exists(volume):
            left_out.append(f"{name} (no {os.path.basename(volume)})")
            continue
        with tempfile.TemporaryDirectory() as folder:
            try:
                found = outcome_of(scene, folder, options.limit)
            except subprocess.TimeoutExpired:
                left_out.append(f"{name} (more than {options.limit:g} s)")
                continue
            except RuntimeError as error:
                left_out.append(f"{name} ({error})")
                continue
        memory = found["peak_mb"] / found["was_peak_mb"]
        time = found["seconds"] / found["was_processor_seconds"]
        count += 1
        within_memory += abs(memory - 1) <= 0.1
        within_time += 0.5 <= time <= 2
        print(f"| `{name}` | {found['peak_mb']:.0f} | {found['was_peak_mb']:.0f} | {memory:.2f} "
              f"| {found['seconds']:.2f} | {found['was_processor_seconds']:.2f} | {time:.2f} |", flush=True)
    print(f"\nOf {count} scenes, {within_memory} are within 10 % of their memory and {within_time} "
          "within a factor of two of their time.")
    if left_out:
        print("Left out: " + "; ".join(left_out) + ".")


if __name__ == "__main__":
    sys.exit(main())
