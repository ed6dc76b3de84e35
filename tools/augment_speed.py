#!/usr/bin/env python3
"""Random samples of supple.augment beside elastic fields of scipy and torch, as a table of Markdown
(docs/benchmarks/augment.md).

    PYTHONPATH=build/release/python /usr/bin/python3 tools/augment_speed.py VOLUME
        [--material ct-head] [--spacing MM] [--count N]

A sample is image, labels (bone and soft tissue), warp and inverse where there is one; making the
field counts. Peers have a field of splines through 7 control points along each axis, each up to
7.5 mm, as the elastic transforms of TorchIO and MONAI have, and no inverse. Then, without the
clock: cells that fold, the least det F, and how far bone (300 and more, joined by faces) is from
the rigid motion of its piece. Times are medians; the mean stands beside.
"""
import argparse
import os
import time

import numpy as np
from scipy import ndimage

import supple

CONTROL_POINTS, CONTROL_MM = 7, 7.5


def elastic_field(shape, spacing, random):
    """Offsets in voxels, [3, k, j, i], of cubic splines with borders at rest."""
    coarse = random.uniform(-CONTROL_MM, CONTROL_MM, (3,) + (CONTROL_POINTS,) * 3)
    for axis in (1, 2, 3):
        coarse[(slice(None),) * axis + ([0, -1],)] = 0
    factors = [n / CONTROL_POINTS for n in shape]
    return np.stack([ndimage.zoom(c, factors, order=3, mode="nearest", grid_mode=True) / mm
                     for c, mm in zip(coarse, spacing[::-1])]).astype(np.float32)


def by_scipy(image, labels, spacing, random):
    field = elastic_field(image.shape, spacing, random)
    at = np.indices(image.shape, dtype=np.float32) + field
    return (ndimage.map_coordinates(image, at, order=1, mode="nearest"),
            ndimage.map_coordinates(labels, at, order=0, mode="nearest"), field)


def by_torch(image, labels, spacing, random):
    import torch
    drawn = random.uniform(-CONTROL_MM, CONTROL_MM, (1, 3) + (CONTROL_POINTS,) * 3)
    coarse = torch.from_numpy(drawn)
    coarse[:, :, [0, -1]] = coarse[:, :, :, [0, -1]] = coarse[..., [0, -1]] = 0
    mm = torch.nn.functional.interpolate(coarse, image.shape, mode="trilinear", align_corners=True)
    field = mm[0] / torch.tensor(spacing[::-1]).reshape(3, 1, 1, 1)
    sizes = torch.tensor(image.shape).reshape(3, 1, 1, 1)
    at = torch.stack(torch.meshgrid(*map(torch.arange, image.shape), indexing="ij")) + field
    grid = (2 * at / (sizes - 1) - 1).flip(0).permute(1, 2, 3, 0)[None].float()
    def sampled(values, mode):
        values = torch.from_numpy(values)[None, None].float()
        return torch.nn.functional.grid_sample(values, grid, mode, align_corners=True)
    return (sampled(image, "bilinear"), sampled(labels, "nearest"),
            field.numpy().astype(np.float32))


def bone_residual(bones, shift):
    """Largest distance of a bone's voxels from its rigid motion; `shift`: [k, j, i, 3], voxels."""
    pieces, count = ndimage.label(bones)
    worst = 0.0
    for piece, box in enumerate(ndimage.find_objects(pieces), 1):
        at = np.argwhere(pieces[box] == piece)[:, ::-1].astype(float)
        if len(at) < 30:
            continue
        to = at + shift[box][pieces[box] == piece]
        a, b = at - at.mean(0), to - to.mean(0)
        u, _, vt = np.linalg.svd(a.T @ b)
        turn = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
        worst = max(worst, np.abs(a @ turn - b).max())
    return worst


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("volume")
    parser.add_argument("--material", default="ct-head")
    parser.add_argument("--spacing", type=float, default=0)
    parser.add_argument("--count", type=int, default=12)
    args = parser.parse_args()
    volume = supple.open(args.volume)
    if args.spacing:
        volume = supple.resample(volume, spacing=(args.spacing,) * 3)
    image, spacing = volume.array, volume.spacing
    labels = ((image > -300).astype(np.uint8) + (image >= 300)).astype(np.uint8)
    to_voxels = np.linalg.inv(volume.affine[:3, :3]).T
    case = {"image": image, "labels": labels, "affine": volume.affine}
    drag, joint = (kind(args.material, seed=7) for kind in (
        supple.augment.RandomDrag, supple.augment.RandomJointMotion))

    def of_warp(sample):
        det = sample["truth"].certificate
        return (det.folded_cells - det.folded_air_cells, det.min_det,
                bone_residual(labels == 2, np.asarray(sample["inverse"]) @ to_voxels))

    def of_field(sample):
        field = sample[2].transpose(1, 2, 3, 0)[..., ::-1]
        warp = supple.Warp(field @ volume.affine[:3, :3].T, volume.grid, direction="resample")
        summary = supple.metrics(warp, maps=False).summary
        return (summary["folded_cells"], summary["min_jacobian"], bone_residual(labels == 2, field))

    rows = [("`RandomDrag`", lambda n: drag(case, number=n), of_warp),
            ("`RandomJointMotion`", lambda n: joint(case, number=n), of_warp),
            ("`scipy.ndimage.map_coordinates`", lambda n: by_scipy(
                image, labels, spacing, np.random.default_rng(n)), of_field)]
    try:
        import torch
        rows.append((f"`grid_sample` of torch {torch.__version__}", lambda n: by_torch(
            image, labels, spacing, np.random.default_rng(n)), of_field))
    except ImportError:
        print("torch is not installed")
    size = " × ".join(map(str, image.shape[::-1]))
    print(f"| samples of {size} voxels | processor s | elapsed s | folded cells | least det F "
          "| bone off by, voxels |\n|---|---|---|---|---|---|", flush=True)
    for name, make, judge in rows:
        make(0)
        used, elapsed, judged = [], [], []
        for number in range(1, args.count + 1):
            begin = time.process_time(), time.monotonic()
            sample = make(number)
            used.append(time.process_time() - begin[0])
            elapsed.append(time.monotonic() - begin[1])
            judged.append(judge(sample))
        folded, det, off = (np.array(column) for column in zip(*judged))
        print(f"| {name} | {np.median(used):.2f} ({np.mean(used):.2f}) "
              f"| {np.median(elapsed):.2f} ({np.mean(elapsed):.2f}) "
              f"| {folded.sum()} | {det.min():.3f} | {off.max():.2g} |", flush=True)


if __name__ == "__main__":
    main()
