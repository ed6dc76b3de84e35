#!/usr/bin/env bash
# Fuzzes every parser with libFuzzer under address and undefined-behaviour sanitizers: builds the
# targets of preset `asan`, makes a seed corpus, runs each target for a while and prints what it did.
# Corpus, logs and inputs that fail are kept under build/fuzz.
#
#   bash tools/fuzz.sh [--seconds N] [TARGET...]
#     N seconds of processor time per target (600); targets: nrrd metaimage ... (all)
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
  targets=(nrrd metaimage nifti gipl tiff png hdf5 vdb transform dicom raw stl ply obj vtk points page)

# An input of more than 30 s, of 2 GiB or with a leak is a finding. HDF5 and OpenVDB leave memory
# behind when they meet damage. Their files are tried in a child process, which may take up to 8 s of
# processor time, more on a busy machine (volumes/base/process.h): inputs on which the child
# ends, but not the target, are kept, and the program itself must refuse them.
sanitizer_of() {
  case "$1" in
    hdf5 | vdb) printf 'detect_leaks=0:allocator_may_return_null=1' ;;
    *) printf 'detect_leaks=1' ;;
  esac
}

# Sets `spent` to the seconds of processor time of the command.
processor_time() {
  local status=0 TIMEFORMAT='%U %S'
  { time "$@" >>"$log" 2>&1 || status=$?; } 2>build/fuzz/time-$target
  spent=$(awk '{ print int($1 + $2 + 0.5) }' build/fuzz/time-$target)
  return "$status"
}

# refused_by_program TARGET EXTENSION: its answer to each input on which a child ended.
refused_by_program() {
  local input status
  for input in build/fuzz/findings/"$1"-{crash,oom}-*; do
    [ -e "$input" ] || continue
    cp "$input" "build/fuzz/input.$2"
    status=0
    timeout 30 build/asan/bin/supple info "build/fuzz/input.$2" >>"$log" 2>&1 || status=$?
    [ "$status" -eq 3 ] || { say "fuzz $1: supple info exits with $status for $input"; return 1; }
    rm "$input"
    refused=$((refused + 1))
  done
}

# fuzz TARGET: runs it until its time is used up.
fuzz() {
  local target="$1" log="build/fuzz/$1.log" used=0 spent=0 runs=0 refused=0
  mkdir -p "build/fuzz/corpus/$target"
  : >"$log"
  export ASAN_OPTIONS="$(sanitizer_of "$target")"
  while [ "$used" -lt "$seconds" ]; do
    if ! processor_time "build/asan/bin/fuzz_$target" "build/fuzz/corpus/$target" \
      "build/fuzz/seeds/$target" -max_total_time="$((seconds - used))" -timeout=30 -max_len=65536 \
      -rss_limit_mb=2048 -print_final_stats=1 \
      -artifact_prefix="build/fuzz/findings/$target-"; then
      say "fuzz $target: a finding, see $log"
      grep -m 3 -E 'ERROR|SUMMARY|terminate' "$log" || true
      return 1
    fi
    used=$((used + (spent > 0 ? spent : 1)))
  done
  case "$target" in
    hdf5) refused_by_program hdf5 h5 || return 1 ;;
    vdb) refused_by_program vdb vdb || return 1 ;;
  esac
  runs="$(awk '/^stat::number_of_executed_units:/ { n += $2 } END { print n }' "$log")"
  local note=""
  [ "$refused" -eq 0 ] || note=" ($refused ended a child, and the program refuses them)"
  say "fuzz $target: $runs runs in $used s, no finding$note"
}

supple_setup
install_packages "${SUPPLE_CLANG[@]}"
build_preset asan "fuzzers supple"
mkdir -p build/fuzz
rm -rf build/fuzz/seeds
build/asan/bin/fuzz_seeds build/fuzz/seeds
mkdir -p build/fuzz/corpus build/fuzz/findings

# As many at a time as there are processors.
failed=0 running=0
for target in "${targets[@]}"; do
  if [ "$running" -ge "$(nproc)" ]; then
    wait -n || failed=1
    running=$((running - 1))
  fi
  fuzz "$target" &
  running=$((running + 1))
done
while [ "$running" -gt 0 ]; do
  wait -n || failed=1
  running=$((running - 1))
done
exit "$failed"
