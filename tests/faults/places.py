"""What is no file, or none to be read, in the place of every input; values that are no numbers."""
import os
import struct

from program import BAD_INPUT, SYSTEM, USAGE, Policy
import seeds
from seeds import Seed

NAN, INF = float("nan"), float("inf")
MATERIAL = ("domain = [-1000, 1000]\nactive = [-300, 1000]\nmax_length = [[0, 1.3]]\n"
            "min_length = [[0, 0.7]]\nshear = [[0, 0.3]]\n")
DEFORM = ["deform", "a.nrrd", "--material", "soft.toml", "--grab", "4,3,2", "--by", "0.1,0,0", "-o",
          "out.vdb"]
RENDER = ["render", "a.nrrd", "--size", "16,16", "-o", "out.png"]
VOLUME_NAMES = ["x.nrrd", "x.nhdr", "x.mha", "x.mhd", "x.nii", "x.nii.gz", "x.hdr", "x.tif", "x.png",
                "x.h5", "x.h5:/v", "x.vdb", "x.dcm", "x"]


def readers():
    """(command, name of the file that it will read)"""
    for name in VOLUME_NAMES:
        yield ["info", name], name.split(":")[0]
    yield ["info", "x.raw", "--raw", "dims=8,6,5,type=int16,spacing=1,1,2"], "x.raw"
    yield ["convert", "x.nrrd", "out.nrrd"], "x.nrrd"
    yield ["deform", "x.vdb", *DEFORM[2:]], "x.vdb"
    yield DEFORM[:3] + ["x.toml"] + DEFORM[4:], "x.toml"
    yield DEFORM[:5] + ["x.csv"] + DEFORM[6:], "x.csv"
    yield DEFORM + ["--fix", "x.csv"], "x.csv"
    yield DEFORM + ["--labels", "x.nii"], "x.nii"
    for extension in ("stl", "ply", "obj"):
        yield DEFORM + ["--cut", "x." + extension], "x." + extension
    yield RENDER + ["--mesh", "x.ply"], "x.ply"
    yield RENDER + ["--offsets", "x.nrrd"], "x.nrrd"
    yield RENDER + ["--preset", "x.toml"], "x.toml"
    yield RENDER + ["--camera", "x.toml"], "x.toml"
    yield RENDER + ["--path", "x.toml"], "x.toml"
    yield ["run", "x.toml"], "x.toml"
    yield ["slice", "x.nii", "-o", "out.png"], "x.nii"
    yield ["invert", "x.h5", "-o", "out.nrrd"], "x.h5"
    yield ["compare", "x.png", "x.png"], "x.png"
    yield ["apply", "x.nrrd", "--points", "p.csv", "-o", "out.csv"], "x.nrrd"
    yield ["apply", "warp.nrrd", "--points", "x.csv", "-o", "out.csv"], "x.csv"
    yield ["apply", "warp.nrrd", "--mesh", "x.vtk", "-o", "out.vtk"], "x.vtk"
    yield ["apply", "warp.nrrd", "--labels", "x.nii", "-o", "out.nii"], "x.nii"
    yield ["resample", "x.vdb", "-o", "out.nrrd"], "x.vdb"
    yield ["metrics", "x.vdb"], "x.vdb"
    yield ["export", "x.vdb", "-o", "out.nrrd"], "x.vdb"


def make_locked(path):
    with open(path, "wb") as file:
        file.write(seeds.nrrd("raw", seeds.VALUES))
    os.chmod(path, 0)


def in_every_place(policy):
    kinds = {"missing": lambda path: None, "FIFO": os.mkfifo, "directory": os.mkdir,
             "broken link": lambda path: os.symlink("nowhere", path),
             "empty": lambda path: open(path, "wb").close()}
    if os.geteuid() != 0:
        kinds["unreadable"] = make_locked
    for kind, make in kinds.items():
        for command, name in readers():
            make(policy.path(name))
            policy.expect("%s in %s" % (kind, " ".join(command)), [*command, "--quiet"],
                          [USAGE, BAD_INPUT, SYSTEM], [name])
            if os.path.isdir(policy.path(name)) and not os.path.islink(policy.path(name)):
                os.rmdir(policy.path(name))
            elif os.path.lexists(policy.path(name)):
                os.remove(policy.path(name))


def floats(values):
    return seeds.nrrd("raw", struct.pack("<240f", *values)).replace(b"type: short", b"type: float")


def odd_values(policy):
    """Voxels that are no numbers are void and said; vectors that are none are refused."""
    ramp = [float(n) for n in range(240)]
    odd = {"NaN": [NAN] + ramp[1:], "infinity": [INF, -INF] + ramp[2:], "all NaN": [NAN] * 240,
           "all infinite": [INF] * 240, "constant": [7.0] * 240, "huge": [3e38, -3e38] * 120}
    for label, values in odd.items():
        Seed(label, {"odd.nrrd": floats(values)}).write(policy.folder)
        outcome = policy.expect(label, ["info", "odd.nrrd"], [0, BAD_INPUT], ["odd.nrrd"])
        for kind, word in (("NaN", "NaN voxel"), ("infini", "infinite voxel")):
            if outcome.code == 0 and (kind in label) != (word in outcome.err):
                policy.fail(label, "voxels that are no numbers are not counted: " + outcome.err)
        for command, output in ((["convert", "odd.nrrd", "out.nii"], "out.nii"),
                                (["convert", "odd.nrrd", "out.vdb"], "out.vdb"),
                                (["render", "odd.nrrd", "--size", "16,16", "-o", "out.png"], "out.png"),
                                (["slice", "odd.nrrd", "-o", "out.png"], "out.png"),
                                ([DEFORM[0], "odd.nrrd", *DEFORM[2:]], "out.vdb")):
            policy.expect("%s, %s" % (label, command[0]), [*command, "--quiet"], [0, BAD_INPUT],
                          ["odd.nrrd", "grab"], [output])
            if os.path.exists(policy.path(output)):
                os.remove(policy.path(output))
    for label, value in (("NaN", NAN), ("infinity", INF), ("huge", 3e38)):
        vectors = seeds.VECTORS[:400] + struct.pack("<f", value) + seeds.VECTORS[404:]
        Seed(label, {"odd.nrrd": seeds.warp_nrrd().replace(seeds.VECTORS, vectors)}).write(
            policy.folder)
        for command in (["invert", "odd.nrrd", "-o", "out.nrrd"], RENDER + ["--offsets", "odd.nrrd"],
                        ["apply", "odd.nrrd", "--points", "p.csv", "-o", "out.csv"]):
            codes = [0, BAD_INPUT] if label == "huge" else [BAD_INPUT]
            policy.expect("warp of %s, %s" % (label, command[0]), [*command, "--quiet"], codes,
                          ["odd.nrrd"], [command[command.index("-o") + 1]])
            if os.path.exists(policy.path(command[command.index("-o") + 1])):
                os.remove(policy.path(command[command.index("-o") + 1]))
    os.remove(policy.path("odd.nrrd"))


def main():
    policy = Policy()
    Seed("inputs", {"a.nrrd": seeds.nrrd("raw", seeds.VALUES), "soft.toml": MATERIAL.encode(),
                    "warp.nrrd": seeds.warp_nrrd(), "p.csv": b"x,y,z\n4,5,6\n"}).write(policy.folder)
    in_every_place(policy)
    odd_values(policy)
    policy.finish()


main()
