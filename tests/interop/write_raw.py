"""Headerless files written by numpy and described on the command line."""
import os

from common import Case, reading
from factors import ALIGNED, DIMS, GRIDS, ORDERS, TYPES, choose, values_of

FACTORS = {"type": TYPES, "order": ["little", "big"], "offset": ["0", "62"], "grid": ALIGNED}


def missing():
    return None


def cases(folder):
    for n, row in enumerate(choose(FACTORS, ("type", "order"))):
        values = values_of(row["type"], DIMS, n)
        affine = GRIDS[row["grid"]].copy()
        affine[:3, 3] = 0
        path = os.path.join(folder, f"r{n:03d}.raw")
        with open(path, "wb") as file:
            file.write(bytes(int(row["offset"])))
            stored = values.astype(values.dtype.newbyteorder(ORDERS[row["order"]]))
            stored.ravel(order="F").tofile(file)
        spacing = ",".join(repr(float(affine[a, a])) for a in range(3))
        described = (f"dims={','.join(map(str, DIMS))},type={row['type']},spacing={spacing},"
                     f"endian={row['order']},offset={row['offset']}")
        yield Case(path, [("numpy", lambda v=values, a=affine: reading(v, a))],
                   ["--raw", described])
