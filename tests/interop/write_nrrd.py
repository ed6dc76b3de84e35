"""NRRD files: headers and values written by hand or by teem, read by teem."""
import bz2
import gzip
import os
import subprocess

import numpy as np

from common import Case, program, reading
from factors import DIMS, GRIDS, ORDERS, TYPES, choose, values_of

FACTORS = {
    "type": TYPES,
    "encoding": ["raw", "gzip", "bzip2", "ascii", "hex"],
    "order": ["little", "big"],
    "files": ["attached", "detached", "list", "numbered"],
    "writer": ["hand", "teem"],
    "space": ["left-posterior-superior", "right-anterior-superior", "left-anterior-superior",
              "LPS", "RAS", "LAS", "spacings"],
    "grid": list(GRIDS),
    "axes": ["scalar", "time", "vector"],
}
SIGNS = {"left-posterior-superior": (1, 1, 1), "right-anterior-superior": (-1, -1, 1),
         "left-anterior-superior": (1, -1, 1)}
NAMES = {"lps": "left-posterior-superior", "ras": "right-anterior-superior",
         "las": "left-anterior-superior"}
TEEM_TYPES = {"int8": "signed char", "uint8": "uchar", "int16": "short", "uint16": "ushort",
              "int32": "int", "uint32": "uint", "int64": "longlong", "uint64": "ulonglong",
              "float32": "float", "float64": "double"}


def missing():
    return None if program("teem-unu", "unu") else "teem-apps"


def allowed(row):
    if row["space"] == "spacings" and row["grid"] not in ("unit",):
        return False
    if row["writer"] == "hand":
        return True
    # Teem prints swapped values as text, and writes one data file.
    return row["files"] in ("attached", "detached") and \
        not (row["encoding"] == "ascii" and row["order"] == "big")


def signs_of(space):
    return np.array(SIGNS[NAMES.get(space.lower(), space)])


def geometry_lines(row, affine):
    before, after = {"scalar": ([], []), "time": ([], ["none"]), "vector": (["none"], [])}[row["axes"]]
    if row["space"] == "spacings":
        steps = [repr(float(affine[a, a])) for a in range(3)]
        nan = {True: ["nan"], False: []}
        return [f"spacings: {' '.join(nan[bool(before)] + steps + nan[bool(after)])}"]
    signs = signs_of(row["space"])

    def vector(column):
        return "(" + ",".join(repr(float(x)) for x in column * signs) + ")"

    directions = before + [vector(affine[:3, a]) for a in range(3)] + after
    return [f"space: {row['space']}", f"space directions: {' '.join(directions)}",
            f"space origin: {vector(affine[:3, 3])}"]


def encode(values, row):
    """Bytes of an array in the order of the file."""
    plain = values.astype(values.dtype.newbyteorder(ORDERS[row["order"]])).tobytes(order="F")
    if row["encoding"] == "ascii":
        return "\n".join(str(v) for v in values.ravel(order="F").tolist()).encode() + b"\n"
    if row["encoding"] == "hex":
        text = plain.hex()
        return "\n".join(text[n:n + 70] for n in range(0, len(text), 70)).encode() + b"\n"
    return {"raw": bytes, "gzip": gzip.compress, "bzip2": bz2.compress}[row["encoding"]](plain)


def write_by_hand(stem, row, affine, values):
    head = ["NRRD0005", "# written for a test", f"type: {TEEM_TYPES[row['type']]}",
            f"dimension: {values.ndim}", f"sizes: {' '.join(map(str, values.shape))}"]
    head += geometry_lines(row, affine)
    kinds = {"scalar": ["domain"] * 3, "time": ["domain"] * 3 + ["time"],
             "vector": ["vector"] + ["domain"] * 3}[row["axes"]]
    head += [f"kinds: {' '.join(kinds)}", f"encoding: {row['encoding']}", f"endian: {row['order']}"]
    if row["files"] == "attached":
        with open(stem + ".nrrd", "wb") as file:
            file.write(("\n".join(head) + "\n\n").encode() + encode(values, row))
        return stem + ".nrrd"
    base = os.path.basename(stem)
    slabs = [values] if row["files"] == "detached" else [
        values[..., n] for n in range(values.shape[-1])]
    names = [f"{base}_{n:03d}.data" for n in range(len(slabs))]
    for name, slab in zip(names, slabs):
        with open(os.path.join(os.path.dirname(stem), name), "wb") as file:
            file.write(encode(slab, row))
    head.append({"detached": f"data file: {names[0]}",
                 "list": "\n".join(["data file: LIST", *names]),
                 "numbered": f"data file: {base}_%03d.data 0 {len(names) - 1} 1"}[row["files"]])
    with open(stem + ".nhdr", "w", encoding="ascii") as file:
        file.write("\n".join(head) + "\n")
    return stem + ".nhdr"


def write_by_teem(stem, row, affine, values):
    plain = {**row, "encoding": "raw", "order": "little", "files": "attached"}
    source = write_by_hand(stem + "_source", plain, affine, values)
    path = stem + (".nrrd" if row["files"] == "attached" else ".nhdr")
    subprocess.run([program("teem-unu", "unu"), "save", "-f", "nrrd", "-e", row["encoding"],
                    "-en", row["order"], "-i", source, "-o", path], check=True, capture_output=True)
    return path


def read_by_teem(path, frame=None, channel=None):
    """Teem rewrites the file as little-endian raw, whose header it has made canonical."""
    copy = f"{path}.{frame}.{channel}.teem.nrrd"
    subprocess.run([program("teem-unu", "unu"), "save", "-f", "nrrd", "-e", "raw", "-en", "little",
                    "-i", path, "-o", copy], check=True, capture_output=True)
    with open(copy, "rb") as file:
        head, body = file.read().split(b"\n\n", 1)
    os.remove(copy)
    lines = dict(line.split(": ", 1) for line in head.decode().split("\n") if ": " in line)
    names = {**{teem: name for name, teem in TEEM_TYPES.items()}, "long long int": "int64",
             "unsigned long long int": "uint64", "unsigned char": "uint8",
             "unsigned short": "uint16", "unsigned int": "uint32"}
    kind = np.dtype(names[lines["type"]]).newbyteorder("<")
    values = np.frombuffer(body, kind).reshape([int(n) for n in lines["sizes"].split()], order="F")
    affine = np.eye(4)
    if "space directions" in lines:
        vectors = [[float(x) for x in word.strip("()").split(",")]
                   for word in lines["space directions"].split() if word != "none"]
        origin = [float(x) for x in lines["space origin"].strip("()").split(",")]
        affine[:3, :] = signs_of(lines["space"])[:, None] * np.column_stack(vectors + [origin])
    else:
        steps = [float(x) for x in lines["spacings"].split() if x.lower() != "nan"]
        affine[:3, :3] = np.diag(steps)
    if frame is not None:
        values = values[..., frame]
    return reading(values if channel is None else values[channel], affine)


def cases(folder):
    for n, row in enumerate(choose(FACTORS, ("type", "encoding", "order"), allowed)):
        affine, options, picked = GRIDS[row["grid"]], [], {}
        shape = {"scalar": DIMS, "time": (*DIMS, 2), "vector": (3, *DIMS)}[row["axes"]]
        values = chosen = values_of(row["type"], shape, n)
        if row["axes"] == "time":
            options, picked, chosen = ["--frame", "1"], {"frame": 1}, values[..., 1]
        if row["axes"] == "vector":
            options, picked, chosen = ["--channel", "2"], {"channel": 2}, values[2]
        write = write_by_hand if row["writer"] == "hand" else write_by_teem
        path = write(os.path.join(folder, f"n{n:03d}"), row, affine, values)
        yield Case(path, [("intent", lambda c=chosen, a=affine: reading(c, a)),
                          ("unu", lambda p=path, k=picked: read_by_teem(p, **k))], options,
                   name=f"{os.path.basename(path)} {' '.join(row.values())}")
