"""`ulimit -v`: under every limit that lets the program start it is done, or says that memory is short.

What a limit allows, larger ones allow, too."""
import os
import random
import sys

from program import SKIPPED, SYSTEM, Policy, is_sanitized, run
import seeds
from seeds import Seed

MEGABYTE = 1 << 20
# MB of addresses; 284 is a little more than the heap asks for ahead of its use without a limit.
ABOVE_START = [0, 16, 40, 56, 80, 112, 192, 284, 1024]
DIMS = (160, 160, 120)
MATERIAL = ("domain = [0, 255]\nactive = [100, 255]\nmax_length = [[0, 1.3]]\n"
            "min_length = [[0, 0.7]]\nshear = [[0, 0.3]]\n")


def least_limit():
    """MB under which the libraries are just mapped, to 4 MB."""
    low, high = 16, 8192
    while high - low > 4:
        middle = (low + high) // 2
        if run(["--version"], address_space=middle * MEGABYTE).code == 0:
            high = middle
        else:
            low = middle
    return high


def commands():
    yield ["info", "volume.nrrd"], []
    yield ["info", "state.vdb"], []
    for extension in ("nrrd", "nii.gz", "tif", "h5", "vdb"):
        yield ["convert", "volume.nrrd", "out." + extension], ["out." + extension]
    yield ["deform", "volume.nrrd", "--material", "soft.toml", "--grab", "80,80,60", "--by", "5,4,3",
           "-o", "out.vdb"], ["out.vdb"]
    yield ["render", "volume.nrrd", "--size", "64,64", "--quality", "draft", "-o", "out.png"], [
        "out.png"]
    yield ["slice", "volume.nrrd", "-o", "out.png"], ["out.png"]
    yield ["resample", "state.vdb", "-o", "out.nrrd"], ["out.nrrd"]
    yield ["export", "state.vdb", "-o", "out.nii"], ["out.nii"]


def main():
    if is_sanitized():
        print("skipped: sanitizers reserve more addresses than any limit")
        sys.exit(SKIPPED)
    policy = Policy()
    noise = random.Random(3).randbytes(DIMS[0] * DIMS[1] * DIMS[2])
    header = seeds.nrrd("raw", noise).replace(b"8 6 5", b"%d %d %d" % DIMS)
    Seed("volume", {"volume.nrrd": header.replace(b"short", b"uint8"),
                    "soft.toml": MATERIAL.encode()}).write(policy.folder)
    policy.expect("state", ["deform", "volume.nrrd", "--material", "soft.toml", "--grab", "80,80,60",
                            "--by", "2,1,1", "--quiet", "-o", "state.vdb"], [0],
                  outputs=["state.vdb"], max_peak_mb=2000)
    start = least_limit()
    codes, planned = [], 0
    for command, outputs in commands():
        done_under = None
        for above in ABOVE_START:
            outcome = policy.expect("%s under %d MB" % (command[0], start + above),
                                    [*command, "--quiet"], [0, SYSTEM], ["memory"], outputs,
                                    address_space=(start + above) * MEGABYTE, max_peak_mb=2000)
            codes.append(outcome.code)
            planned += "the run needs" in outcome.err
            if outcome.code == 0:
                done_under = done_under or start + above
            elif done_under and outcome.code == SYSTEM:
                policy.fail(command[0], "done under %d MB, refused under %d MB"
                            % (done_under, start + above))
            for output in outputs:
                if os.path.exists(policy.path(output)):
                    os.remove(policy.path(output))
    print("starts under %d MB; %d done, %d refused" % (start, codes.count(0), codes.count(SYSTEM)))
    if SYSTEM not in codes or 0 not in codes:
        policy.fail("limits", "they refuse all or none")
    if planned == 0:
        policy.fail("plans", "no run was refused by what it will need")
    policy.finish()


main()
