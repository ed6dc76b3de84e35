"""TIFF stacks written by tifffile and libtiff's tiffcp, read by tifffile."""
import os
import subprocess
import xml.etree.ElementTree as ElementTree

import numpy as np

from common import Case, has_module, program, reading
from factors import TYPES, choose, values_of

DIMS = (20, 18, 3)  # more than one tile of 16 x 16
FACTORS = {
    "type": TYPES,
    "order": ["little", "big"],
    "compression": ["none", "zlib", "lzw", "lzw_predictor"],
    "place": ["strip", "strips", "tiles"],
    "version": ["classic", "big"],
    "flavour": ["plain", "centimetre", "inch", "imagej", "ome", "shaped"],
    "axes": ["scalar", "time", "channels"],
}
IMAGEJ_TYPES = ["uint8", "uint16", "float32"]
SPACING = (0.75, 1.25, 2.5)  # mm along i, j, k
OME_UNITS = {"µm": 0.001, "mm": 1.0}


def missing():
    if not has_module("tifffile"):
        return "python3-tifffile"
    return None if program("tiffcp") else "libtiff-tools"


def allowed(row):
    if row["flavour"] == "imagej" and (row["type"] not in IMAGEJ_TYPES or row["version"] == "big"):
        return False
    if row["flavour"] == "ome" and row["type"] in ("int64", "uint64"):
        return False  # OME knows none
    if row["compression"] == "lzw_predictor" and row["type"] in ("float32", "float64"):
        return False  # libtiff's horizontal predictor is for integers
    # The others know pages only; the shape noted by tifffile says no channels.
    return {"scalar": True, "time": row["flavour"] in ("imagej", "ome", "shaped"),
            "channels": row["flavour"] in ("imagej", "ome")}[row["axes"]]


def metadata_of(row):
    """Arguments of tifffile.imwrite that say the voxel size."""
    x, y, z = SPACING
    axes = {"scalar": "ZYX", "time": "TZYX", "channels": "ZCYX"}[row["axes"]]
    if row["flavour"] == "imagej":
        return {"imagej": True, "resolution": (1 / x, 1 / y),
                "metadata": {"axes": axes, "spacing": z, "unit": "mm"}}
    if row["flavour"] == "ome":
        return {"ome": True, "metadata": {
            "axes": axes, "PhysicalSizeX": x * 1000, "PhysicalSizeXUnit": "µm",
            "PhysicalSizeY": y, "PhysicalSizeYUnit": "mm",
            "PhysicalSizeZ": z * 1000, "PhysicalSizeZUnit": "µm"}}
    if row["flavour"] == "shaped":
        return {}
    if row["flavour"] == "plain":
        return {"metadata": None}
    unit, mm = {"centimetre": ("CENTIMETER", 10), "inch": ("INCH", 25.4)}[row["flavour"]]
    return {"metadata": None, "resolution": (mm / x, mm / y), "resolutionunit": unit}


def write(stem, row, pages):
    import tifffile

    arguments = metadata_of(row)
    if row["compression"] == "zlib":
        arguments["compression"] = "zlib"
    if row["place"] == "strips":
        arguments["rowsperstrip"] = 5
    if row["place"] == "tiles":
        arguments["tile"] = (16, 16)
    path = f"{stem}{'.ome' if row['flavour'] == 'ome' else ''}.tif"
    order = {"little": "<", "big": ">"}[row["order"]]
    tifffile.imwrite(path, pages, bigtiff=row["version"] == "big", byteorder=order,
                     photometric="minisblack", **arguments)
    return compress_by_libtiff(path, row) if row["compression"].startswith("lzw") else path


def compress_by_libtiff(path, row):
    codec = "lzw:2" if row["compression"] == "lzw_predictor" else "lzw"
    flags = ["-c", codec, "-B" if row["order"] == "big" else "-L"]
    if row["version"] == "big":
        flags.append("-8")
    packed = path.replace(".tif", "_lzw.tif")
    subprocess.run([program("tiffcp"), *flags, path, packed], check=True, capture_output=True)
    return packed


def spacing_of(file):
    """Spacing in mm along i, j, k as the file's own conventions say it, 1 where nothing does."""
    tags = file.pages[0].tags
    x, y = (tags[name].value[1] / tags[name].value[0] if name in tags else 1.0
            for name in ("XResolution", "YResolution"))
    if file.is_imagej:
        mm = {"mm": 1.0}[file.imagej_metadata["unit"]]
        return x * mm, y * mm, file.imagej_metadata["spacing"] * mm
    if file.is_ome:
        pixels = next(node for node in ElementTree.fromstring(file.ome_metadata).iter()
                      if node.tag.endswith("}Pixels"))
        return tuple(float(pixels.get(f"PhysicalSize{a}")) *
                     OME_UNITS[pixels.get(f"PhysicalSize{a}Unit")] for a in "XYZ")
    mm = {1: None, 2: 25.4, 3: 10.0}[int(tags["ResolutionUnit"].value)]
    return (x * mm, y * mm, 1.0) if mm else (1.0, 1.0, 1.0)


def read_by_tifffile(path, frame=None, channel=None):
    """Tifffile knows no LZW without further packages: libtiff unpacks it."""
    import tifffile

    plain = path
    if "_lzw" in path:
        plain = path.replace("_lzw", "_plain")
        subprocess.run([program("tiffcp"), "-c", "none", path, plain], check=True,
                       capture_output=True)
    with tifffile.TiffFile(plain) as file:
        values = file.asarray()
        spacing = spacing_of(file)
    if frame is not None:
        values = values[frame]
    if channel is not None:
        values = values[:, channel]
    return reading(values.transpose(2, 1, 0), np.diag([*spacing, 1.0]))


def cases(folder):
    x, y, z = SPACING
    spacings = {"imagej": SPACING, "ome": SPACING, "centimetre": (x, y, 1), "inch": (x, y, 1)}
    for n, row in enumerate(choose(FACTORS, ("type", "compression", "order"), allowed)):
        shape = {"scalar": DIMS[::-1], "time": (2, *DIMS[::-1]),
                 "channels": (DIMS[2], 2, DIMS[1], DIMS[0])}[row["axes"]]
        values = chosen = values_of(row["type"], shape, n)
        options, picked = [], {}
        if row["axes"] == "time":
            options, picked, chosen = ["--frame", "1"], {"frame": 1}, values[1]
        if row["axes"] == "channels":
            options, picked, chosen = ["--channel", "1"], {"channel": 1}, values[:, 1]
        path = write(os.path.join(folder, f"t{n:03d}"), row, values)
        affine = np.diag([*spacings.get(row["flavour"], (1, 1, 1)), 1.0])
        yield Case(path, [("intent", lambda c=chosen, a=affine: reading(c.transpose(2, 1, 0), a)),
                          ("tifffile", lambda p=path, k=picked: read_by_tifffile(p, **k))], options,
                   tolerance=1e-6,  # resolutions are fractions of 32-bit integers
                   name=f"{os.path.basename(path)} {' '.join(row.values())}")
