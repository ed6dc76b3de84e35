"""What is opened and from where: materials that are assumed, scenes of several views, states that list
what they hold, proxies, other ports and addresses."""
import json
import os
import socket
import struct
import subprocess
import sys
import tempfile
import time

from page import Closed, Page, Refused, Server, ball_folder, binary


def expect(condition, what):
    if not condition:
        raise AssertionError(what)


def begin(server, **headers):
    page = Page(server.port, server.token, **headers)
    page.until(lambda: page.scene is not None)
    return page


def write_scan(path, air, tissue, bone, size=32, mm=4.0, extra=None):
    """A head of soft tissue with a bone in it, and a bar beside it as a headrest is."""
    values = bytearray()
    middle = (size - 1) / 2
    for k in range(size):
        for j in range(size):
            for i in range(size):
                r2 = (i - middle) ** 2 + (j - middle) ** 2 + (k - middle) ** 2
                value = bone if r2 < 16 else tissue if r2 < 100 else air
                if j >= size - 2:
                    value = tissue
                values += struct.pack("<h", value)
    head = ("NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\n"
            f"sizes: {size} {size} {size}\nspace directions: ({mm},0,0) (0,{mm},0) (0,0,{mm})\n"
            "space origin: (0,0,0)\nendian: little\nencoding: raw\n\n")
    with open(path, "wb") as file:
        file.write(head.encode() + bytes(values))


def materials_are_assumed(folder):
    """By the densities, without air and headrest; the scene says so, and the journal has it."""
    write_scan(folder + "/ct.nrrd", -1000, 40, 1200)
    write_scan(folder + "/body.nrrd", -1000, 40, 1200, mm=12.0)
    write_scan(folder + "/mr.nrrd", 0, 120, 200)
    server = Server(folder=folder)
    page = Page(server.port, server.token)
    ball = sum(1 for k in range(32) for j in range(32) for i in range(32)
               if (i - 15.5) ** 2 + (j - 15.5) ** 2 + (k - 15.5) ** 2 < 100)
    for name, preset in (("ct.nrrd", "ct-head"), ("body.nrrd", "ct-body"), ("mr.nrrd", "mr-brain")):
        page.ask(open={"path": name})
        page.until(lambda: page.scene and page.scene["volume"]["path"].endswith(name))
        assumed = page.scene["assumed"]
        expect(preset + " is assumed" in assumed, assumed)
        expect(page.scene["volume"]["elements"] == ball, (name, page.scene["volume"]["elements"], ball))
        expect(f"{ball} of {32 ** 3} voxels" in assumed, assumed)
    page.ask(save={"what": "journal", "path": "assumed.toml"})
    with open(folder + "/assumed.toml") as journal:
        expect('preset = "mr-brain"' in journal.read(), "it stands in the journal")
    page.ask(open={"path": "ct.nrrd", "material": "uniform"})
    page.until(lambda: page.scene["volume"]["path"].endswith("ct.nrrd"))
    expect("assumed" not in page.scene, "what is given is not assumed")
    expect(page.scene["volume"]["elements"] > ball + 1000, "all above the least density, as is asked")
    page.ask(open={"path": "assumed.toml"})
    page.until(lambda: page.scene["volume"]["path"].endswith("mr.nrrd"))
    expect("assumed" not in page.scene, "a journal says what it is")
    server.stop()


def write_dicom(folder, modality, air, tissue):
    """A series of slices as scanners write it, explicit VR little endian, by hand."""
    def element(group, number, vr, value):
        value = value.encode() if isinstance(value, str) else value
        value += b" " if len(value) % 2 and vr not in ("UI", "OW") else b"\0" if len(value) % 2 else b""
        long = struct.pack("<HI", 0, len(value)) if vr == "OW" else struct.pack("<H", len(value))
        return struct.pack("<HH", group, number) + vr.encode() + long + value

    os.makedirs(folder, exist_ok=True)
    size = 16
    for k in range(size):
        uid = f"1.2.826.0.1.3680043.8.498.7.{k + 1}"
        meta = (element(2, 2, "UI", "1.2.840.10008.5.1.4.1.1.2") + element(2, 3, "UI", uid) +
                element(2, 16, "UI", "1.2.840.10008.1.2.1"))
        values = [(1200 if (i - 8) ** 2 + (j - 8) ** 2 + (k - 8) ** 2 < 6 else tissue)
                  if (i - 8) ** 2 + (j - 8) ** 2 + (k - 8) ** 2 < 36 else air
                  for j in range(size) for i in range(size)]
        data = (element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2") + element(8, 0x18, "UI", uid) +
                element(8, 0x60, "CS", modality) + element(0x20, 0xD, "UI", "1.2.826.0.1.3680043.8.498.8") +
                element(0x20, 0xE, "UI", "1.2.826.0.1.3680043.8.498.7") + element(0x20, 0x32, "DS", f"0\\0\\{10 * k}") +
                element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0") + element(0x28, 2, "US", struct.pack("<H", 1)) +
                element(0x28, 4, "CS", "MONOCHROME2") + element(0x28, 0x10, "US", struct.pack("<H", size)) +
                element(0x28, 0x11, "US", struct.pack("<H", size)) + element(0x28, 0x30, "DS", "10\\10") +
                element(0x28, 0x100, "US", struct.pack("<H", 16)) + element(0x28, 0x101, "US", struct.pack("<H", 16)) +
                element(0x28, 0x102, "US", struct.pack("<H", 15)) + element(0x28, 0x103, "US", struct.pack("<H", 1)) +
                element(0x7FE0, 0x10, "OW", struct.pack(f"<{size * size}h", *values)))
        with open(f"{folder}/{k:02d}.dcm", "wb") as file:
            file.write(b"\0" * 128 + b"DICM" + element(2, 0, "UL", struct.pack("<I", len(meta))) + meta + data)


def modality_comes_before_densities(folder):
    """CT without air and MR that reaches below it are known by DICOM's tag; without it densities are asked."""
    for modality, air, preset, by in (("CT", 0, "ct-head", "its modality is CT"),
                                      ("MR", -300, "mr-brain", "its modality is MR"),
                                      ("OT", -1000, "ct-head", "densities are HU")):
        series = f"{folder}/series_{modality}"
        write_dicom(series, modality, air, 100)
        told = json.loads(subprocess.run([binary(), "info", series, "--json", "--quiet"], capture_output=True,
                                         check=True).stdout)
        expect(told["modality"] == modality, told)
        server = Server(series, folder=folder)
        assumed = begin(server).scene["assumed"]
        expect(f"{preset} is assumed" in assumed and by in assumed, assumed)
        server.stop()


def ct_is_seen_from_outside(folder):
    """By its skin, which moves where a hand drags; a look that is given stays, and no event says so."""
    write_scan(folder + "/ct.nrrd", -1000, 40, 1200)
    for options, look in (((), "Skin"), (("--preset", "Bone"), "Bone")):
        server = Server("ct.nrrd", *options, folder=folder)
        page = begin(server)
        expect(page.scene["view"]["preset"] == look, page.scene["view"]["preset"])
        expect([step["kind"] for step in page.scene["undo"]] == ["anchor"], page.scene["undo"])
        page.event("look", preset="CT-Bone")
        page.event("undo", looks=True)
        expect(page.carried_out()["view"]["preset"] == look, "taken back to what it began with")
        page.ask(save={"what": "journal", "path": f"look_{look}.toml"})
        page.ask(save={"what": "state", "path": f"look_{look}.vdb"})
        page.ask(open={"path": f"look_{look}.toml"})
        page.until(lambda: page.scene["volume"]["path"].endswith("ct.nrrd") and page.scene["undo"])
        expect(page.scene["view"]["preset"] == look, "the journal says so")
        page.ask(open={"path": f"look_{look}.vdb"})
        page.until(lambda: page.scene["volume"]["path"].endswith(".vdb"))
        expect(page.scene["view"]["preset"] == "Skin", "a state says nothing of its look")
        server.stop()
    with open(folder + "/plain.toml", "w") as scene:
        scene.write('[volume]\npath = "ct.nrrd"\n[material]\npreset = "ct-head"\n[[view]]\nimage = "a.png"\n')
    server = Server("plain.toml", folder=folder)
    expect(begin(server).scene["view"]["preset"] == "Bone", "a scene is seen as supple run draws it")
    server.stop()


def scenes_of_several_views_open(folder):
    with open(folder + "/several.toml", "w") as scene:
        scene.write('[volume]\npath = "ball.nrrd"\n'
                    '[[view]]\nimage = "rest.png"\ndeformed = false\n'
                    '[[view]]\nimage = "slice.png"\nslice = { plane = "axial" }\n'
                    '[[view]]\nimage = "space.png"\npreset = "MR-Default"\n'
                    '[[view]]\nimage = "turn_%02d.png"\nturntable = 4\n')
    server = Server("several.toml", folder=folder)
    expect(begin(server).scene["view"]["preset"] == "MR-Default", "the first of the body at the end")
    code, errors = server.stop()
    expect("of 4 views number 3 is shown" in errors, errors)


def files_of_the_view_are_found_from_any_folder(folder):
    """A look of a file beside the scene, the camera turned, the journal saved elsewhere."""
    os.makedirs(folder + "/scenes/below", exist_ok=True)
    server = Server("ball.nrrd", "--material", "uniform", folder=folder)
    page = begin(server)
    page.event("look", preset="MR-Default")
    page.carried_out()
    page.ask(save={"what": "transfer", "path": "scenes/look.toml"})
    server.stop()
    with open(folder + "/scenes/look_scene.toml", "w") as scene:
        scene.write('[volume]\npath = "../ball.nrrd"\n[[view]]\nimage = "a.png"\n'
                    'transfer = "look.toml"\n')
    server = Server("scenes/look_scene.toml", folder=folder)
    page = begin(server)
    look = page.scene["view"]["transfer"]
    page.event("camera", camera={"view": "left"})
    page.event("look", preset="CT-Bone")
    page.event("undo", looks=True)
    expect(page.carried_out()["view"]["transfer"] == look, "the file is found again")
    expect(not [log for log in page.logs if log["level"] == "error"], page.logs)
    page.ask(save={"what": "journal", "path": "scenes/below/journal.toml"})
    server.stop()
    subprocess.run([binary(), "replay", "scenes/below/journal.toml", "--quiet", "--size", "32,32"],
                   cwd=folder, check=True)


def states_list_what_they_hold(folder):
    server = Server("ball.nrrd", "--material", "uniform", folder=folder)
    page = begin(server)
    page.event("anchor", grab_ball=[20, 20, 8], radius=4)
    page.event("anchor", grab=[20, 30, 20])
    page.event("cut", curve={"points": [[15, 5, 30], [25, 5, 30]], "direction": [0, 1, 0], "depth": 8,
                             "above": 3})
    page.event("grab", grab_ball=[20, 12, 20], radius=3, soft=2)
    page.event("drag", to=[0, 0, 0.5])
    page.event("drag", to=[0, 0, 0.8])
    page.event("release")
    before = page.carried_out()
    expect((len(before["handles"]), len(before["anchors"]), len(before["cuts"])) == (1, 2, 1), before)
    page.ask(save={"what": "state", "path": "held.vdb"})
    page.ask(open={"path": "held.vdb"})
    page.until(lambda: page.scene["volume"]["path"].endswith("held.vdb"))
    after = page.scene
    expect(len(after["handles"]) == 1, after["handles"])
    for key in ("lps", "rest_lps", "voxel"):
        expect(all(abs(a - b) < 0.05 for a, b in
                   zip(after["handles"][0][key], before["handles"][0][key])), after["handles"])
    expect(after["handles"][0]["event"]["radius"] == 3 and "number" not in after["handles"][0], after["handles"])
    expect(after["handles"][0]["is_place"] and "is_place" not in before["handles"][0], "nothing holds it any more")
    expect("number" in before["handles"][0] and "number" in before["anchors"][1], before)
    anchors = [anchor["event"].get("grab_ball", anchor["event"].get("grab_box")) for anchor in after["anchors"]]
    expect(sorted(anchors) == [[20, 20, 8], [20, 30, 20, 20, 30, 20]], after["anchors"])
    curve = after["cuts"][0]["event"]["curve"]
    expect(curve["points"] == [[15, 5, 30], [25, 5, 30]] and curve["depth"] == 8, after["cuts"])
    # What is made from now on has numbers of its own, as a release counts them.
    page.event("cut", plane={"corner": [0, 0, 20.3], "edge1": [40, 0, 0], "edge2": [0, 18, 0]})
    scene = page.carried_out()
    expect([cut.get("number") for cut in scene["cuts"]] == [None, 1], scene["cuts"])
    page.event("release", cut=1)
    expect(len(page.carried_out()["cuts"]) == 1, page.scene["cuts"])
    # Beside anchors of a state one alone cannot be let go of: none is offered, until all were let go of.
    page.event("anchor", grab=[12, 20, 20])
    expect([anchor.get("number") for anchor in page.carried_out()["anchors"]] == [None] * 3, page.scene["anchors"])
    page.event("release", all=True)
    scene = page.carried_out()
    expect(scene["handles"] == [] and scene["anchors"] == [] and len(scene["cuts"]) == 1, scene)
    page.event("anchor", grab=[12, 20, 20])
    page.event("anchor", grab=[20, 30, 20])
    expect([anchor.get("number") for anchor in page.carried_out()["anchors"]] == [1, 2], page.scene["anchors"])
    page.event("release", anchor=1)
    expect(len(page.carried_out()["anchors"]) == 1, page.scene["anchors"])
    expect(not [log for log in page.logs if log["level"] == "error"], page.logs)
    # A patch is drawn by its side that lies furthest out.
    page.event("cut", plane={"corner": [20, 18, 10], "edge1": [0, -18, 0], "edge2": [0, 0, 18]})
    sheet = page.carried_out()["cuts"][-1]["sheet"]
    expect(all(abs(place[1]) < 0.6 for place in sheet["line"]) and sheet["down"][1] > 17, sheet)
    server.stop()


def get(port, target, host, **headers):
    lines = [f"GET {target} HTTP/1.1", f"Host: {host}"]
    lines += [f"{name}: {value}" for name, value in headers.items()]
    with socket.create_connection(("127.0.0.1", port), timeout=10) as raw:
        raw.sendall(("\r\n".join(lines) + "\r\nConnection: close\r\n\r\n").encode())
        data = b""
        while more := raw.recv(65536):
            data += more
    return data.decode()


def from_elsewhere(folder):
    """Another forwarded port, a proxy below a path, and an address of a container."""
    server = Server("ball.nrrd", "--material", "uniform", folder=folder)
    refused = get(server.port, "/", "localhost:9000")
    expect(refused.startswith("HTTP/1.1 403") and "supple view --origin http://localhost:9000" in refused, refused)
    expect(f"127.0.0.1:{server.port}" in refused and server.token not in refused, refused)
    server.stop()

    hub = "https://hub.example"
    server = Server("ball.nrrd", "--material", "uniform", "--origin", "http://localhost:9000", "--origin", hub,
                    "--base-path", "/user/me/proxy/80", folder=folder)
    for host, origin in (("localhost:9000", "http://localhost:9000"), ("hub.example", hub),
                         (f"localhost:{server.port}", hub)):
        begin(server, Host=host, Origin=origin).close()
        for target in ("/", "/main.js", "/user/me/proxy/80/", "/user/me/proxy/80/main.js"):
            expect(get(server.port, target, host).startswith("HTTP/1.1 200"), (host, target))
    moved = get(server.port, "/user/me/proxy/80", "hub.example")
    expect("308" in moved.split("\r\n")[0] and "ocation: /user/me/proxy/80/\r\n" in moved, moved)
    begin(server, target="/user/me/proxy/80/socket", Host="hub.example", Origin=hub).close()
    for host, origin in (("hub.example", "https://evil.example"), ("evil.example", hub), ("hub.example", "null"),
                         ("hub.example", "http://hub.example"), (f"hub.example:{server.port}", hub)):
        try:
            begin(server, Host=host, Origin=origin)
        except Refused:
            continue
        raise AssertionError(f"a socket of {host} {origin}")
    for target in ("/user/me/proxy/80/../../etc/passwd", "/user/me/proxy/80//etc/passwd", "/user/me/main.js"):
        expect(get(server.port, target, "hub.example").startswith("HTTP/1.1 404"), target)
    server.stop()

    server = Server("ball.nrrd", "--material", "uniform", "--listen", "0.0.0.0", folder=folder)
    begin(server).close()
    try:
        Page(server.port, "0" * 32)
        raise AssertionError("no token")
    except Refused:
        pass
    expect(get(server.port, "/", f"192.168.1.5:{server.port}").startswith("HTTP/1.1 403"), "other hosts")
    code, errors = server.stop()
    expect("listening on 0.0.0.0" in errors, errors)
    for options, words in ((("--listen", "nowhere"), "--listen"), (("--origin", "hub"), "--origin"),
                           (("--base-path", "proxy"), "--base-path")):
        wrong = subprocess.run([binary(), "view", "--no-browser", *options], cwd=folder, capture_output=True,
                               text=True)
        expect(wrong.returncode == 3 and words in wrong.stderr and wrong.stderr.count("\n") == 1, wrong)


def main():
    with ball_folder() as folder:
        for part in (materials_are_assumed, modality_comes_before_densities, ct_is_seen_from_outside, scenes_of_several_views_open,
                     files_of_the_view_are_found_from_any_folder, states_list_what_they_hold, from_elsewhere):
            begun = time.monotonic()
            part(folder)
            print(f"{part.__name__}: {time.monotonic() - begun:.1f} s", flush=True)


if __name__ == "__main__":
    try:
        main()
    except (AssertionError, RuntimeError, TimeoutError, Closed, Refused, subprocess.CalledProcessError):
        import traceback
        traceback.print_exc()
        sys.exit(1)
