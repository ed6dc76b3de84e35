#!/usr/bin/env python3
"""Lists what a run of ctest left out, and why, from its log.

  skipped_tests.py [--need-judges] build/release/Testing/Temporary/LastTest.log ...

Tests of GoogleTest say `FILE:LINE: Skipped` and the reason in the next line, scripts
`skipped: REASON`. With --need-judges a reason that ends in `is not installed` is an error: judges
are installed by tools/setup.sh, so that a test without one would never run.
"""
import re
import sys

BEGIN = re.compile(r"\d+/\d+ Test: (.+)")
GTEST = re.compile(r"(?:.*/)?(tests/.+:\d+): Skipped")
SCRIPT = re.compile(r"skipped: (.+)")
MISSING = "not installed"


def skips(lines):
    """(test, reason) in the order of the log."""
    found, test, place = [], "", None
    for line in map(str.rstrip, lines):
        if place is not None:
            found.append((test, f"{line} ({place})"))
            place = None
        elif match := BEGIN.fullmatch(line):
            test = match[1]
        elif match := GTEST.fullmatch(line):
            place = match[1]
        elif match := SCRIPT.fullmatch(line):
            found.append((test, match[1]))
    return found


def main(arguments):
    need_judges = "--need-judges" in arguments
    found = []
    for path in arguments:
        if path != "--need-judges":
            with open(path, encoding="utf-8", errors="replace") as log:
                found += skips(log)
    print(f"skipped: {len(found)}" if found else "skipped: nothing")
    for test, reason in found:
        print(f"  {test}: {reason}")
    missing = [test for test, reason in found if MISSING in reason]
    if need_judges and missing:
        print(f"error: {len(missing)} skipped for want of what tools/setup.sh --with-judges installs")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
