"""Two other programs lead the instruments of an operation at once, exchange its models and save it; the
program does it again to the same bits."""
import json
import math
import os
import subprocess
import sys
import tempfile
import threading
import traceback

from page import Closed, Page, Refused, Server, binary

SCENE = """
[operation]
[eye]
[[body]]
kind  = "membrane"
name  = "membrane"
sheet = { middle = [0, 0, -1], radius = 1.5, nodes = 150 }
[[instrument]]
name     = "forceps"
kind     = "forceps"
incision = "nasal"
way      = [{ time = 0, tip = [1, 0, -8], opening = 20 }]
[[instrument]]
name     = "lamp"
kind     = "lamp"
incision = "temporal"
way      = [{ time = 0, tip = [-4, -1.5, -2.5], active = 1 }]
[[view]]
size = [64, 48]
"""


def expect(condition, what):
    if not condition:
        raise AssertionError(what)


def lead(server, instrument, place, failures):
    """Circles in front of the retina, some of them on it; every few moves something else changes."""
    try:
        page = Page(server.port, server.token)
        for n in range(60):
            turn = n / 10
            tip = [place[0] + 0.5 * math.cos(turn), place[1] + 0.5 * math.sin(turn), place[2] - 1.5 * math.sin(turn / 3)]
            page.ask(instrument={"name": instrument, "tip": tip, "opening": 20 * (n % 3 > 0)})
            if n % 7 == 0:
                page.ask(membrane={"name": "membrane", "model": "ecm" if n % 2 else "springs"})
            if n % 9 == 0:
                page.ask(view={"zoom": 1 + 0.1 * (n % 5), "stereo": "side_by_side" if n % 2 else "none"})
        # The last place is one that it has surely been at, however many of the others were passed over.
        page.ask(instrument={"name": instrument, "tip": [place[0], place[1], place[2] - 1.5], "opening": 0})
        page.until(lambda: page.status and page.frames)
        if instrument == "forceps":
            page.until(lambda: any(one["kind"] == "touch" for one in page.events))
        poses = {one["name"]: one for one in page.status["instruments"]}
        expect(poses[instrument]["is_led"], poses)
        page.close()
    except Exception:
        failures.append(traceback.format_exc())


def hands(server, folder):
    watching, failures = Page(server.port, server.token), []
    threads = [threading.Thread(target=lead, args=(server, name, place, failures))
               for name, place in (("forceps", [0.5, 0, -9.5]), ("lamp", [-4, -1.5, -2.5]))]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        watching.receive(0.05)
    expect(not failures, "".join(failures))
    watching.ask(operation={"do": "pause"})
    saved = watching.ask(operation={"do": "save", "path": "own.toml"})
    watching.until(lambda: "digest" in watching.status)
    done = subprocess.run([binary(), "run", os.path.join(folder, "own.toml"), "-o", os.path.join(folder, "out"), "--json"],
                          capture_output=True, text=True, check=True)
    report = json.loads(done.stdout)
    expect(report["steps"] == saved["steps"], (report["steps"], saved))
    expect(report["digest"] == watching.status["digest"], "the same end")
    for name in ("forceps", "lamp"):
        kinds = [one["kind"] for one in watching.events
                 if one["instrument"] == name and one["at"] == "retina" and one["kind"].startswith("touch")]
        expect(kinds == (["touch", "touch_ended"] * len(kinds))[:len(kinds)], f"touches begin and end in turn: {kinds}")
    expect(any(one["kind"] == "touch" for one in watching.events), "something was touched")
    watching.ask(operation={"do": "go"})


def main():
    with tempfile.TemporaryDirectory(prefix="supple-hands-") as folder:
        with open(os.path.join(folder, "small.toml"), "w") as file:
            file.write(SCENE)
        with Server("small.toml", folder=folder) as server:
            hands(server, folder)


if __name__ == "__main__":
    try:
        main()
    except (AssertionError, RuntimeError, TimeoutError, Closed, Refused):
        traceback.print_exc()
        sys.exit(1)
