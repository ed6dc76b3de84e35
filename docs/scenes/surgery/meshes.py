"""Makes the mesh of a scene beside it from the head CT: plain Python, some seconds.

    python3 docs/scenes/surgery/meshes.py build/data/ct_head.raw

`dura.obj` is a sheet half a millimetre below the inner table of the skull, where a dissector frees a flap of bone, in LPS
millimetres. It follows the skull of this patient, so that no analytic part stands for it.
"""

import array
import math
import pathlib
import sys

DIMS = (256, 256, 108)
SPACING = (0.957031, 0.957031, 1.5)
ORIGIN = (-122.0214525, 122.0214525, -80.25)
FLAP_CENTRE = (194.6, 125.7, 75.5)  # voxel at the outer table, and the patient's outward normal there, LPS
FLAP_NORMAL = (0.93432, -0.10833, 0.33957)


def add(a, b, factor=1.0):
    return tuple(x + factor * y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return tuple(x / math.sqrt(dot(a, a)) for x in a)


def lps(voxel):
    return (ORIGIN[0] + SPACING[0] * voxel[0], ORIGIN[1] - SPACING[1] * voxel[1], ORIGIN[2] + SPACING[2] * voxel[2])


def voxel(place):
    return ((place[0] - ORIGIN[0]) / SPACING[0], (ORIGIN[1] - place[1]) / SPACING[1], (place[2] - ORIGIN[2]) / SPACING[2])


def flap_frame():
    """The centre of the flap, its directions forward and upwards along the skull, and outwards."""
    out = unit(FLAP_NORMAL)
    forward = unit(add((0.0, -1.0, 0.0), out, -dot((0.0, -1.0, 0.0), out)))
    return lps(FLAP_CENTRE), forward, unit(cross(forward, out)), out


class Scan:
    def __init__(self, path):
        self.values = array.array("h")
        self.values.frombytes(pathlib.Path(path).read_bytes())

    def at(self, place):
        """The density at a place, linear between voxels."""
        at = voxel(place)
        low = [min(max(int(math.floor(x)), 0), n - 2) for x, n in zip(at, DIMS)]
        part = [x - l for x, l in zip(at, low)]
        total = 0.0
        for corner in range(8):
            step = (corner & 1, corner >> 1 & 1, corner >> 2)
            weight = math.prod(p if s else 1 - p for p, s in zip(part, step))
            i, j, k = (l + s for l, s in zip(low, step))
            total += weight * self.values[i + DIMS[0] * (j + DIMS[1] * k)]
        return total

    def bone_along(self, start, direction, ways):
        """The first and the last of some ways along a direction at which there is bone."""
        bone = [way for way in ways if self.at(add(start, direction, way)) > 250]
        return (bone[0], bone[-1]) if bone else None


def dura(scan, half_length=36, half_height=33, step=3):
    """The sheet below the inner table, as vertices and triangles; holes in it are closed by its mean over neighbours."""
    centre, forward, upwards, out = flap_frame()
    rows = [[n * step for n in range(-half_height // step, half_height // step + 1)],
            [n * step for n in range(-half_length // step, half_length // step + 1)]]
    depths = []
    for v in rows[0]:
        for u in rows[1]:
            foot = add(add(centre, forward, u), upwards, v)
            bone = scan.bone_along(foot, out, [n / 4 for n in range(-110, 40)])
            depths.append(bone[0] - 0.5 if bone else -9.0)
    depths = smoothed(depths, len(rows[1]), len(rows[0]))
    vertices = [add(add(add(centre, forward, u), upwards, v), out, depths[n])
                for n, (v, u) in enumerate((v, u) for v in rows[0] for u in rows[1])]
    return vertices, grid_triangles(len(rows[1]), len(rows[0]))


def smoothed(depths, columns, rows):
    """Depths whose single peaks are gone: the median of each and its neighbours."""
    result = []
    for n in range(columns * rows):
        row, column = divmod(n, columns)
        near = sorted(depths[r * columns + c] for r in range(max(row - 1, 0), min(row + 2, rows))
                      for c in range(max(column - 1, 0), min(column + 2, columns)))
        result.append(near[len(near) // 2])
    return result


def grid_triangles(columns, rows):
    triangles = []
    for row in range(rows - 1):
        for column in range(columns - 1):
            a = row * columns + column
            triangles += [(a, a + 1, a + columns), (a + 1, a + columns + 1, a + columns)]
    return triangles


def write(name, mesh):
    vertices, triangles = mesh
    lines = ["v %.2f %.2f %.2f" % v for v in vertices] + ["f %d %d %d" % tuple(n + 1 for n in t) for t in triangles]
    path = pathlib.Path(__file__).parent / name
    path.write_text("\n".join(lines) + "\n")
    print(f"{path}: {len(vertices)} vertices, {len(triangles)} triangles")


def main():
    scan = Scan(sys.argv[1])
    write("dura.obj", dura(scan))


if __name__ == "__main__":
    main()
