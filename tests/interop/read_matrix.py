"""Every kind of file that supple reads, read by supple and by other people's programs.

    read_matrix.py [FORMAT ...]

Each file is made by another program or by hand, never by supple. `supple info --json` must agree
with what was meant and with the other program: dims, axes, origin, type, checksum and range.
"""
import importlib
import sys
import tempfile
from collections import Counter

from common import Tally, require_sharp_comparison

FORMATS = ["nrrd", "metaimage", "nifti", "gipl", "tiff", "hdf5", "raw", "dicom"]


def main(formats):
    tally, counts = Tally(), Counter()
    for name in formats:
        writer = importlib.import_module(f"write_{name}")
        if writer.missing():
            tally.skip(name, writer.missing())
            continue
        with tempfile.TemporaryDirectory(prefix=f"supple_{name}_") as folder:
            cases = list(writer.cases(folder))
            require_sharp_comparison(cases[-1].oracles[0][1]())
            tally.compare_all(cases)
        counts[name] = len(cases)
    print(", ".join(f"{name} {count}" for name, count in counts.items()))
    tally.finish()


if __name__ == "__main__":
    main(sys.argv[1:] or FORMATS)
