#!/usr/bin/env bash
# Checks sources with clang-tidy, without its analyser, which takes as long again as all other
# checks. Without names: the first twelve .cpp files, about a minute, that differ from where the
# branch left origin/main, or from the commit before.
#
#   bash tools/tidy.sh [FILE.cpp...]
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
cd "$SUPPLE_ROOT"

changed_sources() {
  local base
  base="$(git merge-base HEAD origin/main 2>/dev/null || true)"
  if [ -z "$base" ] || [ "$base" = "$(git rev-parse HEAD)" ]; then
    base="$(git rev-parse --quiet --verify HEAD~1)" || return 0
  fi
  git diff --name-only --diff-filter=d "$base" -- '*.cpp'
}

# Commands without unity files and precompiled headers; nothing of it is built but what sources include.
mkdir -p build
cmake -S . -B build/tidy -G Ninja -DCMAKE_BUILD_TYPE=Debug -DSUPPLE_UNITY=1 \
  -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >build/tidy-configure.log
cmake --build build/tidy --target supple_build_facts >>build/tidy-configure.log

files=("$@") left_out=0
if [ "${#files[@]}" -eq 0 ]; then
  # Examples and ITK's side of benchmarks are built by other commands.
  for file in $(changed_sources); do
    grep -qF "\"file\": \"$PWD/$file\"" build/tidy/compile_commands.json || continue
    if [ "${#files[@]}" -lt 12 ]; then files+=("$file"); else left_out=$((left_out + 1)); fi
  done
fi
say "clang-tidy: ${#files[@]} sources; $left_out more have changed"
[ "${#files[@]}" -gt 0 ] || exit 0
# Without the count of what was found in headers of libraries.
printf '%s\n' "${files[@]}" | xargs -n 1 -P "$(nproc)" clang-tidy-14 --quiet \
  --checks='-clang-analyzer-*' -p build/tidy 2>build/tidy-stderr.log ||
  { grep -v 'warnings generated' build/tidy-stderr.log || true; exit 1; }
