"""A ball that moved away leaves no ghost when other programs resample with our warp.

Where the ball was, an offset of 0 would show it a second time. The exported field leads there to the
nearest air (`--void nearest`), out of the volume (`outside`), or along with the ball (`extend`):
whoever pulls the source through it must find air, and the ball in its new place.
"""
import os
import subprocess
import sys
import tempfile

import numpy as np

from common import SKIPPED, Tally, program, run_supple
from factors import GRIDS

DIMS = (40, 44, 24)
AIR, BALL = -1000.0, 300.0
CENTRE, RADIUS_MM, STEPS = np.array([13, 12, 11]), 8.0, 18  # voxels moved along j
AFFINE = GRIDS["oblique"]
RIGID = ("domain = [-1000, 1000]\nactive = [0, 1000]\nmax_length = [[0, 1]]\n"
         "min_length = [[0, 1]]\nshear = [[0, 0]]\n")


def ball(centre):
    steps = np.moveaxis(np.indices(DIMS), 0, -1) - centre
    return np.linalg.norm(steps @ AFFINE[:3, :3].T, axis=-1) < RADIUS_MM


def words(values):
    return " ".join(repr(float(v)) for v in np.ravel(values))


def write_volume(path, values):
    spacing = np.linalg.norm(AFFINE[:3, :3], axis=0)
    with open(path, "wb") as file:
        file.write((f"ObjectType = Image\nNDims = 3\nBinaryData = True\n"
                    f"BinaryDataByteOrderMSB = False\n"
                    f"TransformMatrix = {words((AFFINE[:3, :3] / spacing).T)}\n"
                    f"Offset = {words(AFFINE[:3, 3])}\nElementSpacing = {words(spacing)}\n"
                    f"DimSize = {' '.join(map(str, DIMS))}\nElementType = MET_FLOAT\n"
                    f"ElementDataFile = LOCAL\n").encode())
        file.write(values.astype("<f4").tobytes(order="F"))


def read_values(path, components=1):
    with open(path, "rb") as file:
        data = file.read()
    count = int(np.prod(DIMS)) * components
    return np.frombuffer(data[-4 * count:], "<f4").reshape(components, *DIMS, order="F")


def transformix(folder, warp):
    spacing = np.linalg.norm(AFFINE[:3, :3], axis=0)
    with open(os.path.join(folder, "transform.txt"), "w", encoding="ascii") as file:
        file.write(f'(Transform "DeformationFieldTransform")\n(NumberOfParameters 0)\n'
                   f'(DeformationFieldFileName "{warp}")\n'
                   f'(DeformationFieldInterpolationOrder 1)\n'
                   f'(InitialTransformParametersFileName "NoInitialTransform")\n'
                   f'(HowToCombineTransforms "Compose")\n'
                   f'(FixedImageDimension 3)\n(MovingImageDimension 3)\n'
                   f'(FixedInternalImagePixelType "float")\n(MovingInternalImagePixelType "float")\n'
                   f'(Size {" ".join(map(str, DIMS))})\n(Index 0 0 0)\n(Spacing {words(spacing)})\n'
                   f'(Origin {words(AFFINE[:3, 3])})\n'
                   f'(Direction {words((AFFINE[:3, :3] / spacing).T)})\n'
                   f'(UseDirectionCosines "true")\n(Resampler "DefaultResampler")\n'
                   f'(ResampleInterpolator "FinalBSplineInterpolator")\n'
                   f'(FinalBSplineInterpolationOrder 1)\n(DefaultPixelValue {AIR})\n'
                   f'(ResultImageFormat "mha")\n(ResultImagePixelType "float")\n'
                   f'(CompressResultImage "false")\n')
    return ["transformix", "-in", "source.mha", "-tp", "transform.txt", "-out", "."]


def plastimatch(_, warp):
    return ["plastimatch", "convert", "--input", "source.mha", "--fixed", "source.mha", "--xf", warp,
            "--interpolation", "linear", "--default-value", str(AIR), "--output-type", "float",
            "--output-img", "result.mha"]


def resampled(judge, folder, warp):
    result = os.path.join(folder, "result.mha")
    if os.path.exists(result):
        os.remove(result)
    subprocess.run(judge(folder, warp), cwd=folder, check=True, capture_output=True, timeout=120)
    return read_values(result)[0]


def without_the_void(folder, warp):
    """The same warp, but nothing known where the ball was: vectors of 0."""
    path = os.path.join(folder, warp)
    with open(path, "rb") as file:
        data = bytearray(file.read())
    vectors = read_values(path, 3).copy()
    vectors[:, ball(CENTRE)] = 0
    data[-vectors.nbytes:] = vectors.tobytes(order="F")
    with open(os.path.join(folder, "ghost.mha"), "wb") as file:
        file.write(data)
    return "ghost.mha"


def check(tally, judge, folder, warp, mode):
    moved = CENTRE + [0, STEPS, 0]
    source, target = ball(CENTRE), ball(moved)
    values = resampled(judge, folder, warp)
    tally.files += 1
    name = f"{judge.__name__} --void {mode}"
    ghosts = int((values[source] > AIR + 1).sum())
    if ghosts:
        tally.report(name, "voxels of a ghost", ghosts, 0)
    arrived = int((values[target] > BALL - 1).sum())
    if arrived != target.sum():
        tally.report(name, "voxels of the ball", arrived, int(target.sum()))
    if mode == "nearest":
        ghosts = int((resampled(judge, folder, without_the_void(folder, warp))[source] > 0).sum())
        if ghosts != source.sum():
            tally.report(name, "voxels of a ghost with vectors of 0", ghosts, int(source.sum()))


def main():
    judges = [judge for judge in (transformix, plastimatch) if program(judge.__name__)]
    if not judges:
        print("skipped: neither elastix nor plastimatch is installed")
        sys.exit(SKIPPED)
    tally = Tally()
    with tempfile.TemporaryDirectory(prefix="supple_vacated_") as folder:
        write_volume(os.path.join(folder, "source.mha"), np.where(ball(CENTRE), BALL, AIR))
        with open(os.path.join(folder, "rigid.toml"), "w", encoding="ascii") as file:
            file.write(RIGID)

        def run(*arguments):
            done = run_supple("--quiet", "--force", *arguments)
            if done.returncode != 0:
                sys.exit(done.stderr)

        source, material, state, warp = (os.path.join(folder, name) for name in (
            "source.mha", "rigid.toml", "moved.vdb", "warp.mha"))
        by = f"0,{STEPS * float(np.linalg.norm(AFFINE[:3, 1]))!r},0"
        run("deform", source, "--material", material, "--grab", ",".join(map(str, CENTRE)), "--by", by,
            "-o", state)
        for mode in ("nearest", "outside", "extend"):
            run("export", state, "--void", mode, "-o", warp)
            for judge in judges:
                check(tally, judge, folder, "warp.mha", mode)
    tally.finish("resampled volumes")


if __name__ == "__main__":
    main()
