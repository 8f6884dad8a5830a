#!/usr/bin/env bash
# Makes the pictures of README and docs again: each example before and after, and those of docs/method.md. make
# docs-pictures builds the program first.
set -euo pipefail
cd "$(dirname "$0")/.."
program=build/release/meshgraft
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

made=0
for edit in examples/*.json; do
  [ -e "$edit" ] || continue
  name=$(basename "$edit" .json)
  command=deform
  if grep -q '"kind": "merge"' "$edit"; then command=merge; fi
  "$program" "$command" "$edit" -o "$scratch/$name.ply" --picture "docs/images/$name.png"
  echo "docs/images/$name.png"
  made=$((made + 1))
done
python3 tools/method_pictures.py "$program" docs/images
[ "$made" -gt 0 ] || { echo "docs_pictures: no edit files in examples" >&2; exit 1; }
