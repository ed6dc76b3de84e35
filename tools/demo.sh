#!/usr/bin/env bash
# From a fresh clone to pictures of a real head CT, undeformed and with the upper jaw
# advanced, a state file and a warp file. Writes only under build/ and out/head_upper_jaw/. Re-runnable.
#
#   bash tools/demo.sh
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
cd "$SUPPLE_ROOT"

stage_names=()
stage_seconds=()
stage() {
  local name="$1" start
  shift
  start=$(date +%s.%N)
  "$@"
  stage_names+=("$name")
  stage_seconds+=("$(echo "$(date +%s.%N) $start" | awk '{printf "%.1f", $1 - $2}')")
}

fetch_volume() {
  if bash tools/fetch_ct_head.sh; then
    volume="the head CT of Debian's package invesalius-examples"
    return
  fi
  say "no network and no package invesalius-examples: a generated head phantom stands in"
  volume="a generated head phantom (the head CT could not be fetched)"
  mkdir -p build/data
  build/release/bin/supple-examples phantom head build/data/ct_head.nhdr
}

stage install supple_setup
stage build build_preset release "$SUPPLE_PROGRAMS"
stage fetch fetch_volume
mkdir -p out
stage run build/release/bin/supple run docs/scenes/head_upper_jaw.toml -o out/head_upper_jaw --force

say "done: $volume"
echo "pictures  $(ls out/head_upper_jaw/*.png | tr '\n' ' ')"
echo "state     out/head_upper_jaw/moved.vdb"
echo "warp      $(ls out/head_upper_jaw/warp.* | tr '\n' ' ')"
for n in "${!stage_names[@]}"; do
  printf 'stage     %-8s %7s s\n' "${stage_names[$n]}" "${stage_seconds[$n]}"
done
