#!/usr/bin/env python3
"""Parts of the brain of mricron-data as one label volume on the grid of ch2 (docs/studies/craniotomy.md).

  brain_labels.py TEMPLATES ENVELOPE OUT.nii.gz     needs numpy and nibabel (Debian: python3-nibabel)

TEMPLATES is the folder of ch2.nii.gz, aal.nii.gz and jhu189.nii.gz, ENVELOPE the
mask on the grid of ch2 whose voxels get labels. Cortex and
cerebellum are those of aal, what crosses the midline and the ventricles those of jhu189, whose grid is another. Every voxel of
the envelope has the label of the nearest voxel with one, by steps along the axes.
"""
import sys

import nibabel
import numpy

LEFT, RIGHT, CEREBELLUM, CORE, VENTRICLES, TEMPORAL, BANK = 1, 2, 3, 4, 5, 6, 7
NAMES = ["left", "right", "cerebellum", "core", "ventricles", "temporal_lobe", "sylvian_bank"]
# of aal, left: temporal lobe without its inner side; what lies against it across the Sylvian fissure
OF_TEMPORAL = [79, 81, 83, 85, 87, 89]
OF_BANK = [11, 13, 15, 17, 29]
# of jhu189: callosum, thalami, hypothalamus, midbrain, pons, medulla and peduncles
OF_CORE = [*range(83, 87), *range(91, 95), *range(97, 117), *range(123, 129)]
OF_VENTRICLES = [*range(171, 182)]


def on_grid(image, grid):
    """Labels of an image at the voxels of a grid, of the nearest voxel; 0 outside."""
    labels = numpy.asarray(image.dataobj).astype(numpy.int16)
    to_image = numpy.linalg.inv(image.affine) @ grid.affine
    places = numpy.indices(grid.shape).reshape(3, -1)
    index = numpy.rint(to_image[:3, :3] @ places + to_image[:3, 3:]).astype(int)
    inside = ((index >= 0) & (index < numpy.array(labels.shape)[:, None])).all(axis=0)
    out = numpy.zeros(places.shape[1], numpy.int16)
    out[inside] = labels[tuple(index[:, inside])]
    return out.reshape(grid.shape)


def spread(labels, mask):
    """Extends labels into the mask, a voxel a round; of several neighbours the lowest label wins."""
    while True:
        empty = mask & (labels == 0)
        if not empty.any():
            return labels
        found = numpy.full(labels.shape, 99, numpy.int16)
        for axis in range(3):
            for step in (1, -1):
                near = numpy.roll(labels, step, axis)
                edge = [slice(None)] * 3
                edge[axis] = 0 if step == 1 else -1
                near[tuple(edge)] = 0
                found = numpy.where((near > 0) & (near < found), near, found)
        reached = empty & (found < 99)
        if not reached.any():
            return labels
        labels = numpy.where(reached, found, labels)


def main(templates, envelope, out):
    grid = nibabel.load(f"{templates}/ch2.nii.gz")
    aal = on_grid(nibabel.load(f"{templates}/aal.nii.gz"), grid)
    jhu = on_grid(nibabel.load(f"{templates}/jhu189.nii.gz"), grid)
    mask_image = nibabel.load(envelope)    # the voxels of ch2, perhaps of another size
    mask = numpy.asarray(mask_image.dataobj) > 0
    if mask.shape != grid.shape:
        sys.exit(f"{envelope}: found {mask.shape} voxels, expected those of ch2, {grid.shape}")
    labels = numpy.where(aal == 0, 0, numpy.where(aal % 2 == 1, LEFT, RIGHT)).astype(numpy.int16)
    labels[aal >= 91] = CEREBELLUM
    labels[numpy.isin(aal, OF_TEMPORAL)] = TEMPORAL
    labels[numpy.isin(aal, OF_BANK)] = BANK
    labels[numpy.isin(jhu, OF_CORE)] = CORE
    labels[numpy.isin(jhu, OF_VENTRICLES)] = VENTRICLES
    labels = spread(numpy.where(mask, labels, 0).astype(numpy.int16), mask)
    image = nibabel.Nifti1Image(labels.astype(numpy.uint8), mask_image.affine)
    nibabel.save(image, out)
    for number, name in enumerate(NAMES, 1):
        print(f"{number} {name} {(labels == number).sum() / 1000:.1f} ml")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
