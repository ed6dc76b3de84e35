"""Every format cut at every tenth of each of its files: read whole, or refused with one line.

The cut copies of a file are read in one start of the program; the copy cut in the middle is also
given to a command that writes, which leaves no output behind. Meshes and points are read by such a
command alone: at every tenth, under sanitizers, whose starts are slow, at the half.
"""
import os
import shutil
import struct

from program import BAD_INPUT, Policy, is_sanitized
import seeds
from seeds import Seed

MATERIAL = ("domain = [-1000, 1000]\nactive = [-300, 1000]\nmax_length = [[0, 1.3]]\n"
            "min_length = [[0, 0.7]]\nshear = [[0, 0.3]]\n")
CORNERS = [(2, 2, 2), (6, 2, 4), (3, 5, 6), (5, 4, 9)]
FACES = [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)]


def cut_points(size, parts):
    """Where the parts of a file end; 0 is an empty file."""
    return sorted({size * part // parts for part in range(parts)})


def meshes():
    """A tetrahedron in every mesh format; text may end early and still be a mesh."""
    triangles = b"".join(struct.pack("<12fH", 0, 0, 0, *CORNERS[a], *CORNERS[b], *CORNERS[c], 0)
                         for a, b, c in FACES)
    points = "".join("%g %g %g\n" % corner for corner in CORNERS)
    faces = "".join("3 %d %d %d\n" % face for face in FACES)
    loops = "".join("facet normal 0 0 0\nouter loop\n" +
                    "".join("vertex %g %g %g\n" % CORNERS[corner] for corner in face) +
                    "endloop\nendfacet\n" for face in FACES)
    obj = ("".join("v %s\n" % line for line in points.splitlines()) +
           "".join("f %d %d %d\n" % tuple(corner + 1 for corner in face) for face in FACES))
    header = ("ply\nformat %s 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
              "property float z\nelement face 4\nproperty list uchar int vertex_indices\n"
              "end_header\n")
    packed = (b"".join(struct.pack("<3f", *corner) for corner in CORNERS) +
              b"".join(struct.pack("<Biii", 3, *face) for face in FACES))
    return [
        Seed("stl binary", {"a.stl": bytes(80) + struct.pack("<I", 4) + triangles}),
        Seed("stl text", {"b.stl": ("solid t\n%sendsolid t\n" % loops).encode()},
             cut_ends=["b.stl"]),
        Seed("ply text", {"c.ply": (header % "ascii" + points + faces).encode()}),
        Seed("ply binary", {"d.ply": (header % "binary_little_endian").encode() + packed}),
        Seed("obj", {"e.obj": obj.encode()}, cut_ends=["e.obj"]),
    ]


def files_to_cut(seed):
    """All slices of a series are alike: the middle one stands for them."""
    files = sorted(seed.files)
    return files[len(files) // 2:][:1] if os.path.dirname(files[0]) else files


def may_be_read(seed, name, end):
    return name in seed.cut_ends or (os.path.dirname(name) and end < 132)


def expect_cut(policy, seed, arguments, output, name, end):
    """arguments: the command with {} for the file."""
    label = "%s, %s cut at %d of %d bytes" % (seed.name, name, end, len(seed.files[name]))
    seed.write(policy.folder, {name: seed.files[name][:end]})
    policy.expect(label, [argument.replace("{}", seed.main) for argument in arguments] +
                  seed.options, [0, BAD_INPUT] if may_be_read(seed, name, end) else [BAD_INPUT],
                  [name, seed.main], [output])
    if os.path.exists(policy.path(output)):
        os.remove(policy.path(output))


def cut_everywhere(policy, seed, arguments, output):
    seed.write(policy.folder)
    expect_whole(policy, seed, arguments, output)
    for name in files_to_cut(seed):
        for end in cut_points(len(seed.files[name]), 2 if is_sanitized() else 10):
            expect_cut(policy, seed, arguments, output, name, end)
    seed.remove(policy.folder)


def expect_whole(policy, seed, arguments, output):
    policy.expect(seed.name + ", whole", [argument.replace("{}", seed.main)
                                          for argument in arguments] + seed.options, [0], [],
                  [output])
    if os.path.exists(policy.path(output)):
        os.remove(policy.path(output))


def read_everywhere(policy, seed):
    """Each cut copy in a folder of its own, beside the seed's other files."""
    for name in files_to_cut(seed):
        data = seed.files[name]
        copies = []
        for end in cut_points(len(data), 10):
            folder = "cut_at_%d" % end
            seed.write(policy.path(folder), {name: data[:end]})
            copies.append(("%s cut at %d of %d bytes" % (name, end, len(data)),
                           os.path.join(folder, seed.main),
                           [0, BAD_INPUT] if may_be_read(seed, name, end) else [BAD_INPUT],
                           [name, seed.main]))
        outcomes = policy.expect_each(seed.name, copies, seed.options)
        # A slice that is none any more is missing, and that is said.
        for (label, path, _, _), (code, is_warned) in zip(copies, outcomes):
            if code == 0 and name not in seed.cut_ends and not is_warned:
                policy.fail(seed.name, label + " passes without a warning")
            shutil.rmtree(policy.path(path.split(os.sep)[0]))


def main():
    policy = Policy()
    for seed in seeds.volumes(policy.folder):
        read_everywhere(policy, seed)
        seed.write(policy.folder)
        expect_whole(policy, seed, ["convert", "{}", "out.mha"], "out.mha")
        for name in files_to_cut(seed):
            expect_cut(policy, seed, ["convert", "{}", "out.mha"], "out.mha", name,
                       len(seed.files[name]) // 2)
        seed.remove(policy.folder)
    soft = Seed("soft", {"soft.toml": MATERIAL.encode(), "ball.nrrd": seeds.nrrd("raw", seeds.VALUES)})
    soft.write(policy.folder)
    deform = ["deform", "ball.nrrd", "--quiet", "--material", "soft.toml", "--by", "0.1,0,0",
              "-o", "out.vdb", "--grab"]
    points = Seed("points", {"points.csv": b"x,y,z\n" + b"".join(
        b"%d.0,%d.0,7.0\n" % (n + 2, n + 3) for n in range(4))}, cut_ends=["points.csv"])
    cut_everywhere(policy, points, deform + ["{}"], "out.vdb")
    for mesh in meshes():
        cut_everywhere(policy, mesh, deform + ["4,3,2", "--cut", "{}"], "out.vdb")
    assert policy.expect("state", deform + ["4,3,2"], [0], outputs=["out.vdb"]).code == 0
    with open(policy.path("out.vdb"), "rb") as file:
        state = Seed("state", {"state.vdb": file.read()})
    os.remove(policy.path("out.vdb"))
    read_everywhere(policy, state)
    policy.finish()


main()
