"""From every format that supple reads to every one it writes, and back.

Sources are made by other programs or by hand. What `supple convert` makes of them, there and back
again, is read by the target format's own programs: nibabel, teem, VTK, tifffile, h5py and OpenVDB.
Values must be equal to the bit and keep their type (in OpenVDB, which holds floats, equal as 32-bit
floats); the geometry must be equal within what the format keeps.
"""
import os
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

import write_dicom
import write_hdf5
import write_metaimage
import write_nifti
import write_nrrd
import write_tiff
from common import Tally, differences, has_module, reading, require_sharp_comparison, run_supple
from factors import DIMS, GRIDS, TYPES, choose, values_of

TARGETS = {"nrrd": ".nrrd", "nhdr": ".nhdr", "mha": ".mha", "mhd": ".mhd", "nii": ".nii",
           "nii.gz": ".nii.gz", "tif": ".tif", "h5": ".h5", "vdb": ".vdb"}
OWN = {"nrrd": "nrrd", "metaimage": "mha", "nifti": "nii", "tiff": "tif", "hdf5": "h5",
       "vdb": "vdb", "raw": "nrrd", "dicom": "nrrd", "scaled nifti": "nii"}  # on the way back
FACTORS = {"source": list(OWN), "target": list(TARGETS), "type": TYPES, "grid": list(GRIDS),
           "compress": ["", "--compress"]}
SPACINGS_ONLY = ["raw", "tiff"]
NO_SHEAR = ["mha", "mhd", "h5"]
FLOAT_TYPES = ["int8", "uint8", "int16", "uint16", "float32"]  # that 32-bit floats hold
TOLERANCE = {"nii": 1e-6, "nii.gz": 1e-6, "tif": 1e-6}
BASIS = {"order": "little", "axes": "scalar", "encoding": "raw", "files": "attached",
         "space": "right-anterior-superior"}


def allowed(row):
    if row["compress"] and row["target"] not in ("nrrd", "mha", "tif", "h5"):
        return False
    if row["source"] in SPACINGS_ONLY and row["grid"] not in ("unit", "anisotropic"):
        return False
    if row["grid"] == "sheared" and row["source"] in ("metaimage", "hdf5", "vdb"):
        return False  # nothing could be written back
    return row["type"] in {"vdb": ["float32"], "dicom": ["int16", "uint16"]}.get(row["source"], TYPES)


def make_source(stem, row, values, n):
    """(path, options, affine) of a file that supple did not write."""
    affine, basis = GRIDS[row["grid"]].copy(), {**BASIS, "type": row["type"]}
    if row["source"] in SPACINGS_ONLY:
        affine[:3, 3] = 0
    if row["source"] == "nrrd":
        return write_nrrd.write_by_hand(stem, basis, affine, values), [], affine
    if row["source"] == "metaimage":
        path = write_metaimage.write_by_hand(stem, {**basis, "files": "mha"}, affine, values)
        return path, [], affine
    if row["source"] in ("nifti", "scaled nifti"):
        scaling = "slope" if row["source"] == "scaled nifti" else "none"
        nifti = {**basis, "version": "1", "files": ".nii", "forms": "sform", "unit": "mm",
                 "scaling": scaling}
        path = write_nifti.write(stem, nifti, affine, values)
        return path, [], write_nifti.read_by_nibabel(path).affine  # of 32-bit floats
    if row["source"] == "hdf5":
        path, itk = stem + ".h5", {**basis, "flavour": "itk", "library": "latest"}
        write_hdf5.write(path, {**itk, "storage": "gzip"}, affine, values.transpose(2, 1, 0))
        return path, [], affine
    if row["source"] == "dicom":
        ct = {**basis, "syntax": "explicit", "layout": "series", "rescale": "none", "bits": "all",
              "opened": "folder"}
        affine = write_dicom.grid_of(row["grid"])
        path = write_dicom.write(stem, ct, affine, values, n)
        files = [os.path.join(path, name) for name in os.listdir(path)]
        return path, [], write_dicom.read_by_pydicom(files, stem).affine
    if row["source"] == "vdb":
        return write_vdb(stem + ".vdb", affine, values), [], affine
    if row["source"] == "tiff":
        flavour = {"flavour": "centimetre", "place": "strips", "version": "classic",
                   "compression": "zlib"}
        path = write_tiff.write(stem, {**basis, **flavour}, values.transpose(2, 1, 0))
        return path, [], write_tiff.read_by_tifffile(path).affine  # of fractions
    with open(stem + ".raw", "wb") as file:
        file.write(values.tobytes(order="F"))
    spacing = ",".join(str(affine[a, a]) for a in range(3))
    described = f"dims={','.join(map(str, DIMS))},type={row['type']},spacing={spacing}"
    return stem + ".raw", ["--raw", described], affine


def write_vdb(path, affine, values):
    import pyopenvdb

    grid = pyopenvdb.FloatGrid()
    grid.name = "density"
    grid.copyFromArray(values)
    grid.transform = pyopenvdb.createLinearTransform(affine.T.tolist())
    pyopenvdb.write(path, grids=[grid])
    return path


def read_by_openvdb(path):
    import pyopenvdb

    grids, _ = pyopenvdb.readAll(path)
    grid = next(grid for grid in grids if grid.name == "density")
    values = np.zeros(DIMS, np.float32)
    grid.copyToArray(values)
    corners = [np.array(grid.transform.indexToWorld(index))
               for index in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))]
    affine = np.eye(4)
    affine[:3] = np.column_stack([corner - corners[0] for corner in corners[1:]] + [corners[0]])
    return reading(values, affine)


def read_by_others(path, affine):
    """By the program that the extension calls for."""
    if path.endswith((".nrrd", ".nhdr")):
        return write_nrrd.read_by_teem(path)
    if path.endswith((".mha", ".mhd")):
        return write_metaimage.read_by_vtk(path, affine)
    if path.endswith((".nii", ".nii.gz")):
        return write_nifti.read_by_nibabel(path)
    if path.endswith(".tif"):
        return write_tiff.read_by_tifffile(path)
    return write_hdf5.read_by_h5py(path) if path.endswith(".h5") else read_by_openvdb(path)


def expected_in(target, intent, type_is_kept):
    """What a program should find in a file of this format."""
    if target == "tif":  # others see the spacing there
        steps = np.linalg.norm(intent.affine[:3, :3], axis=0)
        intent = replace(intent, affine=np.diag([*steps, 1.0]))
    return intent, target != "vdb" and type_is_kept


def compare(lines, what, path, target, intent, type_is_kept, tolerance):
    intent, is_exact = expected_in(target, intent, type_is_kept)
    if target in ("mha", "mhd") and intent.type in ("int64", "uint64"):
        return  # VTK knows none
    try:
        theirs = read_by_others(path, intent.affine)
    except Exception as error:
        lines.append((what, "a volume", f"{type(error).__name__}: {error}"))
        return
    for name, found, meant in differences(theirs, intent, tolerance):
        if is_exact or name not in ("type", "sha256"):
            lines.append((f"{what}, {name}", found, meant))
    if theirs.floats != intent.floats:
        lines.append((f"{what}, values as floats", theirs.floats, intent.floats))


def convert(lines, source, options, target):
    done = run_supple("--quiet", "convert", source, target, *options)
    if done.returncode != 0:
        lines.append(("convert", f"exit code {done.returncode}: {done.stderr.strip()}", "a file"))
    return done.returncode == 0


def round_trip(folder, n, row):
    """Disagreements of one row as (what, found, meant)."""
    values = values_of(row["type"], DIMS, n)
    source, options, affine = make_source(os.path.join(folder, f"s{n:03d}"), row, values, n)
    scale = (0.5, -1024) if row["source"] == "scaled nifti" else (1, 0)
    if row["source"] == "dicom" and np.linalg.det(GRIDS[row["grid"]][:3, :3]) < 0:
        values = values[:, :, ::-1]  # slices are sorted along row x column
    intent, lines = reading(values, affine, *scale), []
    there = os.path.join(folder, f"there{n:03d}{TARGETS[row['target']]}")
    packed = [row["compress"]] if row["compress"] else []
    if row["grid"] == "sheared" and row["target"] in NO_SHEAR:
        done = run_supple("--quiet", "convert", source, there, *options)
        if done.returncode != 3 or "sheared" not in done.stderr or os.path.exists(there):
            lines.append(("sheared axes", f"exit code {done.returncode}: {done.stderr}", "a refusal"))
        return lines
    if not convert(lines, source, options + packed, there):
        return lines
    is_exact = scale == (1, 0) or row["target"] in ("nii", "nii.gz")
    own = OWN[row["source"]]
    # Libtiff hands resolutions over as 32-bit floats.
    near = [TOLERANCE.get(row["target"], 1e-7 if row["source"] == "tiff" else 1e-9),
            TOLERANCE.get(own, 1e-9)]
    compare(lines, "there", there, row["target"], intent, is_exact, near[0])
    back = os.path.join(folder, f"back{n:03d}{TARGETS[own]}")
    if convert(lines, there, [], back):
        kept = row["target"] != "vdb" or row["type"] in FLOAT_TYPES
        compare(lines, "back", back, own, intent, is_exact and kept, max(near))
    return lines


def missing():
    found = [module.missing() for module in (write_nrrd, write_metaimage, write_nifti, write_tiff,
                                             write_hdf5, write_dicom)]
    if not has_module("pyopenvdb"):
        found.append("python3-openvdb")
    return sorted(set(filter(None, found)))


def main():
    tally = Tally()
    if missing():
        print(f"skipped: {', '.join(missing())} not installed")
        sys.exit(77)
    require_sharp_comparison(reading(values_of("int16", DIMS, 1), GRIDS["oblique"]))
    rows = choose(FACTORS, ("source", "target"), allowed)
    with tempfile.TemporaryDirectory(prefix="supple_trips_") as folder, \
            ThreadPoolExecutor(max(2, min(8, os.cpu_count() or 2))) as pool:
        trips = pool.map(lambda pair: round_trip(folder, *pair), enumerate(rows))
        for row, lines in zip(rows, trips):
            tally.files += 1
            for what, found, meant in lines:
                tally.report(" ".join(filter(None, row.values())), what, found, meant)
    tally.finish("round trips")


if __name__ == "__main__":
    main()
