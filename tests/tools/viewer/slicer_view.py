"""The scripted module of 3D Slicer without Slicer: its session with the program, a drag and saves by a
page, and what comes back as nodes. What Slicer would give is stood in for."""
import os
import sys
import tempfile
import types

sys.path.insert(0, os.path.dirname(__file__))
import page as pages  # noqa: E402

LOADED = []


class Node:
    def __init__(self, path):
        self.path, self.transform = path, None

    def GetID(self):
        return self.path

    def SetAndObserveTransformNodeID(self, name):
        self.transform = name


def load(loader):
    def loads(path):
        LOADED.append((loader, os.path.basename(path)))
        return Node(path)
    return loads


def stand_in():
    """Modules of Slicer, as far as the logic asks for them."""
    class Anything:
        def __init__(self, *_):
            pass
    qt, slicer, util = types.ModuleType("qt"), types.ModuleType("slicer"), types.ModuleType("slicer.util")
    scripted = types.ModuleType("slicer.ScriptedLoadableModule")
    for name in ("ScriptedLoadableModule", "ScriptedLoadableModuleLogic", "ScriptedLoadableModuleWidget"):
        setattr(scripted, name, Anything)
    for loader in ("loadTransform", "loadVolume", "loadModel", "loadMarkups"):
        setattr(util, loader, load(loader))
    util.saveNode = lambda node, path: os.link(node.path, path) is None
    slicer.util = util
    sys.modules.update({"qt": qt, "slicer": slicer, "slicer.util": util,
                        "slicer.ScriptedLoadableModule": scripted})
    here = os.path.dirname(os.path.abspath(__file__))
    sys.path.insert(0, os.path.join(here, "../../../tools/slicer"))


def refusal(act):
    try:
        act()
    except RuntimeError as error:
        return str(error)
    raise AssertionError("nothing was refused")


def main():
    stand_in()
    import SuppleView
    os.environ["LD_LIBRARY_PATH"] = "/nowhere/of/slicer"
    os.environ["XDG_STATE_HOME"] = pages.STATE.name
    with tempfile.TemporaryDirectory(prefix="supple view ") as folder:
        ball = os.path.join(folder, "ball.nrrd")
        pages.write_ball(ball, 24, 9)
        logic = SuppleView.SuppleViewLogic()
        node = Node(ball)
        address = logic.start(node, pages.binary(), "uniform", opens_browser=False)
        assert logic.bring() == [] and LOADED == [], LOADED
        with open(f"/proc/{logic.session.process.pid}/environ", "rb") as environment:
            assert b"/nowhere/of/slicer" not in environment.read(), "Slicer's libraries are its own"
        server, token = address.split("/#")
        page = pages.Page(int(server.rsplit(":", 1)[1]), token)
        page.ask(event={"kind": "grab", "grab": [12, 12, 19]})
        page.ask(event={"kind": "drag", "to": [0, 0, 2]})
        page.ask(event={"kind": "release"})
        page.ask(save={"what": "warp", "path": "a warp.nrrd"})
        page.ask(save={"what": "volume", "path": "moved.nrrd"})
        page.ask(save={"what": "journal", "path": "drag.toml"})
        page.ask(save={"what": "warp", "path": "other.nii.gz"})
        page.ask(save={"what": "volume", "path": "other_moved.nii"})
        assert len(logic.bring(moves_volume=True)) == 4
        assert LOADED == [("loadTransform", "a warp.nrrd"), ("loadVolume", "moved.nrrd"),
                          ("loadTransform", "other.nii.gz"), ("loadVolume", "other_moved.nii")], LOADED
        assert node.transform.endswith("other.nii.gz"), node.transform
        assert logic.bring() == []
        page.ask(save={"what": "volume", "path": "moved.nrrd", "force": True})
        logic.bring()
        assert LOADED[4:] == [("loadVolume", "moved.nrrd")], "what is replaced comes again"
        page.close()
        process, kept = logic.session.process, logic.folder
        logic.stop()
        assert process.poll() is not None and not os.path.exists(kept), "nothing stays"
        logic.stop()

        said = refusal(lambda: logic.start(node, os.path.join(folder, "no program")))
        assert said.endswith("no program: No such file or directory, expected the program supple"), said
        said = refusal(lambda: logic.start(node, pages.binary(), "no-such-table", False))
        assert "no-such-table" in said and "\n" not in said, said
        assert logic.session is None and logic.folder is None, "a start that fails leaves nothing"
    print("ok")


if __name__ == "__main__":
    main()
