"""The policy itself: programs that break it in one way each are found out."""
import os
import stat

import program
from program import BAD_INPUT, Policy

GOOD = "echo 'supple: error: a.nrrd: sizes: found 0, expected 1' >&2; exit 3"

# What the stand-in does instead, and what the policy must say of it.
BROKEN = {
    "two lines": ("echo 'supple: error: a.nrrd: one' >&2; " + GOOD, "2 error lines"),
    "no line": ("exit 3", "0 error lines"),
    "a line of a library": ("echo 'TIFFOpen: a.nrrd: no' >&2; " + GOOD, "is not supple's"),
    "an uncaught exception": ("echo \"terminate called after 'std::bad_alloc'\" >&2; " + GOOD,
                              "voice"),
    "exit code 1": (GOOD.replace("exit 3", "exit 1"), "exit code 1"),
    "success": ("exit 0", "exit code 0"),
    "an error and success": (GOOD.replace("exit 3", "exit 0"), "an error line with exit code 0"),
    "a signal": ("kill -SEGV $$", "SIGSEGV"),
    "an abort after the line": (GOOD.replace("exit 3", "kill -ABRT $$"), "SIGABRT"),
    "a hang": ("exec sleep 60", "ran longer"),
    "memory": ("a=$(head -c 80000000 /dev/zero | tr '\\0' x); " + GOOD, "peak of"),
    "another file's name": (GOOD.replace("a.nrrd", "b.nrrd"), "names none"),
    "a line without end": (GOOD.replace("found 0", "found " + "0" * 700), "characters"),
    "control characters": (GOOD.replace("echo '", "printf '").replace("found 0", "found \\033[2J"),
                           "control characters"),
    "a file left behind": ("echo part > .supple-1-out.nrrd; " + GOOD, "was left behind"),
    "an output cut short": ("echo part > old.nrrd; " + GOOD, "was changed"),
    "an input changed": ("echo more >> a.nrrd; " + GOOD, "a.nrrd was changed"),
    "a result of a failed run": ("echo result; " + GOOD, "output on stdout"),
}


class Quiet(Policy):
    """Keeps what it would print."""

    said = ""

    def fail(self, label, text):
        self.said += text + "\n"


def judged(policy, name, script):
    for file in ("a.nrrd", "old.nrrd"):
        with open(policy.path(file), "w") as stream:
            stream.write("sound")
    path = policy.path("stand-in")
    with open(path, "w") as stream:
        stream.write("#!/bin/sh\n%s\n" % script)
    os.chmod(path, stat.S_IRWXU)
    policy.said = ""
    program.MAX_SECONDS = 0.5 if name == "a hang" else 20
    policy.expect(name, ["convert", "a.nrrd", "old.nrrd"], [BAD_INPUT], ["a.nrrd"], ["old.nrrd"],
                  program=path, max_peak_mb=100 if name == "memory" else program.MAX_PEAK_MB)
    for left in set(os.listdir(policy.folder)) - {"a.nrrd", "old.nrrd"}:
        os.remove(policy.path(left))
    return policy.said


def main():
    program.is_sanitized = lambda: False  # shells are not
    policy, missed = Quiet(), 0
    for name, (script, finding) in {"a good refusal": (GOOD, ""), **BROKEN}.items():
        said = judged(policy, name, script)
        if finding not in said or (not finding and said):
            missed += 1
            print("FAILED %s: expected '%s', found '%s'" % (name, finding, said.strip()))
    print("%d broken programs, %d judged wrongly" % (len(BROKEN), missed))
    policy.failed = missed
    policy.finish()


main()
