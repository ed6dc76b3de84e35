"""DICOM series and enhanced CT written by pydicom and DCMTK's compressors, read by pydicom."""
import os
import subprocess

import numpy as np

from common import Case, has_module, program, reading
from factors import DIMS, GRIDS, choose, values_of

FACTORS = {
    "type": ["int8", "uint8", "int16", "uint16", "int32", "uint32"],
    "bits": ["all", "fewer"],
    "syntax": ["implicit", "explicit", "big", "deflated", "rle", "jpeg", "jpegls"],
    "layout": ["series", "enhanced"],
    "rescale": ["none", "hounsfield", "fraction"],
    "opened": ["folder", "file"],
    "grid": [*GRIDS],
}
COMPRESSORS = {"jpeg": "dcmcjpeg", "jpegls": "dcmcjpls", "rle": "dcmcrle", "deflated": "dcmconv"}
CLASSES = {"series": "1.2.840.10008.5.1.4.1.1.2", "enhanced": "1.2.840.10008.5.1.4.1.1.2.1"}
PREFIX = "1.2.826.0.1.3680043.8.498."


def missing():
    if not has_module("pydicom"):
        return "python3-pydicom"
    if not program("gdcmconv"):
        return "libgdcm-tools"
    return None if all(map(program, [*COMPRESSORS.values(), "dcmdjpeg", "dcmdjpls"])) else "dcmtk"


def allowed(row):
    if row["type"] in ("int32", "uint32") and row["syntax"] in ("jpeg", "jpegls"):
        return False  # no codec for more than 16 bits
    if row["type"] in ("int32", "uint32") and row["syntax"] == "big":
        return False  # supple refuses them: the order of their words is not agreed on
    if row["syntax"].startswith("jpeg") and row["type"].startswith("int"):
        return False  # DCMTK's codecs take the unsigned
    return True


def grid_of(name):
    """Rows and columns of DICOM are at right angles; what may be sheared are the slices."""
    affine = GRIDS[name].copy()
    if name == "sheared":
        affine[:3, :3] = GRIDS["oblique"][:3, :3]
        affine[:3, 2] += 0.3 * affine[:3, 1]
    return affine


def dataset_of(row, identity):
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.uid import ExplicitVRBigEndian, ExplicitVRLittleEndian, ImplicitVRLittleEndian

    syntax = {"implicit": ImplicitVRLittleEndian, "big": ExplicitVRBigEndian}.get(
        row["syntax"], ExplicitVRLittleEndian)
    image = Dataset()
    image.file_meta = FileMetaDataset()
    image.file_meta.TransferSyntaxUID = syntax
    image.file_meta.MediaStorageSOPClassUID = image.SOPClassUID = CLASSES[row["layout"]]
    image.file_meta.MediaStorageSOPInstanceUID = image.SOPInstanceUID = PREFIX + identity
    image.is_little_endian, image.is_implicit_VR = syntax != ExplicitVRBigEndian, \
        syntax == ImplicitVRLittleEndian
    image.SeriesInstanceUID = PREFIX + identity.split(".")[0]
    image.StudyInstanceUID = image.SeriesInstanceUID + ".9"
    image.Modality, image.PatientName, image.PatientID = "CT", "Phantom", "1"
    image.SamplesPerPixel, image.PhotometricInterpretation = 1, "MONOCHROME2"
    image.PixelRepresentation = int(row["type"].startswith("int"))
    width = np.dtype(row["type"]).itemsize * 8
    image.BitsAllocated = width
    image.BitsStored = width if row["bits"] == "all" else width - 3
    image.HighBit = image.BitsStored - 1
    return image


def decimal(numbers):
    """A decimal string has 16 characters."""
    from pydicom.valuerep import format_number_as_ds

    return [format_number_as_ds(float(x)) for x in numbers]


def set_pixels(image, slices, row):
    """`slices` in index order (i, j) or (i, j, k)."""
    kind = np.dtype(row["type"]).newbyteorder(">" if row["syntax"] == "big" else "<")
    image.Columns, image.Rows = slices.shape[:2]
    pixels = slices.astype(kind).tobytes(order="F")
    image.PixelData = pixels + bytes(len(pixels) % 2)
    image["PixelData"].VR = "OB" if kind.itemsize == 1 and row["syntax"] != "implicit" else "OW"


def place_in(target, row, affine):
    spacing = np.linalg.norm(affine[:3, :2], axis=0)
    axes = affine[:3, :2] / spacing
    target["orientation"].ImageOrientationPatient = decimal(axes.T.ravel())
    target["measures"].PixelSpacing = decimal(spacing[::-1])  # between rows, then between columns
    slope, intercept = {"none": (1, 0), "hounsfield": (1, -1024), "fraction": (0.5, 7)}[
        row["rescale"]]
    if row["rescale"] != "none" or row["layout"] == "enhanced":
        target["rescale"].RescaleSlope, target["rescale"].RescaleIntercept = slope, intercept


def write(folder, row, affine, values, number):
    """Path of the folder or of a file in it."""
    from pydicom.dataset import Dataset

    os.mkdir(folder)
    images = {}
    if row["layout"] == "series":
        for k in range(values.shape[2]):
            image = dataset_of(row, f"{number + 1}.{k + 1}")
            place_in({name: image for name in ("orientation", "measures", "rescale")}, row, affine)
            image.ImagePositionPatient = decimal(affine[:3, 3] + k * affine[:3, 2])
            image.InstanceNumber = values.shape[2] - k
            set_pixels(image, values[:, :, k], row)
            images[f"{7 * k % 5}.dcm"] = image  # in no order
    else:
        image = dataset_of(row, f"{number + 1}.1")
        parts = {name: Dataset() for name in ("orientation", "measures", "rescale")}
        place_in(parts, row, affine)
        parts["rescale"].RescaleType = "HU"
        shared = Dataset()
        shared.PlaneOrientationSequence, shared.PixelMeasuresSequence = \
            [parts["orientation"]], [parts["measures"]]
        shared.PixelValueTransformationSequence = [parts["rescale"]]
        image.SharedFunctionalGroupsSequence = [shared]
        image.PerFrameFunctionalGroupsSequence = []
        for k in range(values.shape[2]):
            position, frame = Dataset(), Dataset()
            position.ImagePositionPatient = decimal(affine[:3, 3] + k * affine[:3, 2])
            frame.PlanePositionSequence = [position]
            image.PerFrameFunctionalGroupsSequence.append(frame)
        image.NumberOfFrames = values.shape[2]
        set_pixels(image, values, row)
        images["frames.dcm"] = image
    for name, image in images.items():
        path = os.path.join(folder, name)
        image.save_as(path, write_like_original=False)
        if row["syntax"] in COMPRESSORS:
            flags = ["+td"] if row["syntax"] == "deflated" else []
            subprocess.run([program(COMPRESSORS[row["syntax"]]), *flags, path, path], check=True,
                           capture_output=True)
    return folder if row["opened"] == "folder" else path


def unpacked(path, scratch):
    """Pydicom's data set; JPEG, which it leaves to other packages, is unpacked by DCMTK and GDCM."""
    import pydicom

    syntax = pydicom.dcmread(path, stop_before_pixels=True).file_meta.TransferSyntaxUID
    if syntax.startswith("1.2.840.10008.1.2.4."):
        plain = os.path.join(scratch, f"plain_{os.getpid()}_{abs(hash(path))}.dcm")
        unpack = {"80": ["dcmdjpls"], "81": ["dcmdjpls"], "90": ["gdcmconv", "--raw"],
                  "91": ["gdcmconv", "--raw"]}.get(syntax[20:], ["dcmdjpeg"])
        subprocess.run([program(unpack[0]), *unpack[1:], path, plain], check=True, capture_output=True)
        path = plain
    return pydicom.dcmread(path)


def planes_of(image):
    """(position, pixels) of every frame, and where the data set says orientation and the like."""
    pixels = image.pixel_array.reshape(-1, image.Rows, image.Columns)
    parts, places = [image] * 3, [image]
    if "SharedFunctionalGroupsSequence" in image:
        shared = image.SharedFunctionalGroupsSequence[0]
        parts = [shared.PlaneOrientationSequence[0], shared.PixelMeasuresSequence[0],
                 shared.PixelValueTransformationSequence[0]]
        places = [f.PlanePositionSequence[0] for f in image.PerFrameFunctionalGroupsSequence]
    positions = [np.array(place.ImagePositionPatient, float) for place in places]
    if "GridFrameOffsetVector" in image:  # a dose grid: frames along the normal
        rows = np.array(image.ImageOrientationPatient, float).reshape(2, 3)
        positions = [positions[0] + float(z) * np.cross(*rows) for z in image.GridFrameOffsetVector]
    return list(zip(positions, [plane.T for plane in pixels])), parts


def read_by_pydicom(paths, scratch):
    """Slices in order along row x column."""
    planes = []
    for path in paths:
        found, (orientation, measures, rescale) = planes_of(unpacked(path, scratch))
        planes += found
    axes = np.array(orientation.ImageOrientationPatient, float).reshape(2, 3)
    normal = np.cross(*axes)
    planes.sort(key=lambda plane: plane[0] @ normal)
    affine = np.eye(4)
    affine[:3, :2] = axes.T * np.array(measures.PixelSpacing, float)[::-1]
    if len(planes) > 1:
        affine[:3, 2] = (planes[-1][0] - planes[0][0]) / (len(planes) - 1)
    else:
        affine[:3, 2] = normal * float(
            measures.get("SpacingBetweenSlices") or measures.get("SliceThickness") or 1)
    affine[:3, 3] = planes[0][0]
    slope = rescale.get("DoseGridScaling") or rescale.get("RescaleSlope", 1)
    return reading(np.stack([plane for _, plane in planes], -1), affine, float(slope),
                   float(rescale.get("RescaleIntercept", 0)))


def cases(folder):
    for n, row in enumerate(choose(FACTORS, ("type", "syntax"), allowed)):
        affine = grid_of(row["grid"])
        values = values_of(row["type"], DIMS, n)
        if row["bits"] == "fewer":
            values >>= 3
        place = os.path.join(folder, f"d{n:03d}")
        path = write(place, row, affine, values, n)
        files = sorted(os.path.join(place, name) for name in os.listdir(place))
        yield Case(path, [("pydicom", lambda f=files: read_by_pydicom(f, folder))],
                   tolerance=1e-7, name=f"{os.path.basename(place)} {' '.join(row.values())}")
