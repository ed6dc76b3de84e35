#!/usr/bin/env bash
# Fuzzes every parser with libFuzzer under address and undefined-behaviour sanitizers: builds preset
# `fuzz` (clang), makes a seed corpus, runs each target for a while and prints what it did. Inputs
# that fail are kept under build/fuzz/findings.
#
#   bash tools/fuzz.sh [--seconds N] [TARGET...]      N seconds per target (600); targets: nrrd ...
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
cd "$SUPPLE_ROOT"

seconds=600
if [ "${1:-}" = "--seconds" ]; then
  seconds="$2"
  shift 2
fi
targets=("$@")
[ "${#targets[@]}" -gt 0 ] ||
  targets=(nrrd metaimage nifti tiff png hdf5 vdb dicom raw stl ply obj points)

supple_setup
install_packages clang-14
build_preset fuzz fuzzers
build/fuzz/bin/fuzz_seeds build/fuzz/seeds
mkdir -p build/fuzz/corpus build/fuzz/findings

# HDF5 and OpenVDB leave memory behind when they meet damage, and OpenVDB allocates the 4 GiB that a
# string may claim. The program bounds both (volumes/base/memory_limit.h), sanitizers cannot.
leaks_of() { case "$1" in hdf5 | vdb) printf 0 ;; *) printf 1 ;; esac; }
memory_of() { case "$1" in hdf5 | vdb) printf 8192 ;; *) printf 2048 ;; esac; }

failed=0
for target in "${targets[@]}"; do
  mkdir -p "build/fuzz/corpus/$target"
  log="build/fuzz/$target.log"
  # What the new corpus finds counts; memory beyond 2 GiB or an input of more than 10 s is a finding.
  if "build/fuzz/bin/fuzz_$target" "build/fuzz/corpus/$target" "build/fuzz/seeds/$target" \
    -detect_leaks="$(leaks_of "$target")" -max_total_time="$seconds" -timeout=10 -rss_limit_mb="$(memory_of "$target")" -max_len=65536 -print_final_stats=1 \
    -artifact_prefix="build/fuzz/findings/$target-" >"$log" 2>&1; then
    runs="$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")"
    rss="$(sed -n 's/^stat::peak_rss_mb: *//p' "$log")"
    say "fuzz $target: $runs runs in $seconds s, peak $rss MB, no finding"
  else
    failed=1
    say "fuzz $target: a finding, see $log"
    grep -m 3 -E 'ERROR|SUMMARY|terminate' "$log" || true
  fi
done
exit "$failed"
