"""GIPL files written by ITK (plastimatch), and by hand with every type, magic number and time."""
import os
import struct
import subprocess

import numpy as np

from common import Case, program, reading
from factors import ALIGNED, DIMS, GRIDS, choose, values_of

GIPL_TYPES = {"int8": 7, "uint8": 8, "int16": 15, "uint16": 16, "uint32": 31, "int32": 32,
              "float32": 64, "float64": 65}
ITK_TYPES = {"uint8": "MET_UCHAR", "int16": "MET_SHORT", "float32": "MET_FLOAT"}
FACTORS = {"type": list(GIPL_TYPES), "writer": ["hand", "itk"], "magic": [719555000, 4026526128],
           "frames": [0, 1, 3], "grid": ALIGNED}


def missing():
    return None if program("plastimatch") else "plastimatch"


def allowed(row):
    if row["writer"] == "itk":
        return row["type"] in ITK_TYPES and row["magic"] == 4026526128 and row["frames"] == 1
    return True


def write_by_hand(path, row, affine, values):
    head = struct.pack(">4HH4f", *DIMS, row["frames"], GIPL_TYPES[row["type"]],
                       *np.diag(affine)[:3], 1).ljust(204, b"\0")
    head += struct.pack(">4d4fI", *affine[:3, 3], 0, 0, 0, 0, 0, row["magic"])
    with open(path, "wb") as file:
        file.write(head)
        for frame in range(max(1, row["frames"])):
            stored = values if frame == 0 else np.zeros_like(values)
            file.write(stored.astype(values.dtype.newbyteorder(">")).tobytes(order="F"))


def write_by_itk(path, row, affine, values):
    source = path + ".mha"
    numbers = [" ".join(repr(float(x)) for x in n) for n in (np.diag(affine)[:3], affine[:3, 3])]
    with open(source, "wb") as file:
        file.write(("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = "
                    f"False\nElementSpacing = {numbers[0]}\nOffset = {numbers[1]}\nDimSize = "
                    f"{' '.join(map(str, DIMS))}\nElementType = {ITK_TYPES[row['type']]}\n"
                    "ElementDataFile = LOCAL\n").encode() + values.tobytes(order="F"))
    subprocess.run(["plastimatch", "convert", "--input", source, "--output-img", path],
                   check=True, capture_output=True)
    os.remove(source)


def cases(folder):
    for n, row in enumerate(choose(FACTORS, ("type", "writer"), allowed)):
        values, affine = values_of(row["type"], DIMS, n), GRIDS[row["grid"]]
        path = os.path.join(folder, f"g{n:03d}.gipl")
        write = write_by_itk if row["writer"] == "itk" else write_by_hand
        write(path, row, affine, values)
        options = ["--frame", "0"] if row["frames"] > 1 else []
        yield Case(path, [(row["writer"], lambda v=values, a=affine: reading(v, a))], options,
                   tolerance=1e-6)  # spacing has 32 bits
