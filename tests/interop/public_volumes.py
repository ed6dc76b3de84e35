"""Public volumes, read by supple and by other people's programs.

The test data of nibabel and pydicom as Debian installs them, and the example volumes of Debian
packages that lie in build/data or are installed (a CT, MRIs and label maps). A file is either read,
and then agrees in dims, axes, origin, type, checksum and range, or refused with one line and exit
code 3. What must be read is listed here; a file that is not at hand is named and left out.
"""
import gzip
import os
import sys
import tempfile
import warnings

import numpy as np

import write_dicom
import write_nifti
import write_nrrd
from common import Case, Refusal, Tally, has_module, reading, require_sharp_comparison, supple_readings

PACKAGES = "/usr/lib/python3/dist-packages"
DATA = [os.path.join(os.environ.get("SUPPLE_SOURCE_DIR", "."), "build/data"),
        "/usr/share/mricron/templates", "/usr/share/doc/libvolpack1-dev/examples"]
# Ends as NIfTI does, but is a connectivity matrix: six dimensions and none in space.
NO_VOLUMES = ["row_major.dconn.nii"]
READ_BY_NIBABEL = ["ch2.nii.gz", "ch2bet.nii.gz", "aal.nii.gz", "brodmann.nii.gz",
                   "ch2better.nii.gz"]
# name: dims, spacing, bytes before the values
RAW = {"ct_head.raw": ((256, 256, 108), (0.957031, 0.957031, 1.5), "int16", 0),
       "brainsmall.den": ((128, 128, 84), (1, 1, 1), "uint8", 62),
       "liver.inr.gz": ((438, 353, 165), (0.617188, 0.617188, 1.33333), "uint8", 256)}
# Others hold colours, JPEG 2000, no pixels, no position, damage or no file header.
READ_BY_PYDICOM = ["CT_small.dcm", "MR_small.dcm", "MR_small_RLE.dcm", "MR_small_bigendian.dcm",
                   "MR_small_expb.dcm", "MR_small_implicit.dcm", "MR_small_jpeg_ls_lossless.dcm",
                   "MR_small_padded.dcm", "rtdose.dcm", "rtdose_1frame.dcm", "rtdose_rle.dcm",
                   "rtdose_rle_1frame.dcm", "0.dcm", "1.dcm", "decimal_rescale.dcm", "693_J2KI.dcm",
                   "MR_small_jp2klossless.dcm", "slicethickness_empty_string.dcm"]
# Its stream is unsigned and its attributes are signed: pydicom and supple go by the attributes, GDCM, which
# unpacks it here, by the stream.
READ_BY_NO_JUDGE = ["J2K_pixelrep_mismatch.dcm"]
DICOM_TOLERANCE = 1e-5  # direction cosines of six decimals, which supple makes unit vectors of


def nifti_cases(path):
    """One per frame."""
    import nibabel

    shape = nibabel.load(path).shape
    frames = range(shape[3]) if len(shape) > 3 and shape[3] > 1 else [None]
    for frame in frames:
        yield Case(path, [("nibabel", lambda f=frame: write_nifti.read_by_nibabel(path, f))],
                   [] if frame is None else ["--frame", frame], tolerance=1e-6)


def minc_case(path):
    """The values of a MINC 2 file are a plain HDF5 dataset to supple, without a voxel size."""
    import h5py

    inside = "/minc-2.0/image/0/image"

    def read_by_h5py():
        with h5py.File(path, "r") as file:
            values = file[inside][()]
        return reading((values[0] if values.ndim == 4 else values).transpose(2, 1, 0), np.eye(4))

    with h5py.File(path, "r") as file:
        has_frames = file[inside].ndim == 4
    return Case(f"{path}:{inside}", [("h5py", read_by_h5py)], ["--frame", "0"] if has_frames else [])


def raw_case(path, scratch):
    dims, spacing, kind, offset = RAW[os.path.basename(path)]
    if path.endswith(".gz"):
        with gzip.open(path) as packed, open(os.path.join(scratch, "plain.raw"), "wb") as plain:
            plain.write(packed.read())
            path = plain.name

    def read_by_numpy():
        values = np.fromfile(path, np.dtype(kind).newbyteorder("<"), offset=offset)
        return reading(values.reshape(dims, order="F"), np.diag([*spacing, 1.0]))

    described = (f"dims={','.join(map(str, dims))},type={kind},offset={offset},"
                 f"spacing={','.join(map(str, spacing))}")
    return Case(path, [("numpy", read_by_numpy)], ["--raw", described])


def example_cases(scratch, tally):
    def place_of(name):
        found = [os.path.join(folder, name) for folder in DATA
                 if os.path.exists(os.path.join(folder, name))]
        return found[0] if found else print(f"not at hand: {name}")

    for name in READ_BY_NIBABEL:
        path = place_of(name)
        if path:
            yield from nifti_cases(path)
    for name in RAW:
        path = place_of(name)
        if path:
            yield raw_case(path, scratch)
    header = place_of("ct_head.nhdr")
    if header and write_nrrd.missing():
        tally.skip("ct_head.nhdr", write_nrrd.missing())
    elif header:
        copy = os.path.join(scratch, "ct_head.nhdr")  # teem writes its answer beside it
        for name in ("ct_head.nhdr", "ct_head.raw"):
            os.symlink(os.path.join(os.path.dirname(header), name), os.path.join(scratch, name))
        yield Case(copy, [("unu", lambda: write_nrrd.read_by_teem(copy))])


def nibabel_cases(scratch, refused):
    """The volumes among nibabel's test data; what else is there goes to `refused`."""
    folder = os.path.join(PACKAGES, "nibabel/tests/data")
    for name in sorted(os.listdir(folder)):
        path = os.path.join(folder, name)
        with open(path, "rb") if os.path.isfile(path) else open(os.devnull, "rb") as file:
            is_hdf5 = file.read(8) == b"\x89HDF\r\n\x1a\n"
        if os.path.isdir(path):
            continue
        if name.endswith((".nii", ".nii.gz")) and name not in NO_VOLUMES:
            yield from nifti_cases(path)
        elif name.endswith(".dcm") and not write_dicom.missing():
            series = [os.path.join(folder, other) for other in ("0.dcm", "1.dcm")]
            # The second slice is 0.016 mm off the normal; below a twentieth of a pixel that counts
            # as rounding of the header, and the axis is the normal.
            yield Case(path, [("pydicom", lambda: write_dicom.read_by_pydicom(series, scratch))],
                       tolerance=0.006)
        else:
            refused.append(path)
        if is_hdf5 and has_module("h5py"):
            yield minc_case(path)


def pydicom_cases(scratch, refused):
    """Each file alone in a folder, since they belong to no common series."""
    sources = [os.path.join(PACKAGES, folder) for folder in ("pydicom/data/test_files",
                                                             "nibabel/nicom/tests/data")]
    for source in filter(os.path.isdir, sources):
        for name in sorted(os.listdir(source)):
            if not os.path.isfile(os.path.join(source, name)) or ".dcm" not in name:
                continue
            alone = os.path.join(scratch, f"alone_{name}")
            os.makedirs(alone, exist_ok=True)
            path = os.path.join(alone, name)
            if os.path.exists(path):
                continue
            os.symlink(os.path.join(source, name), path)
            if name in READ_BY_PYDICOM:
                yield Case(path, [("pydicom", lambda p=path:
                                   write_dicom.read_by_pydicom([p], scratch))],
                           tolerance=DICOM_TOLERANCE)
            elif name not in READ_BY_NO_JUDGE:
                refused.append(path)


def check_refusals(tally, paths):
    found = supple_readings([(path, ()) for path in paths])
    for path in paths:
        tally.files += 1
        ours = found[path, ()]
        if not isinstance(ours, Refusal):
            tally.report(path, "read", ours, "a refusal")
        elif ours.code != 3 or ours.message.count("\n") != 1:
            tally.report(path, "refusal", f"exit code {ours.code}: {ours.message!r}",
                         "exit code 3 and one line")
    print(f"refused: {len(paths)} files that hold no volume of these formats")


def main():
    tally = Tally()
    warnings.simplefilter("ignore")  # of pydicom, about files that are odd on purpose
    if not has_module("nibabel"):
        print("skipped: python3-nibabel is not installed")
        sys.exit(77)
    refused = []
    with tempfile.TemporaryDirectory(prefix="supple_public_") as scratch:
        cases = list(nibabel_cases(scratch, refused))
        if write_dicom.missing():
            tally.skip("DICOM", write_dicom.missing())
        else:
            cases += pydicom_cases(scratch, refused)
        cases += example_cases(scratch, tally)
        require_sharp_comparison(cases[0].oracles[0][1]())
        tally.compare_all(cases)
        check_refusals(tally, refused)
    tally.finish()


if __name__ == "__main__":
    main()
