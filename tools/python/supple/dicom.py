"""Warps as DICOM deformable spatial registration objects (PS3.3 A.39.2, C.20.3). Needs pydicom.

The object leads from places of the registered frame, that of the fixed images, to the source frame,
that of the moving ones: resample direction. Vectors and places are in mm LPS, as in Supple.

    supple.dicom.write("reg.dcm", session.offsets(), fixed="ct/slice1.dcm", moving="old/slice1.dcm")
    warp = supple.dicom.read("reg.dcm")
"""
from __future__ import annotations

import datetime
import os
import re
from typing import Any, List, Optional, Union

import numpy as np
import pydicom
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.sequence import Sequence as Items
from pydicom.uid import UID, ExplicitVRLittleEndian, generate_uid

from . import _supple
from ._errors import InputError
from ._warp import Warp, as_warp

__all__ = ["frames", "read", "write"]

_CLASS = UID("1.2.840.10008.5.1.4.1.1.66.3")
_PATIENT = ("PatientName", "PatientID", "PatientBirthDate", "PatientSex")
_STUDY = ("StudyInstanceUID", "StudyDate", "StudyTime", "ReferringPhysicianName", "StudyID",
          "AccessionNumber")
_Path = Union[str, os.PathLike]


def _open(path: _Path) -> Dataset:
    try:
        return pydicom.dcmread(path)
    except FileNotFoundError:
        raise InputError(f"{path}: file: found none, expected a DICOM object", str(path), "file") \
            from None
    except pydicom.errors.InvalidDicomError:
        raise InputError(f"{path}: file: found no DICOM, expected a DICOM object", str(path),
                         "file") from None


def _frame_of(image: Dataset, path: _Path, name: str) -> str:
    uid = image.get("FrameOfReferenceUID")
    if uid:
        return str(uid)
    raise InputError(f"{path}: FrameOfReferenceUID: found none, expected that of the {name} images",
                     str(path), "FrameOfReferenceUID")


def _matrix(kind: str, matrix: np.ndarray) -> Items:
    item = Dataset()
    item.FrameOfReferenceTransformationMatrixType = kind
    item.FrameOfReferenceTransformationMatrix = [float(value) for value in matrix.ravel()]
    return Items([item])


def _grid_item(warp: Warp) -> Dataset:
    """The grid, whose third axis is the cross product of the others, as DICOM has it."""
    array, affine = warp.array, warp.affine.copy()
    steps = affine[:3, :3]
    if np.linalg.det(steps) < 0:
        affine[:3, 3] += steps[:, 2] * (array.shape[0] - 1)
        steps[:, 2] *= -1
        array = array[::-1]
    spacing = np.linalg.norm(steps, axis=0)
    ways = steps / spacing
    if np.abs(ways.T @ ways - np.eye(3)).max() > 1e-4:
        raise InputError("warp: found axes that are not perpendicular, expected perpendicular ones "
                         "for DICOM", field="warp")
    item = Dataset()
    item.ImageOrientationPatient = [f"{value:.10g}" for value in ways[:, :2].T.ravel()]
    item.ImagePositionPatient = [f"{value:.10g}" for value in affine[:3, 3]]
    item.GridDimensions = [int(count) for count in array.shape[2::-1]]
    item.GridResolution = [float(value) for value in spacing]
    item.VectorGridData = np.ascontiguousarray(array, "<f4").tobytes()
    return item


def write(path: _Path, warp: Any, *, fixed: _Path, moving: Optional[_Path] = None,
          label: str = "WARP", description: str = "") -> None:
    """Writes a warp of resample direction [k, j, i, 3] in mm LPS, or a file of one, to a path.

    fixed: a DICOM image of the registered frame, whose patient and study the object joins; moving:
    one of the source frame; None: the same frame. label: capitals, digits and _, 16 at most;
    description: a line.
    Raises InputError for a warp of material direction, for axes that are not perpendicular and for
    images without a frame of reference.
    """
    warp = as_warp(warp, "resample")
    if warp.direction != "resample":
        raise InputError('warp: found direction "material", expected "resample" (supple.invert)',
                         field="warp")
    if not re.fullmatch("[A-Z0-9_ ]{1,16}", label):
        raise InputError(f"label: found {label!r}, expected capitals, digits and _, 16 at most",
                         field="label")
    of_fixed = _open(fixed)
    of_moving = _open(moving) if moving is not None else of_fixed
    now = datetime.datetime.now()
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = _CLASS
    meta.MediaStorageSOPInstanceUID = generate_uid()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    out = FileDataset(os.fspath(path), {}, file_meta=meta, preamble=b"\0" * 128)
    out.is_little_endian, out.is_implicit_VR = True, False
    for name in _PATIENT + _STUDY:
        setattr(out, name, of_fixed.get(name, ""))
    out.SOPClassUID, out.SOPInstanceUID = _CLASS, meta.MediaStorageSOPInstanceUID
    out.SpecificCharacterSet = of_fixed.get("SpecificCharacterSet", "ISO_IR 192")
    out.Modality, out.SeriesInstanceUID, out.SeriesNumber = "REG", generate_uid(), 1
    out.Laterality = ""
    out.SeriesDate = out.ContentDate = now.strftime("%Y%m%d")
    out.SeriesTime = out.ContentTime = now.strftime("%H%M%S")
    out.FrameOfReferenceUID = _frame_of(of_fixed, fixed, "fixed")
    out.PositionReferenceIndicator = of_fixed.get("PositionReferenceIndicator", "")
    out.Manufacturer = out.ManufacturerModelName = "Supple"
    out.DeviceSerialNumber, out.SoftwareVersions = "0", _supple.version
    out.InstanceNumber, out.ContentLabel = 1, label
    out.ContentDescription, out.ContentCreatorName = description, ""
    item = Dataset()
    item.SourceFrameOfReferenceUID = _frame_of(of_moving, moving or fixed, "moving")
    item.RegistrationTypeCodeSequence = Items()
    item.PreDeformationMatrixRegistrationSequence = _matrix("RIGID", np.eye(4))
    item.PostDeformationMatrixRegistrationSequence = _matrix("RIGID", np.eye(4))
    item.DeformableRegistrationGridSequence = Items([_grid_item(warp)])
    out.DeformableRegistrationSequence = Items([item])
    part = os.fspath(path) + ".part"
    try:
        out.save_as(part, write_like_original=False)
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)


def _with_grid(path: _Path) -> List[Dataset]:
    about = _open(path)
    if about.get("SOPClassUID") != _CLASS:
        raise InputError(f"{path}: SOPClassUID: found {about.get('SOPClassUID')}, expected "
                         f"{_CLASS}, deformable spatial registration", str(path), "SOPClassUID")
    items = [item for item in about.DeformableRegistrationSequence
             if item.get("DeformableRegistrationGridSequence")]
    return items


def frames(path: _Path) -> List[str]:
    """The source frames of reference of the object at a path, one for each registration in it that
    has a grid. Raises InputError for another object."""
    return [str(item.SourceFrameOfReferenceUID) for item in _with_grid(path)]


def read(path: _Path, number: int = 0) -> Warp:
    """A registration of the object at a path as a warp of resample direction on its own grid, with
    the matrices before and after it.

    number: which one, from 0. Raises InputError for another object, a grid whose length is wrong,
    and vectors that are not finite.
    """
    items = _with_grid(path)
    if not 0 <= number < len(items):
        raise InputError(f"{path}: number: found {number}, expected 0 to {len(items) - 1}",
                         str(path), "number")
    item = items[number]
    grid = item.DeformableRegistrationGridSequence[0]
    count = [int(value) for value in grid.GridDimensions]
    vectors = np.frombuffer(grid.VectorGridData, "<f4")
    if vectors.size != 3 * count[0] * count[1] * count[2]:
        raise InputError(f"{path}: VectorGridData: found {vectors.size} numbers, expected three "
                         f"for each of {count[0]} x {count[1]} x {count[2]}", str(path),
                         "VectorGridData")
    if not np.isfinite(vectors).all():
        raise InputError(f"{path}: VectorGridData: found undefined vectors, expected finite ones",
                         str(path), "VectorGridData")
    vectors = vectors.reshape(count[2], count[1], count[0], 3)
    row, column = np.reshape(np.asarray(grid.ImageOrientationPatient, float), (2, 3))
    affine = np.eye(4)
    affine[:3, :3] = np.stack([row, column, np.cross(row, column)], 1) * np.asarray(
        grid.GridResolution, float)
    affine[:3, 3] = np.asarray(grid.ImagePositionPatient, float)
    before, after = (np.asarray(item[name][0].FrameOfReferenceTransformationMatrix, float)
                     .reshape(4, 4) if item.get(name) else np.eye(4)
                     for name in ("PreDeformationMatrixRegistrationSequence",
                                  "PostDeformationMatrixRegistrationSequence"))
    if not (np.array_equal(before, np.eye(4)) and np.array_equal(after, np.eye(4))):
        k, j, i = np.indices(count[::-1])
        places = np.stack([i, j, k], -1) @ affine[:3, :3].T + affine[:3, 3]
        there = places @ before[:3, :3].T + before[:3, 3] + vectors
        vectors = (there @ after[:3, :3].T + after[:3, 3] - places).astype(np.float32)
    return Warp.from_array(vectors, affine, direction="resample")
