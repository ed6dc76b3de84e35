"""HDF5 files written by h5py: plain datasets, ITK images and NeXus entries, read by h5py."""
import os

import numpy as np

from common import Case, has_module, reading
from factors import DIMS, GRIDS, ORDERS, TYPES, choose, values_of

FACTORS = {
    "type": TYPES,
    "order": ["little", "big"],
    "storage": ["contiguous", "chunked", "gzip", "shuffle", "fletcher32", "compact"],
    "flavour": ["element_size_um", "spacing", "voxel_size", "resolution", "none", "nexus", "itk"],
    "library": ["earliest", "latest"],
    "grid": list(GRIDS),
    "axes": ["scalar", "time", "vector"],
}
MM = {"mm": 1.0, "um": 0.001, "m": 1000.0, "cm": 10.0}


def missing():
    return None if has_module("h5py") else "python3-h5py"


def allowed(row):
    if row["flavour"] == "itk":
        return True
    if row["flavour"] == "none" and row["grid"] != "unit":
        return False
    return row["grid"] in ("unit", "anisotropic") and row["axes"] != "vector"


def create(group, name, values, row):
    """`values` in the file's order of axes, slowest first."""
    import h5py

    storage = {"chunked": {"chunks": (2,) * values.ndim},
               "gzip": {"chunks": (2,) * values.ndim, "compression": "gzip"},
               "shuffle": {"chunks": (1,) * (values.ndim - 2) + (3, 3), "shuffle": True,
                           "compression": "gzip"},
               "fletcher32": {"chunks": (2,) * values.ndim, "fletcher32": True}}
    stored = values.astype(values.dtype.newbyteorder(ORDERS[row["order"]]))
    if row["storage"] != "compact":
        return group.create_dataset(name, data=stored, **storage.get(row["storage"], {}))
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_layout(h5py.h5d.COMPACT)
    dataset = h5py.h5d.create(group.id, name.encode(), h5py.h5t.py_create(stored.dtype),
                              h5py.h5s.create_simple(stored.shape), properties)
    dataset.write(h5py.h5s.ALL, h5py.h5s.ALL, stored)
    return h5py.Dataset(dataset)


def write(path, row, affine, values):
    import h5py

    spacing = np.diag(affine)[2::-1]  # k, j, i: the order of the dataset's axes
    with h5py.File(path, "w", libver=row["library"]) as file:
        if row["flavour"] == "itk":
            write_itk(file, row, affine, values)
            return
        if row["flavour"] == "nexus":
            write_nexus(file, row, spacing, values)
            return
        dataset = create(file, "volume", values, row)
        if row["flavour"] == "element_size_um":
            dataset.attrs["element_size_um"] = spacing * 1000
        elif row["flavour"] == "spacing":
            dataset.attrs["spacing"] = spacing
        elif row["flavour"] != "none":
            unit = {"voxel_size": "um", "resolution": "cm"}[row["flavour"]]
            dataset.attrs[row["flavour"]] = spacing / MM[unit]
            dataset.attrs["units"] = unit


def write_itk(file, row, affine, values):
    """As itk::HDF5ImageIO lays it out; rows of Directions are the axes."""
    rank = 4 if row["axes"] == "time" else 3
    spacing, axes, origin = np.ones(rank), np.eye(rank), np.zeros(rank)
    spacing[:3] = np.linalg.norm(affine[:3, :3], axis=0)
    axes[:3, :3] = (affine[:3, :3] / spacing[:3]).T
    origin[:3] = affine[:3, 3]
    sizes = values.shape[:rank][::-1]
    file["ITKVersion"], file["HDFVersion"] = "5.3.0", "1.10.8"
    group = file.create_group("ITKImage/0")
    for name, content in (("Dimension", np.array(sizes, np.uint64)), ("Origin", origin),
                          ("Spacing", spacing), ("Directions", axes)):
        group[name] = content
    group["VoxelType"] = row["type"].upper()
    group.create_group("MetaDataDictionary")
    create(group, "VoxelData", values, row)


def write_nexus(file, row, spacing, values):
    entry = file.create_group("entry1")
    entry.attrs["NX_class"] = "NXentry"
    entry["definition"] = "NXtomo"
    detector = entry.create_group("instrument/detector")
    entry["instrument"].attrs["NX_class"], detector.attrs["NX_class"] = "NXinstrument", "NXdetector"
    for name, step in zip("zyx", spacing):
        detector[f"{name}_pixel_size"] = step * 1000
        detector[f"{name}_pixel_size"].attrs["units"] = "um"
    data = entry.create_group("data")
    data.attrs["NX_class"], data.attrs["signal"] = "NXdata", "data"
    create(data, "data", values, row)


def read_by_h5py(path, frame=None, channel=None):
    import h5py

    affine = np.eye(4)
    with h5py.File(path, "r") as file:
        if "ITKImage" in file:
            group = file["ITKImage/0"]
            values = group["VoxelData"][()]
            affine[:3, :3] = group["Directions"][()][:3, :3].T * group["Spacing"][:3]
            affine[:3, 3] = group["Origin"][:3]
        elif "entry1" in file:
            values = file["entry1/data/data"][()]
            detector = file["entry1/instrument/detector"]
            sizes = [detector[f"{a}_pixel_size"] for a in "xyz"]
            affine[:3, :3] = np.diag([size[()] * MM[size.attrs["units"]] for size in sizes])
        else:
            values, attributes = file["volume"][()], dict(file["volume"].attrs)
            mm = 0.001 if "element_size_um" in attributes else MM[attributes.pop("units", "mm")]
            for steps in attributes.values():
                affine[:3, :3] = np.diag(steps[::-1] * mm)
    if frame is not None:
        values = values[frame]
    if channel is not None:
        values = values[..., channel]
    return reading(values.transpose(2, 1, 0), affine)


def cases(folder):
    for n, row in enumerate(choose(FACTORS, ("type", "storage", "order"), allowed)):
        shape = {"scalar": DIMS[::-1], "time": (2, *DIMS[::-1]),
                 "vector": (*DIMS[::-1], 3)}[row["axes"]]
        affine, options, picked = GRIDS[row["grid"]].copy(), [], {}
        if row["flavour"] != "itk":
            affine[:3, 3] = 0
        values = chosen = values_of(row["type"], shape, n)
        if row["axes"] == "time":
            options, picked, chosen = ["--frame", "1"], {"frame": 1}, values[1]
        if row["axes"] == "vector":
            options, picked, chosen = ["--channel", "2"], {"channel": 2}, values[..., 2]
        path = os.path.join(folder, f"h{n:03d}.h5")
        write(path, row, affine, values)
        yield Case(path, [("intent", lambda c=chosen, a=affine: reading(c.transpose(2, 1, 0), a)),
                          ("h5py", lambda p=path, k=picked: read_by_h5py(p, **k))], options,
                   name=f"{os.path.basename(path)} {' '.join(row.values())}")
