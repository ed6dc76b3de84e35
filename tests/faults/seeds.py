"""Small sound files of every format, most of them written byte by byte."""
import bz2
import gzip
import os
import struct
import zlib

from program import run

DIMS = (8, 6, 5)
VALUES = struct.pack("<240h", *((37 * n) % 1000 - 300 for n in range(240)))
VECTORS = struct.pack("<720f", *(0.01 * (n % 50) - 0.25 for n in range(720)))


class Seed:
    """A sound input: its files, the argument that names it and what else the program needs."""

    def __init__(self, name, files, main=None, options=(), cut_ends=()):
        self.name = name
        self.files = files  # {name: bytes}
        self.main = main or next(iter(files))
        self.options = list(options)
        self.cut_ends = set(cut_ends)  # files whose beginnings can be whole files, too

    def write(self, folder, changed=None):
        for name, data in {**self.files, **(changed or {})}.items():
            path = os.path.join(folder, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "wb") as file:
                file.write(data)

    def remove(self, folder):
        for name in self.files:
            os.remove(os.path.join(folder, name))
            parent = os.path.dirname(name)
            if parent and not os.listdir(os.path.join(folder, parent)):
                os.rmdir(os.path.join(folder, parent))


def nrrd(encoding, data=None, extra=""):
    text = ("NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\n"
            "sizes: 8 6 5\nspace directions: (1,0,0) (0,1,0) (0,0,2)\nspace origin: (1,2,3)\n"
            "endian: little\nencoding: %s\n%s" % (encoding, extra))
    return text.encode() + (b"" if data is None else b"\n" + data)


def warp_nrrd():
    return (b"NRRD0004\ntype: float\ndimension: 4\nspace: left-posterior-superior\n"
            b"sizes: 3 8 6 5\nkinds: vector domain domain domain\n"
            b"space directions: none (1,0,0) (0,1,0) (0,0,2)\nspace origin: (1,2,3)\n"
            b"endian: little\nencoding: raw\nsupple direction:=resample\n\n" + VECTORS)


def metaimage(data_file, data=b""):
    return (b"ObjectType = Image\nNDims = 3\nDimSize = 8 6 5\nElementSpacing = 1 1 2\n"
            b"ElementType = MET_SHORT\nElementByteOrderMSB = False\nElementDataFile = " +
            data_file + b"\n" + data)


def numbers(values):
    return " ".join("%g" % value for value in values)


def itk_text():
    """A displacement field on 8 x 6 x 5 points."""
    vectors = struct.unpack("<720f", VECTORS)
    return ("#Insight Transform File V1.0\n#Transform 0\n"
            "Transform: DisplacementFieldTransform_double_3_3\nParameters: " + numbers(vectors) +
            "\nFixedParameters: 8 6 5 1 2 3 1 1 2 1 0 0 0 1 0 0 0 1\n").encode()


def elastix_text():
    """A B-spline of order 3 whose coefficients come last."""
    return ("(Transform \"BSplineTransform\")\n(FixedImageDimension 3)\n(MovingImageDimension 3)\n"
            "(Size 8 6 5)\n(Index 0 0 0)\n(Spacing 1 1 2)\n(Origin 1 2 3)\n"
            "(Direction 1 0 0 0 1 0 0 0 1)\n(GridSize 8 6 5)\n(GridIndex 0 0 0)\n"
            "(GridSpacing 2 2 4)\n(GridOrigin -3 -2 -1)\n(GridDirection 1 0 0 0 1 0 0 0 1)\n"
            "(TransformParameters " + numbers(struct.unpack("<720f", VECTORS)) + ")\n").encode()


def nifti(magic=b"n+1\0", vox_offset=352.0):
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *DIMS, 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 4, 16)
    struct.pack_into("<8f", header, 76, 1, 1, 1, 2, 0, 0, 0, 0)
    struct.pack_into("<f", header, 108, vox_offset)
    struct.pack_into("<f", header, 112, 1.0)
    header[123] = 2
    header[344:348] = magic
    return bytes(header)


def nifti2():
    header = bytearray(544)
    struct.pack_into("<i8s", header, 0, 540, b"n+2\0\r\n\x1a\n")
    struct.pack_into("<hh8q", header, 12, 4, 16, 3, *DIMS, 1, 1, 1, 1)
    struct.pack_into("<8d", header, 104, 1, 1, 1, 2, 0, 0, 0, 0)
    struct.pack_into("<qd", header, 168, 544, 1.0)
    return bytes(header)


def png(width, height, rows):
    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data +
                struct.pack(">I", zlib.crc32(kind + data)))
    lines = b"".join(b"\0" + rows[n * width:(n + 1) * width] for n in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


def tiff(big=False, pages=5, next_of_last=0, sizes=None):
    """Pages of 8 x 6 int16; `sizes` gives pages other sizes, `next_of_last` makes a loop."""
    data = bytearray(b"II" + (struct.pack("<HHHQ", 43, 8, 0, 16) if big else
                              struct.pack("<HI", 42, 8)))
    entry, count, link = ("<HHQQ", "<Q", "<Q") if big else ("<HHII", "<H", "<I")
    for page in range(pages):
        width, height = (sizes or {}).get(page, DIMS[:2])
        tags = [(256, 4, width), (257, 4, height), (258, 3, 16), (259, 3, 1), (262, 3, 1),
                (273, 4, 0), (277, 3, 1), (278, 4, height), (279, 4, 2 * width * height),
                (339, 3, 2)]
        size = struct.calcsize(count) + len(tags) * struct.calcsize(entry) + struct.calcsize(link)
        values_at = len(data) + size
        data += struct.pack(count, len(tags))
        for tag, kind, value in tags:
            data += struct.pack(entry, tag, kind, 1, values_at if tag == 273 else value)
        following = values_at + 2 * width * height
        data += struct.pack(link, following if page + 1 < pages else next_of_last)
        data += (VALUES * 4)[96 * page:96 * page + 2 * width * height]
    return bytes(data)


def dicom(slice_number):
    def element(group, number, kind, value):
        value += (b"\0" if kind in (b"UI", b"OB", b"OW") else b" ") * (len(value) % 2)
        long = kind in (b"OB", b"OW")
        return (struct.pack("<HH", group, number) + kind +
                (struct.pack("<xxI", len(value)) if long else struct.pack("<H", len(value))) + value)

    def short(value):
        return struct.pack("<H", value)

    meta = (element(2, 1, b"OB", b"\0\1") + element(2, 2, b"UI", b"1.2.840.10008.5.1.4.1.1.2") +
            element(2, 3, b"UI", b"1.2.3.%d" % slice_number) +
            element(2, 0x10, b"UI", b"1.2.840.10008.1.2.1"))
    body = (element(8, 0x16, b"UI", b"1.2.840.10008.5.1.4.1.1.2") +
            element(8, 0x18, b"UI", b"1.2.3.%d" % slice_number) + element(8, 0x60, b"CS", b"CT") +
            element(0x20, 0xd, b"UI", b"1.2.3") + element(0x20, 0xe, b"UI", b"1.2.4") +
            element(0x20, 0x13, b"IS", b"%d" % slice_number) +
            element(0x20, 0x32, b"DS", b"0\\0\\%d" % (2 * slice_number)) +
            element(0x20, 0x37, b"DS", b"1\\0\\0\\0\\1\\0") +
            element(0x28, 2, b"US", short(1)) + element(0x28, 4, b"CS", b"MONOCHROME2") +
            element(0x28, 0x10, b"US", short(6)) + element(0x28, 0x11, b"US", short(8)) +
            element(0x28, 0x30, b"DS", b"1\\1") + element(0x28, 0x100, b"US", short(16)) +
            element(0x28, 0x101, b"US", short(16)) + element(0x28, 0x102, b"US", short(15)) +
            element(0x28, 0x103, b"US", short(1)) +
            element(0x7fe0, 0x10, b"OW", VALUES[96 * slice_number:96 * slice_number + 96]))
    return (bytes(128) + b"DICM" + element(2, 0, b"UL", struct.pack("<I", len(meta))) + meta + body)


def gipl():
    head = struct.pack(">4HH4f", 8, 6, 5, 1, 15, 1, 1, 2, 1).ljust(204, b"\0")
    return head + struct.pack(">4d4fI", 0, 0, 0, 0, 0, 0, 0, 0, 719555000)


def big_endian(values):
    return struct.pack(">%dh" % (len(values) // 2), *struct.unpack("<%dh" % (len(values) // 2), values))


def by_supple(folder, arguments, output):
    """A file that the program itself writes."""
    source = Seed("source", {"seed.nrrd": nrrd("raw", VALUES), "seed_warp.nrrd": warp_nrrd()})
    source.write(folder)
    outcome = run([*arguments, output], cwd=folder)
    assert outcome.code == 0, (arguments, outcome.err)
    source.remove(folder)
    path = os.path.join(folder, output)
    with open(path, "rb") as file:
        data = file.read()
    os.remove(path)
    return data


def volumes(folder):
    """One seed per container and encoding, all of the same values."""
    return [
        Seed("nrrd raw", {"a.nrrd": nrrd("raw", VALUES)}),
        Seed("nrrd gzip", {"b.nrrd": nrrd("gzip", gzip.compress(VALUES))}),
        Seed("nrrd bzip2", {"c.nrrd": nrrd("bzip2", bz2.compress(VALUES))}),
        Seed("nrrd ascii", {"d.nrrd": nrrd("ascii", text_of(VALUES))}),
        Seed("nrrd hex", {"e.nrrd": nrrd("hex", VALUES.hex().encode())}),
        Seed("nrrd detached", {"f.nhdr": nrrd("raw", None, "data file: f.raw\n"),
                               "f.raw": VALUES}),
        Seed("metaimage", {"g.mha": metaimage(b"LOCAL", VALUES)}),
        Seed("metaimage detached", {"h.mhd": metaimage(b"h.raw"), "h.raw": VALUES}),
        Seed("nifti", {"i.nii": nifti() + VALUES}),
        Seed("nifti gzip", {"j.nii.gz": gzip.compress(nifti() + VALUES)}),
        Seed("nifti pair", {"k.hdr": nifti(b"ni1\0", 0.0)[:348], "k.img": VALUES}),
        Seed("nifti 2", {"l.nii": nifti2() + VALUES}),
        Seed("gipl", {"l.gipl": gipl() + big_endian(VALUES)}),
        Seed("tiff", {"m.tif": tiff()}),
        Seed("bigtiff", {"n.tif": tiff(big=True)}),
        Seed("png", {"o.png": png(20, 12, VALUES[:240])}),
        Seed("png series", {"p/%d.png" % n: png(20, 12, VALUES[:240]) for n in range(3)},
             main="p"),
        Seed("raw", {"q.raw": VALUES},
             options=["--raw", "dims=8,6,5,type=int16,spacing=1,1,2"]),
        Seed("dicom file", {"r.dcm": dicom(0)}),
        Seed("dicom folder", {"s/%d.dcm" % n: dicom(n) for n in range(4)}, main="s"),
        Seed("hdf5", {"t.h5": by_supple(folder, ["convert", "seed.nrrd"], "t.h5")}),
        Seed("vdb", {"u.vdb": by_supple(folder, ["convert", "seed.nrrd"], "u.vdb")}),
        Seed("warp nrrd", {"v.nrrd": warp_nrrd()}),
        Seed("itk transform", {"w.h5": by_supple(folder, ["convert", "seed_warp.nrrd"], "w.h5")}),
        Seed("itk text transform", {"x.tfm": itk_text()}),
        Seed("elastix transform", {"y.txt": elastix_text()}),
        Seed("nrrd segmentation", {"z.seg.nrrd": nrrd("raw", VALUES, "Segment0_Name:=skull\n"
                                                      "Segment0_LabelValue:=3\n")}),
    ]


def text_of(values):
    numbers = struct.unpack("<%dh" % (len(values) // 2), values)
    return " ".join(map(str, numbers)).encode() + b"\n"
