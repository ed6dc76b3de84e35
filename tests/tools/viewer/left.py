"""Sessions that end without being saved: their journal on disk is whole at any moment, the next start
offers to go on, and going on leads to the same bytes. Folders and disks that take nothing."""
import glob
import os
import resource
import signal
import stat
import subprocess
import sys
import tempfile
import time
import tomllib

from page import Closed, Page, Refused, Server, ball_folder, binary


def expect(condition, what):
    if not condition:
        raise AssertionError(what)


def begin(server):
    page = Page(server.port, server.token)
    page.until(lambda: page.scene is not None)
    return page


def journals(state):
    return sorted(glob.glob(state + "/supple/sessions/*.toml"))


def only_journal(state):
    expect(len(journals(state)) == 1, journals(state))
    return journals(state)[0]


def read(path):
    with open(path, "rb") as file:
        return file.read()


def kill(server):
    server.process.kill()
    server.stop()


def deform(page):
    """Everything that an event can be, and a grab that is still open."""
    page.event("anchor", grab_ball=[20, 20, 8], radius=4)
    page.event("grab", grab_ball=[20, 30, 20], radius=2, soft=2)
    for step in range(1, 5):
        page.event("drag", to=[0.2 * step, 0, 0.1 * step])
    page.event("release")
    page.event("cut", plane={"corner": [0, 0, 20.3], "edge1": [40, 0, 0], "edge2": [0, 18, 0]})
    page.event("relax", passes=12)
    page.event("look", preset="MR-Default")
    page.event("undo", all=True, looks=True)
    page.event("grab", grab=[20, 12, 20])
    page.event("drag", to=[0, -0.7, 0])
    page.carried_out()
    page.until(lambda: page.scene["relaxing"] == 0)


def killed_and_gone_on_with(folder, state):
    server = Server("ball.nrrd", "--material", "uniform", folder=folder, state=state)
    page = begin(server)
    expect("left" not in page.hello, "nothing was left")
    expect(journals(state) == [], "nothing is kept before there is an event")
    deform(page)
    page.ask(save={"what": "state", "path": "lost.vdb"})
    page.event("drag", to=[0, -0.9, 0.2])
    page.carried_out()
    kept = only_journal(state)
    kill(server)
    expect(stat.S_IMODE(os.stat(os.path.dirname(kept)).st_mode) == 0o700, "its folder is private")
    expect(stat.S_IMODE(os.stat(kept).st_mode) == 0o600, "it is private")
    lost = folder + "/replayed.vdb"
    subprocess.run([binary(), "replay", kept, "--quiet", "--size", "32,32", "--state", lost],
                   check=True)

    server = Server("ball.nrrd", "--material", "uniform", folder=folder, state=state)
    page = begin(server)
    expect(page.scene["undo"] == [], "nothing is replayed without being asked")
    expect(page.hello["left"]["unsaved"] == 1 and "ball.nrrd" in page.hello["left"]["text"], page.hello)
    page.ask(go_on=True)
    page.until(lambda: page.scene["grab"] is not None)
    expect([step["kind"] for step in page.scene["undo"]][:3] == ["anchor", "drag", "cut"], page.scene["undo"])
    page.ask(save={"what": "state", "path": "gone_on.vdb"})
    expect(read(folder + "/gone_on.vdb") == read(lost), "the same bytes")
    expect(read(folder + "/lost.vdb") != read(lost), "the last drag is there")
    expect(journals(state) == [], "what is saved is not kept")
    # The hand goes on, and so does the journal.
    page.event("drag", to=[0, -1, 0.2])
    page.event("release")
    page.carried_out()
    page.ask(save={"what": "state", "path": "further.vdb"})
    subprocess.run([binary(), "replay", only_journal(state), "--quiet", "--size", "32,32", "--check",
                    folder + "/further.vdb"], check=True)
    server.stop()
    expect(journals(state) == [], "a session that ends with all saved leaves nothing")


def ways_to_go_on(folder, state):
    """By an option, from the page without an input, anew; never of what runs or was saved."""
    server = Server("ball.nrrd", "--material", "uniform", folder=folder, state=state)
    page = begin(server)
    page.event("anchor", grab=[20, 30, 20])
    page.carried_out()
    beside = Server("ball.nrrd", "--material", "uniform", folder=folder, state=state)
    expect("left" not in begin(beside).hello, "a session that runs is not left")
    beside.stop()
    kill(server)
    nothing = subprocess.run([binary(), "view", "--no-browser", "--go-on", "other.nrrd"], cwd=folder,
                             capture_output=True, text=True, env={**os.environ, "XDG_STATE_HOME": state})
    expect(nothing.returncode == 3 and nothing.stderr.count("\n") == 1, nothing)
    with tempfile.TemporaryDirectory() as elsewhere:
        server = Server(folder=elsewhere, state=state)
        expect("left" not in Page(server.port, server.token).hello_now(), "volumes outside are not told of")
        server.stop()
    server = Server(folder=folder, state=state)
    page = Page(server.port, server.token)
    expect(page.hello_now()["left"]["unsaved"] == 1, page.hello)
    page.ask(go_on=False)
    expect("left" not in Page(server.port, server.token).hello_now(), "begun anew")
    server.stop()
    expect(len(journals(state)) == 1, "it stays on disk")
    server = Server("ball.nrrd", "--material", "uniform", "--go-on", folder=folder, state=state)
    page = begin(server)
    expect(len(page.scene["anchors"]) == 1 and "left" not in page.hello, page.scene["anchors"])
    page.event("camera", camera={"view": "left"})
    page.carried_out()
    expect(len(journals(state)) == 1, "one journal goes over into the other")
    page.ask(save={"what": "journal", "path": "kept.toml"})
    server.stop()
    expect(journals(state) == [], journals(state))


def whole_at_any_moment(folder, state):
    server = Server("ball.nrrd", "--material", "uniform", folder=folder, state=state)
    page = begin(server)
    page.event("grab", grab=[20, 30, 20])
    page.carried_out()
    kept = only_journal(state)
    read_events = 0
    for step in range(150):
        page.send(event={"kind": "drag", "to": [0.004 * step, 0, 0]})
        page.send(event={"kind": "camera", "camera": {"position": [step, -200, 19], "target": [19, 19, 19],
                                                      "up": [0, 0, 1], "fov": 20}})
        while page.receive(0.004):
            pass
        events = tomllib.loads(read(kept).decode())["event"]
        expect(read_events <= len(events) + 1, "events do not vanish")
        read_events = len(events)
    page.carried_out()
    kill(server)
    expect(read(kept).endswith(b"\n"), "it ends with an event")
    # A machine that lost its power may have written a piece.
    with open(kept, "ab") as file:
        file.write(b'\n[[event]]\nkind = "dra')
    server = Server("ball.nrrd", "--material", "uniform", "--go-on", folder=folder, state=state)
    expect(abs(begin(server).scene["grab"]["reached"][0] - 0.004 * 149) < 1e-3, "all but the piece")
    server.stop()
    for path in journals(state):
        os.remove(path)


def off_and_pruned(folder, state):
    server = Server("ball.nrrd", "--material", "uniform", "--no-journal", folder=folder, state=state)
    page = begin(server)
    page.event("anchor", grab=[20, 30, 20])
    page.carried_out()
    kill(server)
    expect(journals(state) == [], "none is asked for")
    sessions = state + "/supple/sessions"
    for n in range(30):
        path = f"{sessions}/old-{n:02d}.toml"
        with open(path, "w") as file:
            file.write("# of another time\n")
        os.utime(path, (n, n))
    server = Server("ball.nrrd", "--material", "uniform", folder=folder, state=state)
    page = begin(server)
    page.event("anchor", grab=[20, 30, 20])
    page.carried_out()
    server.stop()
    left = [os.path.basename(path) for path in journals(state)]
    expect(len(left) == 21 and "old-29.toml" in left and "old-09.toml" not in left, left)


def takes_nothing(folder):
    """One warning, and the session goes on."""
    def warned(page):
        return [log["text"] for log in page.logs if "the session goes on" in log["text"]]

    server = Server("ball.nrrd", "--material", "uniform", folder=folder, state="/dev/null/none")
    page = begin(server)
    deform(page)
    page.ask(save={"what": "journal", "path": "whole.toml"})
    expect(len(warned(page)) == 1 and "/dev/null/none" in warned(page)[0], page.logs)
    server.stop()
    with tempfile.TemporaryDirectory() as state:
        # Files of at most 3 kB: as a disk that fills.
        def small_files():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))
        server = Server("ball.nrrd", "--material", "uniform", folder=folder, state=state, before=small_files)
        page = begin(server)
        page.event("grab", grab=[20, 30, 20])
        for step in range(100):
            page.event("drag", to=[0.005 * step, 0, 0])
            page.carried_out()
        expect(len(warned(page)) == 1, page.logs)
        expect(abs(page.scene["grab"]["reached"][0] - 0.005 * 99) < 1e-3, page.scene["grab"])
        events = tomllib.loads(read(only_journal(state)).decode())["event"]
        expect(10 < len(events) < 100, len(events))
        kill(server)
    for name in ("lost.vdb", "gone_on.vdb", "further.vdb", "whole.toml", "kept.toml"):
        if os.path.exists(folder + "/" + name):
            os.remove(folder + "/" + name)


def main():
    with ball_folder() as folder, tempfile.TemporaryDirectory(prefix="supple-left-") as state:
        for part in (killed_and_gone_on_with, ways_to_go_on, whole_at_any_moment, off_and_pruned):
            begun = time.monotonic()
            part(folder, state)
            print(f"{part.__name__}: {time.monotonic() - begun:.1f} s", flush=True)
        takes_nothing(folder)
        print("takes_nothing")


if __name__ == "__main__":
    try:
        main()
    except (AssertionError, RuntimeError, TimeoutError, Closed, Refused, subprocess.CalledProcessError):
        import traceback
        traceback.print_exc()
        sys.exit(1)
