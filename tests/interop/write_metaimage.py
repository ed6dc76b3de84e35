"""MetaImage files: headers and values written by hand or by VTK, read by plastimatch (ITK) and VTK."""
import os
import subprocess
import zlib

import numpy as np

from common import Case, has_module, program, reading
from factors import DIMS, GRIDS, ORDERS, TYPES, choose, values_of
from write_nrrd import read_by_teem

FACTORS = {
    "type": TYPES,
    "encoding": ["raw", "zlib", "ascii"],
    "order": ["little", "big"],
    "files": ["mha", "mhd", "list", "numbered"],
    "writer": ["hand", "vtk"],
    "grid": list(GRIDS),
    "axes": ["scalar", "time", "vector"],
}
META_TYPES = {"int8": "MET_CHAR", "uint8": "MET_UCHAR", "int16": "MET_SHORT",
              "uint16": "MET_USHORT", "int32": "MET_INT", "uint32": "MET_UINT",
              "int64": "MET_LONG_LONG", "uint64": "MET_ULONG_LONG", "float32": "MET_FLOAT",
              "float64": "MET_DOUBLE"}
PLASTIMATCH_TYPES = ["uint8", "int16", "uint16", "int32", "uint32", "float32"]


def missing():
    if not has_module("vtkmodules.vtkIOImage"):
        return "python3-vtk9"
    if not program("teem-unu", "unu"):
        return "teem-apps"
    return None if program("plastimatch") else "plastimatch"


def allowed(row):
    if row["writer"] == "vtk":
        return row["order"] == "little" and row["files"] in ("mha", "mhd") and \
            row["encoding"] != "ascii" and row["grid"] in ("unit", "anisotropic") and \
            row["axes"] == "scalar" and row["type"] not in ("int64", "uint64")
    # A compressed stream lies in one file.
    return row["encoding"] != "zlib" or row["files"] in ("mha", "mhd")


def encode(values, row):
    plain = values.astype(values.dtype.newbyteorder(ORDERS[row["order"]])).tobytes(order="F")
    if row["encoding"] == "ascii":
        return " ".join(str(v) for v in values.ravel(order="F").tolist()).encode() + b"\n"
    return zlib.compress(plain) if row["encoding"] == "zlib" else plain


def write_by_hand(stem, row, affine, values):
    sizes = values.shape[1:] if row["axes"] == "vector" else values.shape
    count = len(sizes)
    spacing, axes = np.ones(count), np.eye(count)
    origin = np.zeros(count)
    spacing[:3] = np.linalg.norm(affine[:3, :3], axis=0)
    axes[:3, :3] = affine[:3, :3] / spacing[:3]
    origin[:3] = affine[:3, 3]

    def text(numbers):
        return " ".join(repr(float(x)) for x in numbers)

    head = ["ObjectType = Image", f"NDims = {count}",
            f"BinaryData = {row['encoding'] != 'ascii'}",
            f"BinaryDataByteOrderMSB = {row['order'] == 'big'}"]
    body = encode(values, row)
    if row["encoding"] == "zlib":
        head += ["CompressedData = True", f"CompressedDataSize = {len(body)}"]
    # The first numbers are the axis i: MetaIO's matrix holds the axes as rows.
    head += [f"TransformMatrix = {text(axes.T.ravel())}", f"Offset = {text(origin)}",
             f"ElementSpacing = {text(spacing)}", f"DimSize = {' '.join(map(str, sizes))}"]
    if row["axes"] == "vector":
        head.append(f"ElementNumberOfChannels = {values.shape[0]}")
    head.append(f"ElementType = {META_TYPES[row['type']]}")
    if row["files"] == "mha":
        with open(stem + ".mha", "wb") as file:
            file.write(("\n".join([*head, "ElementDataFile = LOCAL"]) + "\n").encode() + body)
        return stem + ".mha"
    base, bodies = os.path.basename(stem), [body]
    if row["files"] != "mhd":
        bodies = [encode(values[..., n], row) for n in range(values.shape[-1])]
    names = [f"{base}_{n:03d}.raw" for n in range(len(bodies))]
    for name, part in zip(names, bodies):
        with open(os.path.join(os.path.dirname(stem), name), "wb") as file:
            file.write(part)
    head.append("ElementDataFile = " + {
        "mhd": names[0], "list": "\n".join(["LIST", *names]),
        "numbered": f"{base}_%03d.raw 0 {len(names) - 1} 1"}[row["files"]])
    with open(stem + ".mhd", "w", encoding="ascii") as file:
        file.write("\n".join(head) + "\n")
    return stem + ".mhd"


def write_by_vtk(stem, row, affine, values):
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOImage import vtkMetaImageWriter

    image = vtkImageData()
    image.SetDimensions(values.shape)
    image.SetSpacing(np.diag(affine)[:3])
    image.SetOrigin(affine[:3, 3])
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(order="F"), deep=True))
    writer = vtkMetaImageWriter()
    path = f"{stem}.{row['files']}"
    writer.SetFileName(path)
    if row["files"] == "mhd":
        writer.SetRAWFileName(f"{stem}.{'zraw' if row['encoding'] == 'zlib' else 'raw'}")
    writer.SetCompression(row["encoding"] == "zlib")
    writer.SetInputData(image)
    writer.Write()
    return path


def read_by_plastimatch(path):
    """ITK's geometry and values, through the NRRD that plastimatch makes of the file."""
    copy = path + ".itk.nrrd"
    subprocess.run([program("plastimatch"), "convert", "--input", path, "--output-img", copy],
                   check=True, capture_output=True)
    found = read_by_teem(copy)
    os.remove(copy)
    return found


def read_by_vtk(path, affine):
    """VTK's values, spacing and origin. Its reader leaves the direction alone: that is taken from
    `affine`."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkMetaImageReader

    reader = vtkMetaImageReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    values = vtk_to_numpy(image.GetPointData().GetScalars())
    found = np.eye(4)
    found[:3, :3] = affine[:3, :3] / np.linalg.norm(affine[:3, :3], axis=0) * image.GetSpacing()
    found[:3, 3] = image.GetOrigin()
    return reading(values.reshape(image.GetDimensions(), order="F"), found)


def cases(folder):
    for n, row in enumerate(choose(FACTORS, ("type", "encoding", "order"), allowed)):
        affine, options = GRIDS[row["grid"]], []
        shape = {"scalar": DIMS, "time": (*DIMS, 2), "vector": (3, *DIMS)}[row["axes"]]
        values = chosen = values_of(row["type"], shape, n)
        if row["axes"] == "time":
            options, chosen = ["--frame", "1"], values[..., 1]
        if row["axes"] == "vector":
            options, chosen = ["--channel", "2"], values[2]
        write = write_by_hand if row["writer"] == "hand" else write_by_vtk
        path = write(os.path.join(folder, f"m{n:03d}"), row, affine, values)
        oracles = [("intent", lambda c=chosen, a=affine: reading(c, a))]
        # MetaIO, which both judges use, swaps the bytes of text that a header calls big-endian.
        is_sane = row["axes"] == "scalar" and (row["encoding"], row["order"]) != ("ascii", "big")
        if is_sane and row["type"] not in ("int64", "uint64"):
            oracles.append(("vtk", lambda p=path, a=affine: read_by_vtk(p, a)))
        if is_sane and row["type"] in PLASTIMATCH_TYPES:
            oracles.append(("plastimatch", lambda p=path: read_by_plastimatch(p)))
        yield Case(path, oracles, options, name=f"{os.path.basename(path)} {' '.join(row.values())}")
