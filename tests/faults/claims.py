"""Headers that claim what cannot be, files that are not what they seem, and what is no file."""
import bz2
import gzip
import os
import re
import struct
import subprocess
import zlib

from program import BAD_INPUT, Policy
import seeds
from seeds import VALUES, Seed

BOMB_BYTES = 256 << 20
HUGE = ["4000000000 4000000000 4000000000", "2147483647 2147483647 1", "65536 65536 65536",
        "9223372036854775807 2 2", "18446744073709551617 1 1", "-8 6 5", "0 6 5", "8 6 1e9"]
SPACINGS = ["0 1 1", "1e-40 1 1", "1e39 1 1", "-1 1 1", "nan 1 1", "1 inf 1", "1e-320 1 1", "1e400 1 1"]
DIRECTIONS = ["(0,0,0) (0,1,0) (0,0,2)", "(1,0,0) (2,0,0) (0,0,2)", "(1,0,0) (0,1,0) (1,1,0)",
              "(nan,0,0) (0,1,0) (0,0,2)", "(1,0,0) (0,inf,0) (0,0,2)", "(1,0) (0,1) (0,0)"]


def packed(data, offset, layout, *values):
    changed = bytearray(data)
    struct.pack_into(layout, changed, offset, *values)
    return bytes(changed)


def with_tag(data, tag, value):
    """A classic TIFF whose first directory holds another value."""
    at = data.index(struct.pack("<HH", tag, 4))
    return packed(data, at + 8, "<I", value)


def with_png_size(width, height):
    data = seeds.png(20, 12, VALUES[:240])
    head = b"IHDR" + struct.pack(">II", width, height) + data[24:29]
    return data[:12] + head + struct.pack(">I", zlib.crc32(head)) + data[33:]


def impossible_sizes():
    nrrd, mha = seeds.nrrd("raw", VALUES), seeds.metaimage(b"LOCAL", VALUES)
    for sizes in HUGE:
        yield "nrrd " + sizes, "a.nrrd", nrrd.replace(b"8 6 5", sizes.encode())
        yield "mha " + sizes, "a.mha", mha.replace(b"8 6 5", sizes.encode())
        packed_nrrd = seeds.nrrd("gzip", gzip.compress(VALUES)).replace(b"8 6 5", sizes.encode())
        yield "nrrd gzip " + sizes, "b.nrrd", packed_nrrd
    yield "nifti", "a.nii", packed(seeds.nifti() + VALUES, 42, "<3h", 32767, 32767, 32767)
    yield "nifti gzip", "a.nii.gz", gzip.compress(
        packed(seeds.nifti() + VALUES, 42, "<3h", 32767, 32767, 32767))
    yield "nifti 2", "a.nii", packed(seeds.nifti2() + VALUES, 24, "<3q", 1 << 62, 4, 1)
    yield "gipl", "a.gipl", packed(seeds.gipl() + VALUES, 0, ">4H", *[65535] * 4)
    yield "nifti 2 product", "a.nii", packed(seeds.nifti2() + VALUES, 24, "<3q", *[1 << 22] * 3)
    for side in (40000, 1 << 31, (1 << 32) - 1):
        data = with_tag(with_tag(seeds.tiff(pages=1), 256, side), 257, side)
        yield "tiff %d" % side, "a.tif", data
        yield "tiff one strip %d" % side, "a.tif", with_tag(data, 278, side)
        yield "png %d" % side, "a.png", with_png_size(side, side)
    rows = seeds.dicom(0).replace(b"US\2\0\6\0", b"US\2\0\xff\xff")
    yield "dicom", "a.dcm", rows.replace(b"US\2\0\x08\0", b"US\2\0\xff\xff")


def bomb_after_a_volume(policy):
    """What follows the values of a NIfTI file is no concern of its reader, whatever its length."""
    bomb = gzip.compress(seeds.nifti() + VALUES, 1) + gzip.compress(bytes(BOMB_BYTES), 1)
    Seed("bomb", {"a.nii.gz": bomb}).write(policy.folder)
    policy.expect("gzip bomb behind NIfTI", ["info", "a.nii.gz", "--quiet"], [0])
    os.remove(policy.path("a.nii.gz"))


def false_streams():
    """Bombs that say less than they hold, and sums that do not fit."""
    squeeze = zlib.compressobj(1, zlib.DEFLATED, 31)
    bomb = b"".join(squeeze.compress(bytes(1 << 20)) for _ in range(BOMB_BYTES >> 20))
    bomb += squeeze.flush()
    yield "gzip bomb", "a.nrrd", seeds.nrrd("gzip", bomb)
    yield "zlib bomb", "a.mha", seeds.metaimage(b"LOCAL", zlib.compress(bytes(BOMB_BYTES), 1)).replace(
        b"NDims", b"CompressedData = True\nNDims")
    yield "bzip2 bomb", "a.nrrd", seeds.nrrd("bzip2", bz2.compress(bytes(BOMB_BYTES >> 3)))
    for name, head, body in (("a.nrrd", seeds.nrrd("gzip", b""), gzip.compress(VALUES)),
                             ("a.nii.gz", b"", gzip.compress(seeds.nifti() + VALUES))):
        yield "gzip CRC " + name, name, head + packed(body, len(body) - 8, "<I", 1)
        yield "gzip length " + name, name, head + packed(body, len(body) - 4, "<I", 1)
    body = bz2.compress(VALUES)
    yield "bzip2 CRC", "a.nrrd", seeds.nrrd("bzip2", packed(body, 10, "<I", 1))
    png = seeds.png(20, 12, VALUES[:240])
    yield "png CRC", "a.png", packed(png, len(png) - 16, "<I", 1)


def impossible_geometry():
    for text in SPACINGS:
        header = re.sub(rb"space.*\n", b"", seeds.nrrd("raw")) + b"spacings: %s\n" % text.encode()
        yield "spacings " + text, "a.nrrd", header + b"\n" + VALUES
        yield "ElementSpacing " + text, "a.mha", seeds.metaimage(b"LOCAL", VALUES).replace(
            b"1 1 2", text.encode())
    for text in DIRECTIONS:
        yield "directions " + text, "a.nrrd", seeds.nrrd("raw", VALUES).replace(
            b"(1,0,0) (0,1,0) (0,0,2)", text.encode())
    for matrix in ("1 0 0 0 1 0 1 0 0", "0 0 0 0 0 0 0 0 0", "nan 0 0 0 1 0 0 0 1"):
        yield "TransformMatrix " + matrix, "a.mha", seeds.metaimage(b"LOCAL", VALUES).replace(
            b"NDims", b"TransformMatrix = %s\nNDims" % matrix.encode())
    for value in (0.0, float("nan"), float("inf"), -1e38):
        yield "pixdim %g" % value, "a.nii", packed(seeds.nifti() + VALUES, 80, "<f", value)
    yield "sform 0", "a.nii", packed(seeds.nifti() + VALUES, 254, "<h", 1)


def false_files():
    for data_file in ("../a.raw", "/etc/hostname", "x/../../a.raw", "."):
        yield "nhdr to " + data_file, "a.nhdr", seeds.nrrd("raw", None,
                                                           "data file: %s\n" % data_file)
        yield "mhd to " + data_file, "a.mhd", seeds.metaimage(data_file.encode())
    yield "tiff loop", "a.tif", seeds.tiff(next_of_last=8)
    yield "tiff of two sizes", "a.tif", seeds.tiff(sizes={3: (4, 6)})
    for extension in ("nrrd nhdr mha mhd nii nii.gz hdr img tif h5 vdb png dcm xyz stl".split()):
        yield "prose as " + extension, "a." + extension, b"This is no volume but a sentence.\n" * 40
        yield "zeros as " + extension, "b." + extension, bytes(2000)
    yield "gzip of prose", "a.nii.gz", gzip.compress(b"This is no volume." * 100)
    yield "gzip as nrrd", "a.nrrd", gzip.compress(seeds.nrrd("raw", VALUES))


def refuse(policy, cases):
    for label, name, data in cases:
        seed = Seed(label, {name: data})
        seed.write(policy.folder)
        # An .img without its header, and a header that names its own folder.
        names = [name, name.replace(".img", ".hdr"), ": found a directory"]
        policy.expect(label, ["convert", name, "out.nrrd", "--quiet"], [BAD_INPUT], names)
        for left in ("out.nrrd", name):
            if os.path.exists(policy.path(left)):
                os.remove(policy.path(left))


def content_decides(policy):
    """A sound file under the extension of another format is read for what it is."""
    for seed in seeds.volumes(policy.folder):
        if len(seed.files) > 1 or seed.options:
            continue
        wrong = "wrong.nii" if seed.name.startswith("tiff") else "wrong.tif"
        Seed(seed.name, {wrong: seed.files[seed.main]}).write(policy.folder)
        policy.expect(seed.name + " as " + wrong, ["info", wrong, "--quiet"], [0])
        os.remove(policy.path(wrong))


HDF5_LINKS = """
import h5py
with h5py.File("other.h5", "w") as file:
    file["v"] = [[[1.0, 2.0]] * 2] * 2
with h5py.File("link.h5", "w") as file:
    file["v"] = h5py.ExternalLink("other.h5", "/v")
with h5py.File("storage.h5", "w") as file:
    file.create_dataset("v", (2, 2, 2), "f8", external=[("other.h5", 0, 64)])
layout = h5py.VirtualLayout((2, 2, 2), "f8")
layout[:] = h5py.VirtualSource("other.h5", "v", (2, 2, 2))
with h5py.File("virtual.h5", "w") as file:
    file.create_virtual_dataset("v", layout)
"""


def refuse_other_files_of_hdf5(policy):
    made = subprocess.run(["/usr/bin/python3", "-c", HDF5_LINKS], cwd=policy.folder,
                          capture_output=True)
    if made.returncode != 0:
        print("no h5py: links of HDF5 are left to the unit tests")
        return
    policy.expect("the file itself", ["info", "other.h5", "--quiet"], [0])
    for name in ("link.h5", "storage.h5", "virtual.h5"):
        for argument in (name, name + ":/v"):
            policy.expect(argument, ["convert", argument, "out.nrrd", "--quiet"], [BAD_INPUT], [name])


def main():
    policy = Policy()
    for cases in (impossible_sizes(), false_streams(), impossible_geometry(), false_files()):
        refuse(policy, cases)
    bomb_after_a_volume(policy)
    content_decides(policy)
    refuse_other_files_of_hdf5(policy)
    policy.finish()


main()
