#!/usr/bin/env bash
# Sets up as setup.sh does, checks the format and changed sources, then runs the whole test suite: unit, property and
# fault tests in a build by clang with sanitizers and warnings as errors, each parser on random input
# for a few seconds, then everything in the release build, with the examples against the installed
# library.
#
#   bash tools/test.sh [--release-only]
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
cd "$SUPPLE_ROOT"

supple_setup
install_packages "${SUPPLE_JUDGES[@]}" || say "tests that need them will be skipped"
bash tools/fetch_ct_head.sh || say "no head CT: tests that need it will be skipped"

if install_packages clang-format-14; then
  say "checking the format"
  git ls-files '*.h' '*.cpp' | xargs clang-format-14 --dry-run -Werror
else
  say "no clang-format-14: the format is not checked"
fi

if install_packages clang-tidy-14; then
  bash tools/tidy.sh
else
  say "no clang-tidy-14: changed sources are not checked"
fi

if [ "${1:-}" != "--release-only" ]; then
  install_packages "${SUPPLE_CLANG[@]}"
  build_preset asan all -DSUPPLE_WERROR=ON
  say "testing build/asan (unit, property, fault)"
  ctest --test-dir build/asan -L 'unit|property|fault' -j "$(nproc)" --output-on-failure
  bash tools/fuzz.sh --seconds 5
fi
build_preset release all
say "testing build/release"
ctest --test-dir build/release -j "$(nproc)" --output-on-failure
