"""A live session as a page drives it: pictures, picks, drags, undo, cuts, slices, files, several
pages, reconnection, and the end of the server."""
import os
import signal
import subprocess
import sys
import time

from page import Closed, Page, Refused, Server, ball_folder, binary


def expect(condition, what):
    if not condition:
        raise AssertionError(what)


def error_of(call, *arguments, **keys):
    try:
        call(*arguments, **keys)
    except RuntimeError as error:
        return str(error)
    raise AssertionError(f"no error of {arguments} {keys}")


def begin(server, **keys):
    page = Page(server.port, server.token, **keys)
    page.until(lambda: page.scene is not None)
    return page


def surface(page):
    """The pick in the middle of the picture, which the ball fills."""
    hit = page.ask(pick={"view": "3d", "at": [48.5, 48.5]})
    expect(hit and hit["element"], f"nothing in the middle: {hit}")
    return hit


def drag(page, mm=1.0, steps=5):
    hit = surface(page)
    page.event("grab", grab=hit["voxel"])
    for step in range(1, steps + 1):
        page.event("drag", to=[mm * step / steps, 0, 0])
    page.carried_out()
    return hit


def pictures_and_scene(server, folder):
    page = begin(server)
    expect(page.hello["version"] and page.hello["pages"] == 1, page.hello)
    page.ask(size={"3d": [96, 96], "axial": [64, 64], "coronal": [48, 32], "sagittal": [0, 0]})
    settled = page.settle()
    expect((settled.width, settled.height) == (96, 96) and settled.is_png, "a settled PNG")
    axial = page.settle(view="axial")
    expect((axial.width, axial.height) == (64, 64), "an axial slice")
    page.settle(view="coronal")
    expect(page.last("sagittal") is None, "a hidden view is not drawn")
    scene = page.scene
    expect(scene["volume"]["dims"] == [40, 40, 40] and scene["volume"]["elements"] > 10000, scene)
    expect(scene["undo"] == [] and scene["model"] == "ecm", scene)
    # The middle of the axial slice, by its affine, is the middle of the volume.
    middle = [axial.pixels[a] + 31.5 * axial.pixels[3 + a] + 31.5 * axial.pixels[6 + a]
              for a in range(3)]
    expect(all(abs(place - 19.5) < 0.51 for place in middle), middle)
    page.close()


def drags_and_undo(server, folder):
    page = begin(server)
    page.ask(size={"3d": [96, 96]})
    page.settle()
    hit = drag(page)
    expect(page.scene["undo"][-1]["kind"] == "drag", page.scene["undo"])
    expect(page.scene["undo"][-1]["text"] == "drag 1.0 mm at " + ", ".join(map(str, hit["voxel"])),
           page.scene["undo"])
    expect(abs(page.scene["grab"]["reached"][0] - 1) < 1e-3, page.scene["grab"])
    page.event("release")
    page.settle()
    expect(page.last().event >= page.drawn, "the settled picture shows the last drag")
    moved = page.ask(pick={"view": "3d", "at": [48.5, 48.5]})
    expect(max(abs(d) for d in moved["displacement"]) > 0.3, moved)
    page.event("undo", all=True)
    expect(page.carried_out()["undo"] == [] and len(page.scene["redo"]) == 1, page.scene)
    page.event("redo", all=True)
    expect(len(page.carried_out()["undo"]) == 1, page.scene)
    page.event("undo", all=True)
    page.carried_out()
    # Esc: what was dragged since the grab is taken back, and no more.
    page.event("grab", grab=hit["voxel"])
    page.event("drag", to=[0, 0.5, 0])
    page.event("release", restore=True)
    expect(page.carried_out()["undo"] == [] and page.scene["grab"] is None, page.scene)
    # One pixel to the right on the picture is as long in the world as the pick says.
    right, towards = hit["right"], hit["towards"]
    expect(abs(sum(a * b for a, b in zip(right, towards))) < 1e-6, "across the view")
    page.close()


def latest_wins(server, folder):
    """Drags faster than they are done are merged; no picture shows an older event than one before."""
    page = begin(server)
    page.ask(size={"3d": [96, 96], "axial": [64, 64]})
    hit = surface(page)
    page.event("grab", grab=hit["voxel"])
    for step in range(600):
        page.send(event={"kind": "drag", "to": [0.002 * step, 0, 0]})
        time.sleep(0.0027)  # below the limit of messages
        while page.receive(0):
            pass
    page.settle()
    page.event("release")
    page.settle()
    for view in ("3d", "axial"):
        events = [frame.event for frame in page.frames if frame.view == view]
        expect(events == sorted(events), f"{view}: {events}")
        numbers = [frame.number for frame in page.frames if frame.view == view]
        expect(numbers == sorted(set(numbers)), numbers)
    steps = page.scene["undo"][-1]["steps"]
    expect(1 <= steps <= 600, steps)
    page.event("undo", all=True)
    page.carried_out()
    page.close()


def unread_pictures(server, folder):
    """A page that acknowledges nothing gets two pictures, and does not hold up another one."""
    deaf = begin(server, acknowledges=False)
    page = begin(server)
    page.ask(size={"3d": [96, 96]})
    for angle in range(20):
        page.event("camera", camera={"position": [19.5 + angle, -200, 19.5],
                                     "target": [19.5, 19.5, 19.5], "up": [0, 0, 1], "fov": 20})
    page.settle()
    while deaf.receive(0.2):
        pass
    expect(len(deaf.frames) == 2, f"{len(deaf.frames)} pictures without an acknowledgement")
    deaf.acknowledges = True
    deaf.send(ack=deaf.frames[0].number)
    deaf.send(ack=deaf.frames[1].number)
    deaf.until(lambda: deaf.last().picture == page.last().picture)  # both see the same
    expect(deaf.scene["view"]["camera"] == page.scene["view"]["camera"], "and know the same")
    deaf.close()
    page.close()


def cuts_slices_and_settings(server, folder):
    page = begin(server)
    page.ask(size={"3d": [96, 96], "axial": [64, 64], "coronal": [0, 0], "sagittal": [64, 64]})
    page.event("anchor", grab_ball=[20, 20, 8], radius=4)
    page.event("cut", plane={"corner": [0, 0, 20.3], "edge1": [40, 0, 0], "edge2": [0, 18, 0]})
    drag(page, 0.8)
    page.event("release")
    scene = page.carried_out()
    expect(len(scene["anchors"]) == 1 and len(scene["cuts"]) == 1, scene["anchors"])
    expect([stroke["kind"] for stroke in scene["undo"]] == ["anchor", "cut", "drag"], scene["undo"])
    page.event("release", cut=1)
    scene = page.carried_out()
    expect(scene["cuts"] == [], scene["cuts"])
    expect([stroke["kind"] for stroke in scene["undo"]] == ["anchor", "drag"], scene["undo"])
    page.event("relax", passes=12)
    page.until(lambda: page.scene["undo"][-1] ==
               {"text": "relaxation, 12 passes", "kind": "relax", "steps": 3})
    slices = page.ask(slices={"cursor": [20, 12, 20], "overlay": "displacement"})
    expect(slices["cursor"] == [20, 12, 20] and slices["window"] > 0, slices)
    coloured = page.settle(view="axial")
    page.ask(slices={"overlay": "det_f"})
    expect(page.settle(view="axial").picture != coloured.picture, "another overlay")
    expect(page.carried_out()["slices"]["overlay_range"] == [0.5, 1.5], page.scene["slices"])
    page.ask(slices={"overlay": "none"})
    plain = page.settle(view="3d").picture
    for overlay in ("displacement", "det_f", "energy"):
        page.ask(slices={"overlay": overlay, "overlay_in_space": True})
        painted = page.settle(view="3d").picture
        expect(painted != plain, f"{overlay} is painted over the view in space")
        lo, hi = page.carried_out()["slices"]["overlay_range"]
        expect(hi > lo, overlay)
    page.ask(slices={"overlay": "none", "overlay_in_space": False})
    expect(page.settle(view="3d").picture == plain, "without an overlay it is as before")
    page.ask(slices={"outline_in_space": True})
    expect(page.settle(view="3d").picture != plain, "the outline at rest is drawn in space")
    page.ask(slices={"outline_in_space": False})
    expect(page.settle(view="3d").picture == plain, "and it is gone")
    page.ask(deformed=False)
    rest = page.settle(view="3d")
    page.ask(deformed=True)
    expect(page.settle(view="3d").picture != rest.picture, "at rest it looks otherwise")
    page.ask(deformed=0.5)
    half = page.settle(view="3d").picture
    expect(half not in (plain, rest.picture) and page.carried_out()["amount"] == 0.5, page.scene["amount"])
    page.ask(deformed=1)
    expect(page.settle(view="3d").picture == plain, "and all of it as before")
    page.event("limits", limits="tighten")
    page.event("model", model="springs")
    scene = page.carried_out()
    expect((scene["limits"], scene["model"]) == ("tighten", "springs"), scene["model"])
    page.event("limits", limits="box")
    page.event("model", model="fem", fem={"tolerance": 1e-4})
    drag(page, mm=2.0, steps=2)
    strokes = page.scene["undo"]
    page.event("release")
    page.until(lambda: page.scene["undo"][-1]["steps"] > strokes[-1]["steps"])
    expect(len(page.scene["undo"]) == len(strokes), "finite elements belong to the stroke")
    expect(page.scene["model"] == "fem", page.scene["model"])
    page.event("undo", all=True)
    page.event("model", model="ecm")
    material = page.ask(material=True)
    material["max_length"] = [[0, 1.4], [1200, 1.4]]
    page.event("material", material=material)
    page.carried_out()
    expect(page.ask(material=True)["max_length"][0][1] == 1.4, "a new material")
    page.event("undo", all=True)
    page.carried_out()
    expect(page.ask(material=True)["max_length"][0][1] != 1.4, "the old material")
    for _ in range(4):
        page.event("undo", all=True)
    expect(page.carried_out()["undo"] == [] and page.scene["cuts"] == [], page.scene["undo"])
    page.close()


def looks_and_questions(server, folder):
    page = begin(server)
    presets = page.ask(presets=True)
    expect(len(presets) > 10 and presets[0]["opacity"], presets[:1])
    own = dict(presets[0], name="mine", opacity=[[500, 0.0], [900, 0.9]])
    page.event("look", transfer=own)
    expect(page.carried_out()["view"]["transfer"]["opacity"] == own["opacity"], page.scene["view"])
    page.event("look", preset="MR-Default")
    expect(page.carried_out()["view"]["preset"] == "MR-Default", page.scene["view"])
    page.event("clip", clip=[{"box": [0, 0, 0, 20, 40, 40]}])
    expect(len(page.carried_out()["view"]["clips"]) == 1, page.scene["view"]["clips"])
    page.event("clip", clip=[])
    looks_are_taken_back(page, own)
    histogram = page.ask(histogram={"bins": 64})
    expect(sum(histogram["counts"]) == page.scene["volume"]["elements"], histogram)
    expect({"name", "help", "type"} <= set(page.ask(options={"kind": "relax"})[0]), "options")
    expect(page.ask(materials=True)[0]["table"]["shear"], "presets of materials")
    ray = page.ask(pick={"view": "3d", "at": [0.5, 0.5], "ray_only": True})
    expect(ray["ray"]["direction"] and "voxel" not in ray, ray)
    expect(page.ask(pick={"view": "3d", "at": [0.5, 0.5]}) is None, "a corner is empty")
    for message in ({"event": {"kind": "drag", "to": [1, 2]}}, {"event": {"kind": "no"}},
                    {"event": {"kind": "grab"}}, {"size": {"3d": [-1, 5]}}, {"pick": {}},
                    {"size": {"4d": [5, 5]}}, {"slices": {"window": 0}}, {"deformed": 3.1}, {"deformed": "half"},
                    {"options": {"kind": "no"}}, {"histogram": {"bins": 1}},
                    {"event": {"kind": "look", "preset": "no"}}, {"list": 5}):
        try:
            page.ask(**message)
            page.until(lambda: page.logs and page.logs[-1].get("n") == page.n, 10)
        except RuntimeError:
            pass
    page.event("drag", to=[1, 0, 0])  # nothing is grabbed
    page.until(lambda: page.logs and page.logs[-1].get("n") == page.n)
    expect("grab" in page.logs[-1]["text"], page.logs[-1])
    page.close()


def looks_are_taken_back(page, own):
    """In their order among the steps of the body, where that is asked for."""
    def last(name):
        return page.carried_out()[name][-1]["text"]

    page.carried_out()
    before = page.scene["undo"]
    time.sleep(1.1)  # those of a kind within a second are one
    page.event("look", preset="CT-Bone")
    time.sleep(1.1)
    page.event("look", preset="MR-Angio")
    page.event("anchor", grab=[20, 30, 20])
    page.event("clip", clip=[{"box": [0, 0, 0, 20, 40, 40]}])
    expect(last("undo") == "1 clip", page.scene["undo"])
    expect([step["text"] for step in page.scene["undo"][len(before):]] ==
           ["look CT-Bone", "look MR-Angio", "anchor at 20, 30, 20", "1 clip"], page.scene["undo"])
    page.event("undo", all=True)
    expect(last("undo") == "1 clip" and page.scene["anchors"] == [], "only the body, unless asked for")
    page.event("redo", all=True)
    for preset, clips in (("MR-Angio", 0), ("MR-Angio", 0), ("CT-Bone", 0)):
        page.event("undo", all=True, looks=True)
        view = page.carried_out()["view"]
        expect((view["preset"], len(view["clips"])) == (preset, clips), view)
    expect(page.scene["redo"][0]["text"] == "look MR-Angio", page.scene["redo"])
    expect(page.scene["anchors"] == [], "taken back between the looks")
    page.event("redo", all=True, looks=True)
    expect(page.carried_out()["view"]["preset"] == "MR-Angio", page.scene["view"]["preset"])
    for _ in range(3):
        page.event("undo", all=True, looks=True)
    expect(len(page.carried_out()["undo"]) < len(before), page.scene["undo"])


def moves_nothing(page):
    """Events that draw nothing are told all the same, also right after another."""
    page.event("grab", grab=[20, 30, 20])
    for _ in range(3):
        page.event("drag", to=[0, 0, 0])
        page.carried_out()
    page.event("release")
    page.carried_out()


def let_go_of_one(page):
    """Of two handles and two anchors one each; what is left stays where it is, in one step each."""
    page.event("anchor", grab_ball=[20, 20, 8], radius=4)
    page.event("anchor", grab=[20, 30, 20])
    page.event("grab", grab_ball=[20, 12, 20], radius=3, soft=2)
    page.event("drag", to=[0, 0, 0.5])
    page.event("release")
    before = page.carried_out()
    page.settle()
    drawn = page.drawn
    expect((len(before["handles"]), len(before["anchors"])) == (2, 2), before["handles"])
    page.event("release", anchor=1)
    scene = page.carried_out()
    expect(scene["anchors"][0]["event"] == before["anchors"][1]["event"], scene["anchors"])
    expect(scene["handles"] == before["handles"] and len(scene["anchors"]) == 1, scene["handles"])
    page.event("release", handle=1)
    scene = page.carried_out()
    expect([h["event"] for h in scene["handles"]] == [before["handles"][1]["event"]], scene["handles"])
    expect(scene["handles"][0]["lps"] == before["handles"][1]["lps"], "it has not moved")
    expect([stroke["kind"] for stroke in scene["undo"]][-2:] == ["release", "release"], scene["undo"])
    expect(scene["undo"][-1]["text"] == "let go of one, 2 stay", scene["undo"])
    page.event("undo", all=True)
    expect(page.carried_out()["handles"] == before["handles"], "taken back")
    page.event("redo", all=True)
    page.drawn = drawn  # letting go moves nothing, and so do undo and redo of it: nothing is drawn
    page.event("release", anchor=2)
    page.until(lambda: page.logs and page.logs[-1].get("n") == page.n)
    expect("one of 1 that there are" in page.logs[-1]["text"], page.logs[-1])


def files(server, folder):
    page = begin(server)
    page.ask(size={"3d": [96, 96]})
    moves_nothing(page)
    drag(page)
    page.event("release")
    let_go_of_one(page)
    page.settle()
    for what, name, more in (
            ("state", "live.vdb", {}), ("scene", "live.toml", {}), ("journal", "journal.toml", {}),
            ("camera", "camera.toml", {}), ("transfer", "look.toml", {}),
            ("screenshot", "shot.png", {"size": [80, 60]}), ("slices", "slices.png", {}),
            ("screenshot", "axial.png", {"size": [80, 60], "view": "axial"}),
            ("warp", "warp.nrrd", {}), ("warp", "push.nii.gz", {"direction": "material"}),
            ("volume", "moved.nrrd", {}), ("turntable", "turn_%02d.png", {"frames": 3, "size": [32, 32]}),
            ("film", "film_%04d.png", {"size": [32, 32], "frames_per_second": 5, "speed": 2})):
        told = page.ask(save={"what": what, "path": name, **more})
        start, _, end = name.partition("%")
        files = [file for file in os.listdir(folder) if file == name or end and file.startswith(start)]
        expect(told["bytes"] == sum(os.path.getsize(os.path.join(folder, file)) for file in files) > 0, told)
        expect(what != "turntable" or len(files) == 3, files)
        expect(what != "film" or 5 < len(files) < 300, files)
    # The film ends with the picture that is seen.
    subprocess.run([binary(), "replay", "journal.toml", "--quiet", "--image", "end.png", "--size", "32,32"],
                   cwd=folder, check=True)
    subprocess.run([binary(), "compare", "end.png", max(f for f in os.listdir(folder) if f.startswith("film_")),
                    "--quiet", "--max-rmse", "0"], cwd=folder, check=True)
    expect("a_%03d.png" in error_of(page.ask, save={"what": "film", "path": "film.png"}), "a number in the name")
    expect("exists" in error_of(page.ask, save={"what": "film", "path": "film_%04d.png", "size": [32, 32]}), "exists")
    expect("exists" in error_of(page.ask, save={"what": "state", "path": "live.vdb"}), "exists")
    page.ask(save={"what": "state", "path": "live.vdb", "force": True})
    error_of(page.ask, save={"what": "state", "path": "live.png"})
    expect("hidden" in error_of(page.ask, save={"what": "state", "path": ".live.vdb"}), "what no list shows")
    expect(not os.path.exists(os.path.join(folder, ".live.vdb")), "not written")
    # The journal, the scene and the state that were saved lead to the same body.
    run = subprocess.run([binary(), "replay", "journal.toml", "--quiet", "--check", "live.vdb",
                          "--size", "32,32"], cwd=folder)
    expect(run.returncode == 0, "the journal leads to the state")
    run = subprocess.run([binary(), "replay", "live.toml", "--quiet", "--check", "live.vdb", "--size",
                          "32,32"], cwd=folder)
    expect(run.returncode == 0, "the scene leads to the state")
    # The settled picture is that of `supple render`.
    subprocess.run([binary(), "render", "live.vdb", "--quiet", "--camera", "camera.toml", "--preset",
                    page.scene["view"]["preset"], "--size", "80,60", "-o", "render.png"], cwd=folder,
                   check=True)
    with open(os.path.join(folder, "shot.png"), "rb") as shot:
        subprocess.run([binary(), "compare", "shot.png", "render.png", "--max-rmse", "0"], cwd=folder,
                       check=True, stdout=subprocess.DEVNULL)
    # What was saved is listed, and opened again.
    listed = page.ask(list={"path": folder})
    expect({"name", "bytes", "kind"} == set(listed["files"][0]), listed["files"][0])
    expect("live.vdb" in [file["name"] for file in listed["files"]], listed)
    expect(page.ask(list={"path": ""})["folders"] == [os.path.realpath(folder)], "one root")
    page.ask(open={"path": "live.vdb"})
    page.until(lambda: page.scene and page.scene["volume"]["path"].endswith("live.vdb"))
    page.settle()
    moved = surface(page)
    expect(max(abs(d) for d in moved["displacement"]) > 0.3, f"the state is shown moved: {moved}")
    error_of(page.ask, open={"path": "shot.png"})
    error_of(page.ask, open={"path": "missing.nrrd"})
    surface(page)
    page.ask(open={"path": "ball.nrrd", "material": "uniform"})
    page.until(lambda: page.scene and page.scene["volume"]["path"].endswith("ball.nrrd"))
    page.close()


def every_word_is_taken(folder):
    """Words that the page's forms offer, and those of materials, are no names of files."""
    server = Server("ball.nrrd", "--material", "uniform", "--size", "96,96", folder=folder)
    page = begin(server)
    for model in ("springs", "fem"):
        for option in page.ask(options={"kind": model}):
            for choice in option.get("choices", []):
                page.event("model", model=model, **{model: {option["name"]: choice}})
                page.carried_out()
    page.event("model", model="ecm")
    for method in next(o for o in page.ask(options={"kind": "relax"}) if o["name"] == "method")["choices"]:
        page.event("relax", passes=1, method=method)
    for preset in page.ask(materials=True):
        page.event("material", material=preset["table"])
        page.event("undo", all=True, looks=True)
    page.carried_out()
    page.until(lambda: page.scene["relaxing"] == 0)
    wrong = [log["text"] for log in page.logs if log["level"] == "error" and "folders" in log["text"]]
    expect(not wrong, wrong)
    server.stop()


def reconnection(server, folder):
    page = begin(server)
    page.ask(size={"3d": [96, 96]})
    hit = surface(page)
    page.event("grab", grab=hit["voxel"])
    page.event("drag", to=[0.7, 0, 0])
    page.carried_out()
    session, steps = page.hello["session"], len(page.scene["undo"])
    page.socket.close()  # in mid-drag
    again = begin(server)
    expect(again.hello["session"] == session, "the same session")
    again.until(lambda: again.scene["grab"] is None)  # as Esc does
    expect(len(again.scene["undo"]) == steps - 1, again.scene["undo"])
    again.until(lambda: again.last() is not None)
    again.event("redo", all=True)
    expect(len(again.carried_out()["undo"]) == steps, "and nothing is lost")
    again.event("undo", all=True)
    again.carried_out()
    again.close()


def bone_is_fixed(folder):
    """The largest bone of a volume is fixed by an event of the journal, once; handles take what is
    beside it."""
    with open(os.path.join(folder, "ball.nrrd"), "rb") as file:
        volume = bytearray(file.read())
    values = len(volume) - 2 * 40 ** 3
    for i, j, k in ((i, j, k) for i in (28, 29) for j in (19, 20) for k in (19, 20)):
        at = values + 2 * (i + 40 * (j + 40 * k))
        volume[at:at + 2] = (1200).to_bytes(2, "little")
    with open(os.path.join(folder, "bones.nrrd"), "wb") as file:
        file.write(volume)
    with open(os.path.join(folder, "bones.toml"), "w") as file:
        file.write("domain = [0, 1300]\nactive = [1, 1300]\nmax_length = [[0, 1.5]]\n"
                   "min_length = [[0, 0.6]]\nshear = [[0, 0.29]]\nrigid = [1100, 1300]\n")
    server = Server("bones.nrrd", "--material", "bones.toml", "--size", "96,96", folder=folder)
    page = begin(server)
    expect([stroke["kind"] for stroke in page.scene["undo"]] == ["anchor"], page.scene["undo"])
    [anchor] = page.scene["anchors"]
    expect(sum((at - 19.5) ** 2 for at in anchor["event"]["rigid_at"]) <= 16, anchor)
    page.event("grab", grab_ball=[20, 16, 20], radius=3)
    page.event("drag", to=[0.4, 0, 0])
    page.until(lambda: page.logs and page.logs[-1].get("n") == page.n)
    expect("in both" in page.logs[-1]["text"], page.logs[-1])
    page.event("grab", grab_ball=[20, 16, 20], radius=3, spare_fixed=True)
    page.event("drag", to=[0.4, 0, 0])
    page.event("release")
    scene = page.carried_out()
    expect(scene["moved"] > 0 and scene["fraction"] > 0, scene["fraction"])
    for what, name in (("state", "held.vdb"), ("journal", "held_journal.toml"), ("scene", "held.toml")):
        page.ask(save={"what": what, "path": name})
    for name in ("held_journal.toml", "held.toml"):
        run = subprocess.run([binary(), "replay", name, "--quiet", "--check", "held.vdb", "--size", "32,32"],
                             cwd=folder)
        expect(run.returncode == 0, f"{name} leads to the state")
    page.event("release", anchor=1)
    expect(page.carried_out()["anchors"] == [], "let go of")
    page.close()
    server.stop()
    for name, strokes in (("held_journal.toml", ["anchor", "drag"]), ("held.toml", ["step", "step"]),
                          ("held.vdb", [])):
        server = Server(name, "--size", "96,96", folder=folder)
        page = begin(server)
        expect([stroke["kind"] for stroke in page.scene["undo"]] == strokes, (name, page.scene["undo"]))
        page.close()
        server.stop()


def one_hand(server, folder):
    """What one page holds no other page drags, releases or takes; its other events go on."""
    first, second = begin(server), begin(server)
    first.ask(size={"3d": [96, 96]})
    hit = surface(first)
    first.event("grab", grab=hit["voxel"])
    first.event("drag", to=[0.5, 0, 0])
    first.carried_out()
    for keys in ({"kind": "drag", "to": [3, 0, 0]}, {"kind": "release"}, {"kind": "release", "all": True},
                 {"kind": "release", "restore": True}, {"kind": "grab", "grab": [20, 30, 20]},
                 {"kind": "push", "grab": [20, 30, 20]}):
        second.ask(event=keys)
        second.until(lambda: second.logs and second.logs[-1].get("n") == second.n)
        expect("another page" in second.logs[-1]["text"], second.logs[-1])
    second.event("limits", limits="box")
    second.event("anchor", grab=[20, 30, 20])
    expect(len(second.carried_out()["anchors"]) == 1, "other events are carried out")
    expect(second.scene["grab"]["event"]["grab"] == hit["voxel"], second.scene["grab"])
    first.carried_out()
    expect(abs(first.scene["grab"]["reached"][0] - 0.5) < 1e-3, first.scene["grab"])
    expect(not any("another page" in log["text"] for log in first.logs), "who asked is told, no other")
    # Drags of both that wait side by side are not merged.
    for step in range(50):
        first.send(event={"kind": "drag", "to": [0.5 + 0.01 * step, 0, 0]})
        second.send(event={"kind": "drag", "to": [5, 5, 5]})
    first.event("release")
    second.event("grab", grab=[20, 30, 20])
    first.carried_out()
    expect(max(abs(mm) for mm in first.scene["handles"][-1]["lps"]) < 60, first.scene["handles"])
    before = len(second.carried_out()["undo"])
    for _ in range(3):  # the drag before the anchor of the other page, the anchor, the drag after it
        second.event("undo", all=True)
    expect(len(second.carried_out()["undo"]) == before - 3, second.scene["undo"])
    second.event("release", restore=True)
    second.carried_out()
    first.close()
    second.close()


def ends(folder):
    """Ctrl-C, the last page gone, a port that is taken, and a kill in mid-drag."""
    server = Server("ball.nrrd", "--material", "uniform", "--size", "96,96", folder=folder)
    page = begin(server)
    drag(page)
    page.send(event={"kind": "relax", "passes": 1000})
    code, errors = server.stop(signal.SIGINT)
    expect(code == -signal.SIGINT, f"{code} {errors}")
    expect(errors.count("\n") <= 4 and "Sanitizer" not in errors, errors)
    try:
        page.until(lambda: page.bye is not None, 10)
    except Closed:
        raise AssertionError("no good-bye")

    server = Server("ball.nrrd", "--material", "uniform", "--grace", "0.5", folder=folder)
    begin(server).close()
    server.process.wait(20)
    expect(server.stop()[0] == 0, "a session whose last page is gone ends by itself")

    server = Server("ball.nrrd", "--material", "uniform", "--token", "token.txt", "--size", "96,96", folder=folder)
    page = begin(server)
    hit = surface(page)
    page.event("grab", grab=hit["voxel"])
    page.send(event={"kind": "drag", "to": [1, 0, 0]})
    taken = subprocess.run([binary(), "view", "--no-browser", "--port", str(server.port)],
                           capture_output=True, text=True, cwd=folder)
    expect(taken.returncode == 4 and taken.stderr.count("\n") == 1, taken)
    port, token = server.port, server.token
    server.process.kill()
    server.stop()
    again = Server("ball.nrrd", "--material", "uniform", "--token", "token.txt", "--port", str(port), folder=folder)
    expect(again.token == token, "the token outlives the server")
    page = begin(again)
    expect(page.scene["undo"] == [], "a new session")
    page.close()
    again.stop()
    empty = Server(folder=folder)
    page = Page(empty.port, empty.token)
    expect("nothing" in error_of(page.event, "undo"), "nothing is open")
    page.ask(open={"path": "ball.nrrd", "material": "uniform"})
    page.until(lambda: page.scene is not None)
    page.settle(event=0)
    empty.stop()


def main():
    with ball_folder() as folder:
        with Server("ball.nrrd", "--material", "uniform", "--size", "96,96", folder=folder) as server:
            for part in (pictures_and_scene, drags_and_undo, latest_wins, unread_pictures,
                         cuts_slices_and_settings, looks_and_questions, reconnection, one_hand, files):
                begun = time.monotonic()
                part(server, folder)
                print(f"{part.__name__}: {time.monotonic() - begun:.1f} s", flush=True)
        for part in (every_word_is_taken, bone_is_fixed, ends):
            part(folder)
            print(part.__name__)


if __name__ == "__main__":
    try:
        main()
    except (AssertionError, RuntimeError, TimeoutError, Closed, Refused) as error:
        import traceback
        traceback.print_exc()
        sys.exit(1)
