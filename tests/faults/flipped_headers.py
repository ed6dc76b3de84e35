"""One bit flipped in every byte of every header: the file reads, or is refused with one line.

Headers of more than MOST_FLIPS bytes are flipped at evenly spread places; with --all everywhere.
"""
import concurrent.futures
import os
import random
import resource
import sys

from program import BAD_INPUT, SYSTEM, Policy
import seeds
from seeds import Seed, VALUES, VECTORS

MOST_FLIPS = 12
MOST_FILES = 20  # of one start
MOST_OUTPUT_BYTES = 64 << 20  # a flipped size must not fill the disk
A_FILE_IT_NAMES = "found no such file"  # a flipped name of a data file, which the line says
SEALED = {"vdb", "state"}  # a digest covers every byte


def header_places(data):
    """Places that hold no values; compressed and text values count as header."""
    is_value = bytearray(len(data))
    whole = [VALUES, VECTORS]
    slices = [VALUES[n:n + 96] for n in range(0, len(VALUES), 96)]
    for values in whole + slices:
        at = data.find(values)
        if at >= 0:
            is_value[at:at + len(values)] = b"\1" * len(values)
    return [n for n in range(len(data)) if not is_value[n]]


def chosen(places, everywhere):
    if everywhere or len(places) <= MOST_FLIPS:
        return places
    return [places[n * len(places) // MOST_FLIPS] for n in range(MOST_FLIPS)]


def flips(seed, everywhere):
    """(label, {file: damaged bytes}) of one seed, the same at every run."""
    dice = random.Random(seed.name)
    files = sorted(seed.files)
    name = seed.main if seed.main in seed.files else files[len(files) // 2]
    data = seed.files[name]
    for place in chosen(header_places(data), everywhere):
        bit = dice.randrange(8)
        damaged = bytearray(data)
        damaged[place] ^= 1 << bit
        yield "%s, bit %d of byte %d" % (seed.name, bit, place), {name: bytes(damaged)}


def try_flips(seed, everywhere):
    """In a folder of its own, so that seeds can be tried side by side, and each copy in one of its
    own, so that many are read in one start. The first is converted, too, so that a header that
    is read or refused leaves no partial output."""
    policy = Policy()
    codes = [BAD_INPUT] if seed.name in SEALED else [0, BAD_INPUT, SYSTEM]
    copies = []
    for n, (label, damaged) in enumerate(flips(seed, everywhere)):
        folder = "flip_%d" % n
        seed.write(policy.path(folder), damaged)
        copies.append((label, os.path.join(folder, seed.main), codes,
                       [*seed.files, seed.main, A_FILE_IT_NAMES]))
    for n in range(0, len(copies), MOST_FILES):
        policy.expect_each(seed.name, copies[n:n + MOST_FILES], seed.options)
    for label, path, codes, names in copies[:1]:  # none of files that have no header
        policy.expect(label + ", converted", ["convert", path, "out.nrrd", "--quiet", *seed.options],
                      codes, [*names, "out.nrrd"], ["out.nrrd"])
    print("%-20s %4d flips, %4d refused, %.0f MB" %
          (seed.name, policy.runs, policy.refused, policy.peak_mb), flush=True)
    return policy


def main():
    everywhere = "--all" in sys.argv
    resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_OUTPUT_BYTES, MOST_OUTPUT_BYTES))
    total = Policy()
    tried = seeds.volumes(total.folder)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for policy in pool.map(lambda seed: try_flips(seed, everywhere), tried):
            total.add(policy)
    total.finish()


main()
