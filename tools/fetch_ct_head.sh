#!/usr/bin/env bash
# Puts the example head CT at build/data/ct_head.{raw,nhdr}. The scan ships in Debian's package
# invesalius-examples (Cranium.inv3: a gzip tar with the raw voxels); nothing of it is committed.
#
#   bash tools/fetch_ct_head.sh          exit code 1 when the package cannot be had
set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
data="$root/build/data"

# True when the file holds the scan, not the phantom that stands in without a network.
is_scan() {
  echo "d87fd5e6aaf2c4fdf4f3fe28ee3335192fc2464ed8e9682fc78530cb837938da  $1" |
    sha256sum --check --status 2>/dev/null
}

[ -f "$data/ct_head.nhdr" ] && is_scan "$data/ct_head.raw" && exit 0

mkdir -p "$data"
work="$(mktemp -d "$data/fetch.XXXXXX")"
trap 'rm -rf "$work"' EXIT
archive=/usr/share/doc/invesalius-examples/examples/Cranium.inv3
if [ ! -f "$archive" ]; then
  (cd "$work" && apt-get -q download invesalius-examples >download.log 2>&1) || exit 1
  dpkg -x "$work"/invesalius-examples_*.deb "$work/package"
  archive="$work/package$archive"
fi
tar xzOf "$archive" --wildcards '*/matrix.dat' >"$work/ct_head.raw"
if ! is_scan "$work/ct_head.raw"; then
  echo "fetch_ct_head: found other voxels in $archive, expected those of version 3.1.99998" >&2
  exit 1
fi

# The package records spacing and size but no orientation: +k is up and +j towards the face; that x
# runs to the patient's left is taken on trust. The origin is the centre of the box.
cat >"$work/ct_head.nhdr" <<'HEADER'
NRRD0004
type: int16
dimension: 3
space: left-posterior-superior
sizes: 256 256 108
space directions: (0.957031,0,0) (0,-0.957031,0) (0,0,1.5)
space origin: (-122.0214525,122.0214525,-80.25)
kinds: domain domain domain
endian: little
encoding: raw
data file: ct_head.raw
HEADER
mv "$work/ct_head.raw" "$work/ct_head.nhdr" "$data/"
