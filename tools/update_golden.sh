#!/usr/bin/env bash
# Renders the references of the golden-image tests anew. Look at every one of them before you
# commit: the tests only ask whether a picture is as it was.
#
#   bash tools/update_golden.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bin=build/release/bin
cmake --build build/release --target supple supple-examples
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
"$bin/supple-examples" phantom small-head "$work/small-head.nhdr"
"$bin/supple-examples" phantom t-shape "$work/t-shape.png"
for scene in head paths slice; do
  cp "tests/golden/$scene.toml" "$work/"
  "$bin/supple" run "$work/$scene.toml" -o "$work/out" --force --quiet
done
mkdir -p tests/golden/reference
cp "$work"/out/*.png tests/golden/reference/
ls -l tests/golden/reference
