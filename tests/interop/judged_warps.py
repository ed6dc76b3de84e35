"""metrics and compare of warps against numpy: lengths, det F by numpy.gradient, bending energy by sums of slices,
endpoint errors."""
import json
import os
import sys
import tempfile

from common import np, run_supple

DIMS = (28, 24, 20)  # i, j, k
SPACING = np.array([1.5, 2.0, 2.5])
TOLERANCE = 1e-6


def write_warp(path, vectors):
    """Of an array by k, j, i and component."""
    head = ("NRRD0004\ntype: float\ndimension: 4\nspace: left-posterior-superior\nsizes: 3 %d %d %d\n"
            "space directions: none (%g,0,0) (0,%g,0) (0,0,%g)\nkinds: vector domain domain domain\n"
            "endian: little\nencoding: raw\nspace origin: (0,0,0)\n\n" % (*DIMS, *SPACING))
    with open(path, "wb") as file:
        file.write(head.encode() + vectors.astype("<f4").tobytes())


def warps():
    """Two smooth ones, as 32-bit floats hold them."""
    k, j, i = np.meshgrid(*(np.arange(n) for n in DIMS[::-1]), indexing="ij")
    x, y, z = i * SPACING[0], j * SPACING[1], k * SPACING[2]
    a = np.stack([2 * np.sin(y / 9) + 0.01 * x * y, 1.5 * np.cos(z / 8) * np.sin(x / 11),
                  0.5 * np.sin(x / 7) * np.cos(y / 6)], -1)
    b = a + np.stack([0.3 * np.cos(x / 5), 0.2 * np.sin(z / 4), 0.1 + 0 * x], -1)
    return a.astype("<f4").astype(float), b.astype("<f4").astype(float)


def bending_energy(u):
    """The mean over voxels inside of the sum of squared second derivatives, by central differences."""
    step = np.eye(3, dtype=int)

    def at(shift):
        return u[tuple(slice(1 + s, n - 1 + s) for s, n in zip(shift, u.shape))]

    density = 0
    for a in range(3):  # k, j, i
        for b in range(3):
            if a == b:
                second = at(step[a]) - 2 * at((0, 0, 0)) + at(-step[a])
            else:
                second = (at(step[a] + step[b]) - at(step[a] - step[b]) - at(step[b] - step[a])
                          + at(-step[a] - step[b])) / 4
            density = density + ((second / (SPACING[2 - a] * SPACING[2 - b])) ** 2).sum(-1)
    return density.mean()


def json_of(*arguments):
    done = run_supple("--json", "--quiet", *arguments)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


def main():
    a, b = warps()
    with tempfile.TemporaryDirectory() as folder:
        paths = [os.path.join(folder, name) for name in ("a.nrrd", "b.nrrd")]
        for path, vectors in zip(paths, (a, b)):
            write_warp(path, vectors)
        ours = json_of("metrics", paths[0])
        ours.update({"error_" + key: value
                     for key, value in json_of("compare", *paths)["endpoint_error"].items()})
    gradient = np.stack(np.gradient(a, *SPACING[::-1], axis=(0, 1, 2)), -1)[..., ::-1]
    jacobian = np.linalg.det(np.eye(3) + gradient)
    length, error = np.linalg.norm(a, axis=-1), np.linalg.norm(a - b, axis=-1)
    theirs = {"mean_mm": length.mean(), "max_mm": length.max(), "median_mm": np.sort(length.ravel())[length.size // 2 - 1],
              "min_jacobian": jacobian.min(), "max_jacobian": jacobian.max(),
              "sd_log_jacobian": np.log(jacobian).std(), "bending_per_mm2": bending_energy(a),
              "error_mean_mm": error.mean(), "error_rms_mm": np.sqrt((error ** 2).mean()),
              "error_max_mm": error.max()}
    wrong = [name for name, value in theirs.items() if not abs(ours[name] / value - 1) < TOLERANCE]
    for name in wrong:
        print(f"{name}: supple {ours[name]}, numpy {theirs[name]}")
    print(f"{len(theirs)} numbers, {len(wrong)} disagreements")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
