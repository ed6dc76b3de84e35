"""Common part of the interoperability scripts: readings of a volume, supple's own reading, the
comparison of two readings, and the tally that a script ends with.

A reading is what any program says of one file: dims, affine from index to LPS in mm, numpy's name of
the stored type, the SHA-256 of the stored values (little-endian, i fastest, before slope and
intercept), and the range after them. Everything of it is compared.
"""
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "support"))
from forks import forks

SKIPPED = 77  # CTest's SKIP_RETURN_CODE
WORKERS = max(2, min(8, os.cpu_count() or 2))

try:
    import numpy as np
except ImportError:
    print("skipped: python3-numpy is not installed")
    sys.exit(SKIPPED)


@dataclass(frozen=True)
class Reading:
    dims: tuple
    affine: np.ndarray
    type: str
    sha256: str
    range: tuple
    floats: str = ""  # SHA-256 of the values after slope and intercept as 32-bit floats


@dataclass(frozen=True)
class Refusal:
    """An exit code other than 0 and what stood on stderr."""

    code: int
    message: str


@dataclass
class Case:
    """One file with the options that choose a volume in it, and what should be read there."""

    path: str
    oracles: list  # of (name, () -> Reading)
    options: list = field(default_factory=list)
    tolerance: float = 1e-9  # of affine elements, relative to the largest
    name: str = ""


def sha256_of(values):
    return hashlib.sha256(values.tobytes(order="F")).hexdigest()


def reading(values, affine, slope=1.0, intercept=0.0) -> Reading:
    """Of an array in index order (i, j, k)."""
    values = np.asarray(values)
    little = values.astype(values.dtype.newbyteorder("<"), copy=False)
    finite = values[np.isfinite(values)]
    scaled = [float(v) * slope + intercept for v in (finite.min(), finite.max())]
    floats = values if (slope, intercept) == (1, 0) else values * np.float64(slope) + intercept
    return Reading(tuple(int(n) for n in values.shape), np.asarray(affine, float),
                   values.dtype.newbyteorder("=").name, sha256_of(little), tuple(sorted(scaled)),
                   sha256_of(floats.astype("<f4")))


def run_supple(*arguments):
    """Finished process of the program under test."""
    binary = os.environ.get("SUPPLE_BINARY", "build/release/bin/supple")
    command = [binary, "--threads", "1", *map(str, arguments)]
    server = forks(binary)
    if not server:
        return subprocess.run(command, capture_output=True, text=True, timeout=120,
                              stdin=subprocess.DEVNULL)
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err, \
            open(os.devnull) as nothing:
        server.start(command, None, [nothing, out, err])
        status, _ = server.wait()
        out.seek(0)
        err.seek(0)
        return subprocess.CompletedProcess(command, os.waitstatus_to_exitcode(status), out.read(),
                                           err.read())


def reading_of(said):
    """One object of `supple info --json` as a Reading."""
    affine = np.array(said["affine_lps"])
    parts = np.array(said["direction"]) * said["spacing_mm"]
    if not (np.allclose(parts, affine[:3, :3], rtol=0, atol=1e-12 * np.abs(affine).max())
            and said["origin_lps_mm"] == affine[:3, 3].tolist()):
        return Refusal(0, f"affine_lps {affine.tolist()} is not direction, spacing and origin")
    return Reading(tuple(said["dims"]), affine, said["type"], said["sha256"],
                   (said["min"], said["max"]))


def supple_reading(path, options=()):
    """What `supple info --json` says: a Reading, or a Refusal."""
    done = run_supple("--json", "--quiet", "info", path, *options)
    if done.returncode != 0:
        return Refusal(done.returncode, done.stderr)
    return reading_of(json.loads(done.stdout))


MOST_FILES = 20  # of one start


def supple_readings(cases):
    """{(path, options): Reading or Refusal} for (path, options) of all cases, many files of the same
    options per start."""
    groups, found = {}, {}
    for path, options in cases:
        groups.setdefault(tuple(map(str, options)), []).append(path)
    batches = [(paths[n:n + MOST_FILES], options) for options, paths in groups.items()
               for n in range(0, len(paths), MOST_FILES)]

    def read(batch):
        paths, options = batch
        done = run_supple("--json", "--quiet", "info", *paths, *options)
        try:
            said = json.loads(done.stdout) if len(paths) > 1 else None
        except ValueError:
            said = None
        if said is None:  # one file, or an end by a signal: each alone shows which file is to blame
            return {(path, options): supple_reading(path, options) for path in paths}
        lines = iter(done.stderr.splitlines(keepends=True))
        codes = [entry["exit_code"] for entry in said if "error" in entry]
        told = {}
        for entry in said:
            refused = "error" in entry
            told[entry["file"], options] = (Refusal(entry["exit_code"], next(lines, "")) if refused
                                            else reading_of(entry))
        if done.returncode != (codes or [0])[0] or next(lines, None) or len(told) != len(set(paths)):
            sys.exit(f"supple info on several files: exit code {done.returncode}, expected that of "
                     f"the first that is refused and a line for each:\n{done.stderr}")
        return told

    with ThreadPoolExecutor(WORKERS) as pool:
        for readings in pool.map(read, batches):
            found.update(readings)
    return found


def differences(ours, theirs: Reading, tolerance=1e-9):
    """(field, ours, theirs) for every field that differs."""
    if isinstance(ours, Refusal):
        return [("read", f"exit code {ours.code}: {ours.message.strip()}", "a volume")]
    found = [(name, getattr(ours, name), getattr(theirs, name))
             for name in ("dims", "type", "sha256") if getattr(ours, name) != getattr(theirs, name)]
    for name, part in (("axes", np.s_[:3, :3]), ("origin", np.s_[:3, 3])):
        a, b = ours.affine[part], theirs.affine[part]
        if not np.abs(a - b).max() <= tolerance * max(1.0, np.abs(b).max()):
            found.append((name, a.tolist(), b.tolist()))
    # Supple's range is that of the 32-bit floats which the values become.
    if not np.allclose(ours.range, theirs.range, rtol=1e-6, atol=1e-30):
        found.append(("range", ours.range, theirs.range))
    return found


def require_sharp_comparison(sample: Reading):
    """Every kind of error must be seen in a copy of a true reading, or the script proves nothing."""
    def moved(part, factor):
        affine = sample.affine.copy()
        affine[part] = affine[part] * factor + (factor < 0) * 0.5
        return replace(sample, affine=affine)

    sheared = sample.affine.copy()
    sheared[0, 2] += 1e-3
    wrong = {
        "dims": replace(sample, dims=(sample.dims[1], sample.dims[0] + 1, sample.dims[2])),
        "type": replace(sample, type="u" + sample.type),
        "sha256": replace(sample, sha256=sample.sha256[::-1]),
        "range": replace(sample, range=(sample.range[0], 2 * sample.range[1] + 1)),
        "origin": moved(np.s_[:3, 3], -1),
        "axes": moved(np.s_[:3, 0], -1),
    }
    for name, reading_with_error in wrong.items():
        if [name] != [d[0] for d in differences(reading_with_error, sample)]:
            sys.exit(f"the comparison does not see a wrong {name}")
    for error in (replace(sample, affine=sheared), moved(np.s_[:3, 1], 1.0001)):
        if ["axes"] != [d[0] for d in differences(error, sample)]:
            sys.exit("the comparison does not see a shear or a scaled axis")


class Tally:
    """Prints disagreements as they are found, and at the end how many files were compared."""

    def __init__(self):
        self.files = self.disagreements = 0
        self.absent = []

    def report(self, name, what, ours, theirs, judge=""):
        self.disagreements += 1
        print(f"{name}: {what}: supple {ours}, {judge or 'expected'} {theirs}", flush=True)

    def compare(self, case: Case, ours):
        name = case.name or " ".join([os.path.basename(case.path), *map(str, case.options)])
        lines = []
        for judge, oracle in case.oracles:
            try:
                theirs = oracle()
            except Exception as error:  # a judge that fails is a disagreement, not a crash
                lines.append((name, judge, "a volume", f"{type(error).__name__}: {error}"))
                continue
            lines += [(name, *difference, judge)
                      for difference in differences(ours, theirs, case.tolerance)]
        return lines

    def compare_all(self, cases):
        """Several at a time, reported in the order given."""
        ours = supple_readings([(case.path, case.options) for case in cases])

        def compare(case):
            return self.compare(case, ours[case.path, tuple(map(str, case.options))])

        with ThreadPoolExecutor(WORKERS) as pool:
            for lines in pool.map(compare, cases):
                self.files += 1
                for line in lines:
                    self.report(*line)

    def skip(self, what, missing):
        self.absent.append(what)
        print(f"skipped: {what}: {missing} is not installed", flush=True)

    def finish(self, noun="files"):
        print(f"{self.files} {noun}, {self.disagreements} disagreements")
        if self.disagreements:
            sys.exit(1)
        sys.exit(SKIPPED if self.files == 0 else 0)


def has_module(name):
    try:
        __import__(name)
        return True
    except ImportError:
        return False


def program(*names):
    """Path of the first program that is installed, or None."""
    return next((path for path in map(shutil.which, names) if path), None)
