"""Warps from one format to every other and back to NRRD, read on the way by other programs.

The source is an NRRD of float32 vectors that supple did not write. Vectors must be equal to the bit
and lie on the same grid wherever they pass: teem, nibabel, VTK, h5py and OpenVDB look.
"""
import os
import sys
import tempfile

import numpy as np

import write_nifti
import write_nrrd
from common import Tally, differences, has_module, program, reading, run_supple
from factors import DIMS, GRIDS, values_of
from round_trips import BASIS, NO_SHEAR, TARGETS, TOLERANCE


def read_by_vtk(path, affine):
    """VTK's reader leaves the direction alone: the grid is compared on the way back."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkMetaImageReader

    reader = vtkMetaImageReader()
    reader.SetFileName(path)
    reader.Update()
    vectors = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
    return vectors.reshape(*DIMS, 3, order="F"), affine


def read_by_nibabel(path):
    import nibabel

    image = nibabel.load(path)
    return np.asanyarray(image.dataobj)[:, :, :, 0], write_nifti.RAS @ image.affine


def read_by_h5py(path):
    """ITK's displacement field: size, origin, spacing and the direction by rows, then the vectors."""
    import h5py

    with h5py.File(path, "r") as file:
        fixed = file["TransformGroup/0/TransformFixedParameters"][()]
        vectors = file["TransformGroup/0/TransformParameters"][()].reshape(*DIMS[::-1], 3)
    affine = np.eye(4)
    affine[:3, :3] = fixed[9:].reshape(3, 3) * fixed[6:9]
    affine[:3, 3] = fixed[3:6]
    return vectors.transpose(2, 1, 0, 3), affine


def read_by_openvdb(path):
    import pyopenvdb

    grid = next(g for g in pyopenvdb.readAll(path)[0] if g.name in ("offset", "displacement"))
    vectors = np.zeros((*DIMS, 3), np.float32)
    grid.copyToArray(vectors)
    ends = [np.array(grid.transform.indexToWorld(index))
            for index in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))]
    affine = np.eye(4)
    affine[:3] = np.column_stack([end - ends[0] for end in ends[1:]] + [ends[0]])
    return vectors, affine


def components_of(path, affine):
    """One reading per component, as float32."""
    if path.endswith((".nrrd", ".nhdr")):
        return [write_nrrd.read_by_teem(path, channel=c) for c in range(3)]
    if path.endswith((".mha", ".mhd")):
        vectors, affine = read_by_vtk(path, affine)
    elif path.endswith((".nii", ".nii.gz")):
        vectors, affine = read_by_nibabel(path)
    else:
        vectors, affine = (read_by_h5py if path.endswith(".h5") else read_by_openvdb)(path)
    return [reading(vectors[..., c].astype(np.float32), affine) for c in range(3)]


def check(tally, name, path, affine, expected, tolerance):
    tally.files += 1
    for c, (found, meant) in enumerate(zip(components_of(path, affine), expected)):
        for what, ours, theirs in differences(found, meant, tolerance):
            tally.report(f"{name}, component {c}", what, ours, theirs)


def trips(tally, folder, grid_name):
    affine = GRIDS[grid_name]
    vectors = values_of("float32", (3, *DIMS), 7)
    stem = os.path.join(folder, grid_name)
    source = write_nrrd.write_by_hand(stem, {**BASIS, "type": "float32", "axes": "vector",
                                             "space": "LPS"}, affine, vectors)
    expected = [reading(vectors[c], affine) for c in range(3)]
    for target, extension in TARGETS.items():
        if target == "tif" or grid_name == "sheared" and target in NO_SHEAR + ["nii", "nii.gz"]:
            continue
        there, back = f"{stem}_{target}_there{extension}", f"{stem}_{target}_back.nrrd"
        for start, end in ((source, there), (there, back)):
            done = run_supple("--quiet", "convert", start, end)
            if done.returncode != 0:
                tally.report(f"{grid_name} {target}", "convert", done.stderr.strip(), "a warp")
                break
            check(tally, f"{grid_name} {target} {os.path.basename(end)}", end, affine, expected,
                  TOLERANCE.get(target, 1e-9))


def main():
    names = {"nibabel": "python3-nibabel", "vtkmodules.vtkIOImage": "python3-vtk9",
             "h5py": "python3-h5py", "pyopenvdb": "python3-openvdb"}
    missing = [package for module, package in names.items() if not has_module(module)]
    missing += [] if program("teem-unu", "unu") else ["teem-apps"]
    if missing:
        print(f"skipped: {', '.join(missing)} not installed")
        sys.exit(77)
    tally = Tally()
    with tempfile.TemporaryDirectory(prefix="supple_warps_") as folder:
        for grid_name in GRIDS:
            trips(tally, folder, grid_name)
    tally.finish("warp files")


if __name__ == "__main__":
    main()
