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
"$bin/supple-examples" phantom lips "$work/lips.nhdr"
"$bin/supple-examples" phantom t-shape "$work/t-shape.png"
cp tests/golden/*.toml tests/golden/*.obj "$work/"
# head and shear first: others read their states.
for scene in head shear paths slice light surfaces clips sampling outputs cut fold lips; do
  "$bin/supple" run "$work/$scene.toml" -o "$work" --force --quiet
done
# Of public volumes, where they are.
for volume in ct_head.nhdr ct_head.raw ch2.nii.gz; do
  for folder in "$PWD/build/data" /usr/share/mricron/templates; do
    [ ! -f "$folder/$volume" ] || ln -sf "$folder/$volume" "$work/$volume"
  done
done
for scene in ct cheek; do
  [ ! -f "$work/ct_head.nhdr" ] || "$bin/supple" run "$work/$scene.toml" -o "$work" --force --quiet
done
[ ! -f "$work/ch2.nii.gz" ] || "$bin/supple" run "$work/mri.toml" -o "$work" --force --quiet
rm "$work/t-shape.png"
mkdir -p tests/golden/reference
cp "$work"/*.png tests/golden/reference/
ls -l tests/golden/reference
