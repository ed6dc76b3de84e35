"""Everything that writes, where it cannot: output exists, device, full disk, kill, Ctrl-C.

The old file stays, bit by bit, until a complete new one replaces it. A killed program leaves at
most its temporary file, `.supple-PID-NAME`, and the lock of its folder, `.supple.lock`.
"""
import os
import random
import re
import signal
import struct
import subprocess
import time

from program import BAD_INPUT, SYSTEM, USAGE, Policy, binary, contents
import seeds

DIMS = (64, 48, 32)
OLD = b"the old file\n"
FREE_BYTES = 4096  # on the full disk
KILLS = 8
TEMPORARY = re.compile(r"^\.supple-\d+-")
LEFT = re.compile(r"^\.supple(-\d+-.*|-spool-.{6}|\.lock)$")
FORMATS = ["nrrd", "nhdr", "mha", "mhd", "nii", "nii.gz", "tif", "vdb", "vti", "h5"]
WARPS = ["nrrd", "nhdr", "mha", "mhd", "nii", "nii.gz", "vti", "vtu", "vtk", "h5"]
MATERIAL = ("domain = [0, 1000]\nactive = [200, 1000]\nmax_length = [[0, 1.3]]\n"
            "min_length = [[0, 0.7]]\nshear = [[0, 0.3]]\n")


def make_inputs(policy):
    dice = random.Random(5)
    count = DIMS[0] * DIMS[1] * DIMS[2]
    noise = struct.pack("<%dh" % count, *(dice.randrange(200, 1000) for _ in range(count)))
    header = seeds.nrrd("raw", noise).replace(b"8 6 5", b"%d %d %d" % DIMS)
    places = [(20.5 + n % 20, 20.25 + n // 20, 20.125) for n in range(400)]
    points = "x,y,z\n" + "".join("%g,%g,%g\n" % place for place in places)
    mesh = ("ply\nformat ascii 1.0\nelement vertex 400\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
            "end_header\n" + points[6:].replace(",", " ") + "3 0 1 20\n")
    for name, data in (("volume.nrrd", header), ("soft.toml", MATERIAL.encode()),
                       ("points.csv", points.encode()), ("mesh.ply", mesh.encode())):
        with open(policy.path(name), "wb") as file:
            file.write(data)
    for arguments, output in ((DEFORM, "state.vdb"), (["export", "state.vdb", "-o"], "warp.nrrd")):
        policy.expect("inputs", [*arguments, output, "--quiet"], [0], outputs=[output])


DEFORM = ["deform", "volume.nrrd", "--material", "soft.toml", "--grab", "30,20,16", "--by", "3,2,1",
          "-o"]


def writers():
    """(command up to the output, name of the output)"""
    for extension in FORMATS:
        yield ["convert", "volume.nrrd"], "out." + extension
        yield ["resample", "state.vdb", "-o"], "out." + extension
    for extension in WARPS:
        yield ["export", "state.vdb", "-o"], "out." + extension
    yield ["invert", "warp.nrrd", "-o"], "out.nrrd"
    yield ["metrics", "state.vdb", "--jacobian"], "out.nrrd"
    yield ["metrics", "state.vdb", "--displacement"], "out.nii"
    yield ["metrics", "state.vdb", "--folds"], "out.mha"
    yield ["apply", "state.vdb", "--points", "points.csv", "-o"], "out.csv"
    yield ["apply", "state.vdb", "--mesh", "mesh.ply", "-o"], "out.ply"
    yield ["apply", "state.vdb", "--labels", "volume.nrrd", "-o"], "out.nrrd"
    yield DEFORM, "out.vdb"
    yield ["render", "volume.nrrd", "--size", "300,300", "--quality", "draft", "--preset",
           "Bone", "-o"], "out.png"
    yield ["render", "volume.nrrd", "--size", "300,300", "--quality", "draft", "--preset",
           "Bone", "-o"], "out.exr"
    yield ["slice", "volume.nrrd", "-o"], "out.png"


def files_of(output):
    """A detached header has its values beside it."""
    stem, extension = os.path.splitext(output)
    return [output, stem + ".raw"] if extension in (".nhdr", ".mhd") else [output]


def put_old(folder, output):
    for name in files_of(output):
        with open(os.path.join(folder, name), "wb") as file:
            file.write(OLD)


def remove(folder, output):
    for name in files_of(output):
        if os.path.lexists(os.path.join(folder, name)):
            os.remove(os.path.join(folder, name))


def refuse_places(policy, command, output):
    """An existing file without --force, a device, a folder that is not there."""
    label = "%s to %s" % (command[0], output)
    put_old(policy.folder, output)
    policy.expect(label + " that exists", [*command, output, "--quiet"], [USAGE], files_of(output))
    remove(policy.folder, output)
    os.symlink("/dev/full", policy.path(output))
    policy.expect(label + ", a device", [*command, output, "--quiet", "--force"], [BAD_INPUT],
                  files_of(output))
    remove(policy.folder, output)


def fill(disk):
    with open(os.path.join(disk, "filler"), "wb", buffering=0) as file:
        try:
            while True:
                file.write(bytes(1024))
        except OSError:
            file.truncate(file.tell() - FREE_BYTES)


def full_disk(policy, command, output, disk, **child_limits):
    label = "%s to %s on a full disk" % (command[0], output)
    put_old(os.path.join(policy.folder, disk), output)
    if not child_limits:
        fill(os.path.join(policy.folder, disk))
    policy.expect(label, [*command, os.path.join(disk, output), "--quiet", "--force"], [SYSTEM],
                  files_of(output), **child_limits)
    remove(os.path.join(policy.folder, disk), output)


def interrupted(policy, command, output, dice, number, whole, window):
    """Sends the signal once the temporary file is there and up to `window` seconds later."""
    put_old(policy.folder, output)
    before = contents(policy.folder)
    child = subprocess.Popen([binary(), *command, output, "--quiet", "--force"], cwd=policy.folder,
                             stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                             stderr=subprocess.PIPE, text=True)
    while child.poll() is None and not any(map(TEMPORARY.match, os.listdir(policy.folder))):
        time.sleep(0.0005)
    time.sleep(dice.random() * window)
    child.send_signal(number)
    err = child.communicate(timeout=60)[1]
    policy.runs += 1
    label = "%s to %s, %s" % (command[0], output, number.name)
    after = contents(policy.folder)
    left = [name for name in set(after) - set(before) if LEFT.match(name)]
    for name in sorted(set(before) | set(after)):
        if name in left and number == signal.SIGKILL:
            os.remove(policy.path(name))
        elif after.get(name) != before.get(name) and after.get(name) != whole.get(name):
            policy.fail(label, "%s is neither the old file nor the new one" % name)
    if child.returncode not in (0, -number):
        policy.fail(label, "exit code %d: %s" % (child.returncode, err.strip()))
    if number == signal.SIGINT and child.returncode and err.count("\n") != 1:
        policy.fail(label, "expected one line: " + err)
    remove(policy.folder, output)
    return child.returncode == -number


def stop_writers(policy):
    dice, hits = random.Random(11), 0
    for command, output in writers():
        if command[0] in ("resample", "metrics", "slice"):
            continue  # the same writers as convert and render
        start = time.monotonic()
        policy.expect("whole", [*command, output, "--quiet"], [0], outputs=files_of(output))
        window = 0.1 * (time.monotonic() - start)
        whole = contents(policy.folder)
        remove(policy.folder, output)
        kills = KILLS if command[0] in ("convert", "deform") else 3
        for number in [signal.SIGKILL] * kills + [signal.SIGINT] * 2:
            hits += interrupted(policy, command, output, dice, number, whole, window)
    print("%d of the signals ended the program" % hits)
    if hits == 0:
        policy.fail("signals", "none came in time")


def full_disks(policy):
    os.mkdir(policy.path("disk"))
    for command, output in writers():
        full_disk(policy, command, output, "disk", file_size=FREE_BYTES)
    mounted = os.geteuid() == 0 and subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", policy.path("disk")],
        capture_output=True).returncode == 0
    if not mounted:
        print("no right to mount a small disk: a limit of file sizes stands in for it alone")
        return
    try:
        for command, output in writers():
            full_disk(policy, command, output, "disk")
    finally:
        subprocess.run(["umount", policy.path("disk")], check=True)


def main():
    policy = Policy()
    make_inputs(policy)
    for command, output in writers():
        refuse_places(policy, command, output)
    with open("/dev/full", "w") as full:
        policy.expect("info to a full stdout", ["info", "volume.nrrd", "--json"], [SYSTEM],
                      ["standard output"], stdout=full)
    full_disks(policy)
    stop_writers(policy)
    policy.finish()


main()
