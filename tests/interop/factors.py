"""Which files a matrix holds: the grids, the values, and a choice among all combinations."""
import itertools
import math

import numpy as np

TYPES = ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32",
         "float64"]
ORDERS = {"little": "<", "big": ">"}
DIMS = (5, 4, 3)


def _grid(axes, origin):
    affine = np.eye(4)
    affine[:3, :3] = np.array(axes, float)
    affine[:3, 3] = origin
    return affine


def _turned():
    """A rotation about all three axes."""
    a, b, c = 0.3, -0.2, 0.7
    x = np.array([[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]])
    y = np.array([[math.cos(b), 0, math.sin(b)], [0, 1, 0], [-math.sin(b), 0, math.cos(b)]])
    z = np.array([[math.cos(c), -math.sin(c), 0], [math.sin(c), math.cos(c), 0], [0, 0, 1]])
    return z @ y @ x


_SPACING = np.diag([0.75, 1.25, 2.5])
_PLACE = (-12.5, 30.25, -100.125)

# Affines from index to LPS in mm; columns are the axes.
GRIDS = {
    "unit": np.eye(4),
    "anisotropic": _grid(_SPACING, _PLACE),
    "flipped": _grid(np.diag([-1, -1, 1]) @ _SPACING, _PLACE),
    "mirrored": _grid(np.diag([1, -1, 1]) @ _SPACING, _PLACE),
    "sagittal": _grid(np.array([[0, 0, 1], [1, 0, 0], [0, -1, 0]]) @ _SPACING, _PLACE),
    "oblique": _grid(_turned() @ _SPACING, _PLACE),
    "oblique_mirrored": _grid(_turned() @ np.diag([1, 1, -1]) @ _SPACING, _PLACE),
    "sheared": _grid(_turned() @ np.array([[1, .2, 0], [0, 1, -.3], [0, 0, 1]]) @ _SPACING, _PLACE),
}
ALIGNED = ["unit", "anisotropic"]  # for formats that know spacings only


def values_of(kind, shape, seed):
    """Values that use every byte of the type, with its extremes; floats stay finite as float32."""
    generator = np.random.default_rng(seed)
    if kind.startswith("float"):
        return (generator.normal(size=shape) * 10.0 ** generator.integers(-3, 4, shape)).astype(kind)
    limits = np.iinfo(kind)
    values = generator.integers(limits.min, limits.max, shape, dtype=kind, endpoint=True)
    values.flat[0], values.flat[-1] = limits.min, limits.max
    return values


def choose(factors, full=(), allowed=lambda row: True):
    """Rows (dicts) such that the factors of `full` occur in every allowed combination and any two
    values of different factors occur together where that is allowed. Deterministic and greedy."""
    names = list(factors)
    rows = [row for row in (dict(zip(names, values))
                            for values in itertools.product(*factors.values())) if allowed(row)]
    number = {}  # of a pair, or of a combination of `full`
    pairs = np.array([[number.setdefault(pair, len(number))
                       for pair in itertools.combinations(row.items(), 2)] for row in rows])
    corners = np.array([number.setdefault(tuple(row[name] for name in full), len(number))
                        for row in rows])
    is_open, uses = np.ones(len(number)), np.zeros(len(number))
    if not full:
        is_open[corners] = 0
    chosen = []
    while is_open.any():
        spread = (1 / (1 + uses[pairs])).mean(axis=1)  # decides where no open pair does
        gain = is_open[pairs].sum(axis=1) + pairs.shape[1] * is_open[corners] + spread
        best = int(np.argmax(gain))
        is_open[pairs[best]] = is_open[corners[best]] = 0
        uses[pairs[best]] += 1
        chosen.append(rows[best])
    return chosen
