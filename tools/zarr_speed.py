#!/usr/bin/env python3
"""Stored chunks through a field to stored chunks: speed, memory and decoding of supple.dask.

    PYTHONPATH=build/release/python /usr/bin/python3 tools/zarr_speed.py FOLDER
        [--shape 1024 1088 1088] [--workers 2] [--memory BYTES] [--chunks 64,64,64 128,128,128 ...]

Makes a volume of uint16 from formulas and noise, and a field of resample direction at a quarter of
its resolution with waves of up to 8 voxels, both in chunks that blosc (lz4) compresses, in FOLDER,
and deletes them. Workers are processes of one thread that keep what they free, as
docs/big_arrays.md says; 0: two threads of this process. Seconds of processor time are those of all
workers; peak memory is the sum of theirs. The digest is that of the values that are read back.
"""
import argparse
import hashlib
import os
import shutil
import time

import dask
import numpy as np
import zarr
from numcodecs import Blosc

import supple.dask

LZ4 = Blosc("lz4", clevel=1, shuffle=Blosc.SHUFFLE)
KEEP_FREED = {"distributed.nanny.pre-spawn-environ": {
    "MALLOC_TRIM_THRESHOLD_": 2 ** 30, "MALLOC_MMAP_THRESHOLD_": 2 ** 25, "OMP_NUM_THREADS": 1}}
AFFINE = np.diag([0.5, 0.5, 0.5, 1.0])


def boxes(shape, chunks):
    for lo in np.ndindex(*[-(-n // c) for n, c in zip(shape, chunks)]):
        lo = [a * c for a, c in zip(lo, chunks)]
        yield tuple(slice(a, min(a + c, n)) for a, c, n in zip(lo, chunks, shape))


def made(path, shape, kind, chunks, values):
    shutil.rmtree(path, ignore_errors=True)
    array = zarr.open(zarr.DirectoryStore(path, dimension_separator="/"), mode="w", shape=shape,
                      chunks=chunks, dtype=kind, compressor=LZ4)
    for box in boxes(shape, array.chunks):
        array[box] = values(*np.ogrid[box[:3]])
    return array


def scan(k, j, i):
    shells = 600 * np.sin(0.02 * np.sqrt((k - 400.0) ** 2 + (j - 500.0) ** 2 + (i - 550.0) ** 2))
    noise = (k * 73856093 ^ j * 19349663 ^ i * 83492791) >> 7 & 15
    return (1200 + shells + noise).astype(np.uint16)


def waves(k, j, i):
    mm = [4 * np.sin(0.05 * k + 0.02 * j), 3.5 * np.sin(0.04 * i), 3 * np.cos(0.05 * j + 0.01 * i)]
    return np.stack(np.broadcast_arrays(*mm), -1).astype(np.float32)


def digest(path):
    array, sums = zarr.open(path), hashlib.sha256()
    for k in range(0, array.shape[0], 64):
        sums.update(array[k:k + 64].tobytes())
    return sums.hexdigest()[:12]


def used():
    import supple.dask  # noqa: F401, so that a worker has begun
    import zarr  # noqa: F401
    with open("/proc/self/status", encoding="utf-8") as file:
        peak = next(line for line in file if line.startswith("VmHWM:"))
    return time.process_time(), int(peak.split()[1]) / 1024


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("--shape", type=int, nargs=3, default=[1024, 1088, 1088])
    parser.add_argument("--workers", type=int, nargs="+", default=[2])
    parser.add_argument("--memory", type=float, default=1.6e8)
    parser.add_argument("--chunks", nargs="+", default=["64,64,64", "128,128,128", "256,64,64"])
    args = parser.parse_args()
    voxels = float(np.prod(args.shape))
    nodes = [-(-(n - 1) // 4) + 1 for n in args.shape]
    source, warp, result = (os.path.join(args.folder, name) for name in ("v", "w", "o"))
    field = made(warp, (*nodes, 3), "f4", (64, 64, 64, 3), waves)
    print("| chunks | workers | Mvoxel/s elapsed | Mvoxel/s of two cores by processor time "
          "| reading, warping, writing, ns per voxel | decoded per chunk | MiB of all workers "
          "| digest |\n"
          "|---|---|---|---|---|---|---|---|", flush=True)
    for text in args.chunks:
        chunks = tuple(map(int, text.split(",")))
        volume = made(source, args.shape, "u2", chunks, scan)
        for workers in args.workers:
            shutil.rmtree(result, ignore_errors=True)
            client = None
            if workers:
                dask.config.set(KEEP_FREED)
                from dask.distributed import Client, LocalCluster
                client = Client(LocalCluster(n_workers=workers, threads_per_worker=1,
                                             dashboard_address=None))
            everywhere = (lambda: list(client.run(used).values())) if client else lambda: [used()]
            with dask.config.set(**({} if client else {"num_workers": 2, "scheduler": "threads"})):
                before, begin = everywhere(), time.monotonic()
                array = supple.dask.warp(volume, field, affine=AFFINE,
                                         field_affine=AFFINE @ np.diag([4.0, 4, 4, 1]))
                told = supple.dask.store(array, result, compressor=LZ4, memory=args.memory)
                elapsed, after = time.monotonic() - begin, everywhere()
            if client:
                client.close()
                client.cluster.close()
            seconds = sum(a[0] - b[0] for a, b in zip(after, before))
            parts = ", ".join(f"{1e9 * told[name] / voxels:.1f}"
                              for name in ("reading", "warping", "writing"))
            print(f"| {' × '.join(map(str, chunks))} | {workers or 'threads'} "
                  f"| {voxels / elapsed / 1e6:.0f} | {2 * voxels / seconds / 1e6:.0f} | {parts} "
                  f"| {told['decoded'] / told['chunks']:.2f} | {sum(a[1] for a in after):.0f} "
                  f"| {digest(result)} |", flush=True)
    for path in (source, warp, result):
        shutil.rmtree(path, ignore_errors=True)


if __name__ == "__main__":
    main()
