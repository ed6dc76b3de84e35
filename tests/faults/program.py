"""Runs `supple` as a user does and holds what it does to one policy (docs/errors.md).

Exit 0, or a documented exit code with one line on stderr that begins with "supple: error: " and
names the file; never a signal, a hang, memory beyond a bound, or a file left behind.
"""
import hashlib
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "support"))
from forks import forks

SKIPPED = 77  # CTest's SKIP_RETURN_CODE
MAX_PEAK_MB = 300  # for the small files of these tests; the program itself takes about 60
MAX_SECONDS = 10  # on an idle machine
MAX_LINE = 600
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
USAGE, BAD_INPUT, SYSTEM = 2, 3, 4

# What only a crash, a library or a sanitizer says.
FOREIGN_WORDS = ("terminate called", "assert", "Sanitizer", "runtime error", "std::", "what():",
                 "core dumped", "HDF5-DIAG", "TIFFRead", "libpng", "DcmItem", "OpenVDB error")


def binary():
    path = os.environ.get("SUPPLE_BINARY", "")
    if not os.access(path, os.X_OK):
        sys.exit("SUPPLE_BINARY names no program: run the tests through ctest")
    return path


def is_sanitized():
    """Sanitizers reserve terabytes of addresses and keep freed memory."""
    with open(binary(), "rb") as file:
        return b"__asan_init" in file.read()


def seconds_allowed():
    return MAX_SECONDS * max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))


class Outcome:
    def __init__(self, code, out, err, peak_mb, timed_out):
        self.code = code  # negative: the signal that ended the program
        self.out, self.err = out, err
        self.peak_mb, self.timed_out = peak_mb, timed_out

    def error_lines(self):
        return [line for line in self.err.splitlines() if line.startswith("supple: error: ")]


def limits(address_space=None, file_size=None):
    """For the child, before exec; none where none are asked for, since threads must not fork."""
    if address_space is None and file_size is None:
        return None

    def set_limits():
        if address_space is not None:
            resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space))
        if file_size is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (file_size, file_size))
    return set_limits


def run(arguments, cwd=None, program=None, stdout=None, stop=None, **child_limits):
    """stop: (seconds, signal) sent to the program while it runs."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err, \
            open(os.devnull) as nothing:
        command = [program or binary(), *map(str, arguments)]
        streams = [nothing, stdout or out, err]
        server = forks(binary()) if program is None and not child_limits else None
        if server:
            number = server.start(command, cwd, streams)
        else:
            child = subprocess.Popen(command, cwd=cwd, stdin=streams[0], stdout=streams[1],
                                     stderr=streams[2], preexec_fn=limits(**child_limits))
            number = child.pid
        late = []
        timers = [threading.Timer(seconds_allowed(),
                                  lambda: (late.append(1), os.kill(number, signal.SIGKILL)))]
        if stop:
            timers.append(threading.Timer(stop[0], os.kill, (number, stop[1])))
        for timer in timers:
            timer.start()
        if server:
            status, peak_kib = server.wait()
        else:
            _, status, usage = os.wait4(number, 0)
            peak_kib = usage.ru_maxrss
            child.returncode = os.waitstatus_to_exitcode(status)
        for timer in timers:
            timer.cancel()
            timer.join()
        texts = []
        for stream in (out, err):
            stream.seek(0)
            texts.append(stream.read().decode("utf-8", "backslashreplace"))
        return Outcome(os.waitstatus_to_exitcode(status), *texts, peak_kib / 1024, bool(late))


def manners_of(outcome, max_peak_mb=MAX_PEAK_MB):
    """What breaks the policy however many files a run is about."""
    problems = []
    if outcome.timed_out:
        return ["ran longer than %.0f s" % seconds_allowed()]
    if outcome.code < 0:
        problems.append("ended by %s" % signal.Signals(-outcome.code).name)
    if outcome.peak_mb > max_peak_mb and not is_sanitized():
        problems.append("peak of %.0f MB, allowed %d" % (outcome.peak_mb, max_peak_mb))
    if any(not line.startswith("supple: ") for line in outcome.err.splitlines()):
        problems.append("a line on stderr is not supple's")
    if any(word.lower() in outcome.err.lower() for word in FOREIGN_WORDS):
        problems.append("stderr speaks of a crash or with a library's voice")
    if any(ord(c) < 32 or ord(c) == 127 for line in outcome.err.split("\n") for c in line):
        problems.append("control characters on stderr")
    if outcome.code == 0 and outcome.error_lines():
        problems.append("an error line with exit code 0")
    return problems


def problems_of_line(line, names):
    problems = []
    if len(line) > MAX_LINE:
        problems.append("an error line of %d characters" % len(line))
    if names and not any(os.path.basename(name) in line for name in names):
        problems.append("the line names none of %s" % ", ".join(names))
    return problems


def problems_of(outcome, codes, names, max_peak_mb=MAX_PEAK_MB):
    """What breaks the policy. `names`: files of which the line must name one; none: any line."""
    problems = manners_of(outcome, max_peak_mb)
    if outcome.timed_out:
        return problems
    if outcome.code >= 0 and outcome.code not in codes:
        problems.append("exit code %d, expected %s" % (outcome.code, codes))
    lines, errors = outcome.err.splitlines(), outcome.error_lines()
    if outcome.code > 0:
        if len(errors) != 1 or lines[-1:] != errors:
            problems.append("%d error lines, expected one, the last" % len(errors))
        problems += [problem for line in errors[:1] for problem in problems_of_line(line, names)]
        if outcome.out:
            problems.append("output on stdout of a failed run")
    return problems


def contents(folder):
    """Every file below the folder with a digest of its bytes."""
    found = {}
    for parent, _, files in os.walk(folder):
        for name in files:
            path = os.path.join(parent, name)
            place = os.path.relpath(path, folder)
            if not os.path.isfile(path):
                found[place] = "special"
                continue
            try:
                with open(path, "rb") as file:
                    found[place] = hashlib.sha256(file.read()).hexdigest()
            except PermissionError:
                found[place] = "unreadable"
    return found


class Policy:
    """Runs faults, collects what breaks the policy, and ends with the exit code for CTest."""

    def __init__(self):
        self.folder = tempfile.mkdtemp(prefix="supple-fault-")
        self.runs, self.refused, self.failed, self.peak_mb = 0, 0, 0, 0.0

    def path(self, name):
        return os.path.join(self.folder, name)

    def fail(self, label, text):
        self.failed += 1
        print("FAILED %s: %s" % (label, text), flush=True)

    def expect(self, label, arguments, codes, names=(), outputs=(), **options):
        """Runs it; a failed run leaves the folder as it was, a good one adds `outputs` at most."""
        max_peak_mb = options.pop("max_peak_mb", MAX_PEAK_MB)
        before = contents(self.folder)
        outcome = run(arguments, cwd=self.folder, **options)
        after = contents(self.folder)
        problems = problems_of(outcome, codes, names, max_peak_mb)
        allowed = set(outputs) if outcome.code == 0 else set()
        for name in sorted(set(before) | set(after)):
            if before.get(name) != after.get(name) and name not in allowed:
                problems.append("%s was %s" % (name, "changed" if name in before else
                                               "left behind"))
        self.count(outcome)
        if problems:
            self.fail(label, "%s\n  %s\n  %s" % ("; ".join(problems), " ".join(map(str, arguments)),
                                                 outcome.err.strip()[:1000]))
        return outcome

    def expect_each(self, label, files, options=()):
        """`supple info` on several files in one start: (label, path, codes, names) of each, as for
        expect(). Returns (code, whether a warning names it) of each."""
        if len(files) < 2:
            return [self.read_alone(*file, options) for file in files]
        before = contents(self.folder)
        paths = [path for _, path, _, _ in files]
        outcome = run(["info", "--json", *paths, *options], cwd=self.folder)
        problems = manners_of(outcome)
        if contents(self.folder) != before:
            problems.append("a file was changed or left behind")
        try:
            entries = json.loads(outcome.out)
            told = [entry["file"] for entry in entries]
        except ValueError:
            entries, told = [], []
        if told != paths:
            problems.append("%d of %d files are answered for" % (len(told), len(paths)))
        if problems:
            self.fail(label, "; ".join(problems) + "\n  " + outcome.err.strip()[:1000])
            return [self.read_alone(*file, options) for file in files]  # shows which is to blame
        lines, outcomes = iter(outcome.error_lines()), []
        for (name, path, codes, names), entry in zip(files, entries):
            code = entry.get("exit_code", 0)
            if code not in codes:
                problems.append("%s: exit code %d, expected %s" % (name, code, codes))
            if "error" in entry:
                line = next(lines, "")
                if line != "supple: error: " + entry["error"]:
                    problems.append("%s: stderr says %s" % (name, line or "nothing"))
                problems += ["%s: %s" % (name, text) for text in problems_of_line(line, names)]
            self.runs += 1
            self.refused += code > 0
            outcomes.append((code, "supple: warning: " + path in outcome.err))
        if outcome.code != next((code for code, _ in outcomes if code), 0):
            problems.append("exit code %d is not that of the first refused file" % outcome.code)
        if next(lines, None):
            problems.append("more error lines than refused files")
        self.peak_mb = max(self.peak_mb, outcome.peak_mb)
        if problems:
            self.fail(label, "\n  ".join([*problems, outcome.err.strip()[:1000]]))
        return outcomes

    def read_alone(self, label, path, codes, names, options):
        outcome = self.expect(label, ["info", path, *options], codes, names)
        return outcome.code, "supple: warning: " + path in outcome.err

    def count(self, outcome):
        self.runs += 1
        self.refused += outcome.code > 0
        self.peak_mb = max(self.peak_mb, outcome.peak_mb)

    def add(self, other):
        """Takes over the counts of another policy, whose folder goes."""
        shutil.rmtree(other.folder, ignore_errors=True)
        self.runs += other.runs
        self.refused += other.refused
        self.failed += other.failed
        self.peak_mb = max(self.peak_mb, other.peak_mb)

    def finish(self):
        shutil.rmtree(self.folder, ignore_errors=True)
        print("%d trials, %d refused, %d broke the policy, largest peak %.0f MB" %
              (self.runs, self.refused, self.failed, self.peak_mb))
        sys.exit(1 if self.failed or self.runs == 0 else 0)
