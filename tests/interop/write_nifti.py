"""NIfTI files: headers and values written through nibabel, read by nibabel."""
import gzip
import os

import numpy as np

from common import Case, has_module, reading
from factors import DIMS, GRIDS, ORDERS, TYPES, choose, values_of

FACTORS = {
    "type": [*TYPES, "RGB"],
    "version": ["1", "2"],
    "order": ["little", "big"],
    "files": [".nii", ".nii.gz", ".hdr", ".hdr.gz"],
    "forms": ["sform", "qform", "both", "differing", "neither"],
    "scaling": ["none", "slope", "zero"],
    "unit": ["mm", "meter", "micron", "unknown"],
    "grid": list(GRIDS),
    "axes": ["scalar", "time", "vector"],
}
MM = {"mm": 1.0, "meter": 1000.0, "micron": 0.001, "unknown": 1.0}
RAS = np.diag([-1.0, -1.0, 1.0, 1.0])


def missing():
    return None if has_module("nibabel") else "python3-nibabel"


def allowed(row):
    if row["grid"] == "sheared" and row["forms"] in ("qform", "both"):
        return False  # a qform holds no shear
    if row["type"] == "RGB":
        return row["axes"] == "scalar" and row["scaling"] == "none"
    return True


def header_of(row, affine, values):
    import nibabel.nifti1

    kinds = {("1", False): nibabel.Nifti1Header, ("1", True): nibabel.nifti1.Nifti1PairHeader,
             ("2", False): nibabel.Nifti2Header, ("2", True): nibabel.nifti2.Nifti2PairHeader}
    is_pair = row["files"].startswith(".hdr")
    header = kinds[row["version"], is_pair](endianness=ORDERS[row["order"]])
    header.set_data_dtype(values.dtype)
    header.set_data_shape(values.shape)
    header.set_zooms([1.0] * values.ndim)
    ras = RAS @ affine
    ras[:3] /= MM[row["unit"]]
    header["pixdim"][1:4] = np.linalg.norm(ras[:3, :3], axis=0)
    if row["forms"] in ("sform", "both", "differing"):
        header.set_sform(ras, code=1)
    if row["forms"] in ("qform", "both"):
        header.set_qform(ras, code=1)
    if row["forms"] == "differing":
        header.set_qform(np.diag([2.0, 3.0, 4.0, 1.0]), code=2)
    header["xyzt_units"] = {"mm": 2, "meter": 1, "micron": 3, "unknown": 0}[row["unit"]] | 8
    header["scl_slope"], header["scl_inter"] = {
        "none": (1, 0), "slope": (0.5, -1024), "zero": (0, 7)}[row["scaling"]]
    if not is_pair:
        header["vox_offset"] = len(header.binaryblock) + 4
    return header


def write(stem, row, affine, values):
    header = header_of(row, affine, values)
    kind = header.get_data_dtype()
    body = values.astype(kind).tobytes(order="F")
    pack = gzip.compress if row["files"].endswith(".gz") else bytes
    path = stem + row["files"]
    with open(path, "wb") as file:
        if row["files"].startswith(".hdr"):
            file.write(pack(header.binaryblock))
            with open(path.replace(".hdr", ".img"), "wb") as image:
                image.write(pack(body))
        else:
            file.write(pack(header.binaryblock + bytes(4) + body))
    return path


def read_by_nibabel(path, frame=None, channel=None):
    """Where neither form is set, the format's method 1: the spacings alone. (Nibabel centres the
    grid and flips it there, as SPM did for Analyze files.) Nibabel leaves units to its caller."""
    import nibabel.nifti1

    image = nibabel.load(path)
    header = image.header
    affine = image.affine
    if int(header["sform_code"]) <= 0 and int(header["qform_code"]) <= 0:
        affine = np.diag([*header["pixdim"][1:4].astype(float), 1.0])
    mm = {1: 1000.0, 3: 0.001}.get(int(header["xyzt_units"]) & 7, 1.0)
    values = np.asanyarray(image.dataobj.get_unscaled())
    values = values.reshape(values.shape + (1,) * (3 - values.ndim))
    if values.dtype.names:
        values = values[values.dtype.names[channel]]
    elif channel is not None:
        values = values[..., 0, channel]
    elif frame is not None:
        values = values[..., frame]
    slope, intercept = image.dataobj.slope, image.dataobj.inter
    return reading(values, RAS @ np.diag([mm, mm, mm, 1.0]) @ affine, slope, intercept)


def cases(folder):
    for n, row in enumerate(choose(FACTORS, ("type", "version", "order"), allowed)):
        affine, options, picked = GRIDS[row["grid"]], [], {}
        shape = {"scalar": DIMS, "time": (*DIMS, 3), "vector": (*DIMS, 1, 3)}[row["axes"]]
        values = values_of("uint8" if row["type"] == "RGB" else row["type"], shape, n)
        if row["type"] == "RGB":
            colours = np.dtype([("R", "u1"), ("G", "u1"), ("B", "u1")])
            values = np.stack([values, values[::-1], values[:, ::-1]], -1).copy().view(colours)[..., 0]
            options, picked = ["--channel", "1"], {"channel": 1}
        elif row["axes"] == "time":
            options, picked = ["--frame", "2"], {"frame": 2}
        elif row["axes"] == "vector":
            options, picked = ["--channel", "1"], {"channel": 1}
        path = write(os.path.join(folder, f"f{n:03d}"), row, affine, values)
        oracles = [("nibabel", lambda p=path, k=picked: read_by_nibabel(p, **k))]
        yield Case(path, oracles, options, name=f"{os.path.basename(path)} {' '.join(row.values())}",
                   tolerance=1e-6 if row["forms"] == "qform" else 1e-9)
