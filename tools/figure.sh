#!/usr/bin/env bash
# Makes one figure of the thesis again, from a generated input, in out/figures/.
#
#   bash tools/figure.sh 4.5|4.9|4.10|4.13|4.14|4.15|u-shape
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case "${1:-}" in
  4.5|u-shape) input= ;;
  4.9)  input=t-shape.png ;;
  4.10) input=gradient.png ;;
  4.13) input=irregular.png ;;
  4.14) input=cube.nhdr ;;
  4.15) input=extruded.nhdr ;;
  *) echo "usage: bash tools/figure.sh 4.5|4.9|4.10|4.13|4.14|4.15|u-shape" >&2; exit 2 ;;
esac
name="figure_${1//[.-]/_}"
bin=build/release/bin
[ -x "$bin/supple" ] || { echo "figure.sh: build first: bash tools/setup.sh" >&2; exit 1; }

mkdir -p build/data out/figures
if [ -z "$input" ]; then
  case "$1" in
    4.5) "$bin/supple-examples" figure-4-5 out/figures ;;
    u-shape) "$bin/supple-examples" u-shape out/figures ;;
  esac
else
  "$bin/supple-examples" phantom "${input%.*}" "build/data/$input"
  "$bin/supple" run "docs/scenes/$name.toml" -o out/figures --force --quiet
fi
ls out/figures/"$name"*.png
