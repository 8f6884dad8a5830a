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
  size="--width 1200 --height 900"
  if grep -q '"kind": "merge"' "$edit"; then
    command=merge
    size="--width 800 --height 800"
  fi
  # shellcheck disable=SC2086  # four words
  "$program" "$command" "$edit" -o "$scratch/$name.ply" --picture "docs/images/$name.png" $size
  echo "docs/images/$name.png"
  made=$((made + 1))
done
for shape in ft05 similar; do
  "$program" merge examples/bracket_on_posts.json --shape $shape -o "$scratch/$shape.ply"
done
"$program" render "$scratch/ft05.ply" "$scratch/similar.ply" -o docs/images/merge_shapes.png --width 900 --height 800 --from 0.5 -1 0.6
python3 tools/method_pictures.py "$program" docs/images
[ "$made" -gt 0 ] || { echo "docs_pictures: no edit files in examples" >&2; exit 1; }
