#!/usr/bin/env bash
# Sets up as setup.sh does, checks the format and changed sources, then runs the whole test suite: unit, property and
# fault tests in a build by clang with sanitizers and warnings as errors, each parser on random input
# for a few seconds, then everything in the release build, with the examples against the installed
# library. It ends with a list of what was skipped, and why.
#
#   bash tools/test.sh [--release-only] [--need-judges] [--all-tests]
#     --need-judges: fail where a program or volume that tests compare with is missing
#     --all-tests: the build with sanitizers leaves none out
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
cd "$SUPPLE_ROOT"

sanitized=1 need_judges=() all_tests=OFF labels=(-L 'unit|property|fault|sanitize')
for option in "$@"; do
  case "$option" in
    --release-only) sanitized=0 ;;
    --need-judges) need_judges=(--need-judges) ;;
    --all-tests) all_tests=ON labels=() ;;
    *) echo "test.sh: found option $option, expected --release-only, --need-judges or --all-tests" >&2; exit 2 ;;
  esac
done

logs=()
# run_ctest PRESET [options]: a failure is reported at the end, after the list of skips. One test more
# than processors, as many wait for files and programs.
failed=0
run_ctest() {
  local preset="$1"
  shift
  ctest --test-dir "build/$preset" -j "$(($(nproc) + 1))" --output-on-failure "$@" || failed=1
  logs+=("build/$preset/Testing/Temporary/LastTest.log")
}

supple_setup
install_judges || say "tests that need them will be skipped"
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

if [ "$sanitized" = 1 ]; then
  install_packages "${SUPPLE_CLANG[@]}"
  build_preset asan all -DSUPPLE_WERROR=ON -DSUPPLE_ALL_TESTS=$all_tests
  say "testing build/asan"
  run_ctest asan "${labels[@]}"
  bash tools/fuzz.sh --seconds 2
fi
build_preset release all -DSUPPLE_BENCH=ON
say "testing build/release"
run_ctest release
python3 tests/docs/skipped_tests.py "${need_judges[@]}" "${logs[@]}" || failed=1
exit "$failed"
