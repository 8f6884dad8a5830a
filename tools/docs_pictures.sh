#!/usr/bin/env bash
# Makes the pictures of README and docs again: each example before and after, those of docs/method.md, docs/files.md
# and docs/repair.md, and the tour of docs/editor.md. Makes the page's pictures of the samples, too. make docs-pictures
# builds the program first.
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

# The samples, as the editor's page shows them: from the front.
for name in $("$program" sample --list | cut -d ' ' -f 1); do
  from="0.5 -1 0.35"
  if [ "$name" = dinosaur ]; then from="-1 -0.5 0.35"; fi
  "$program" sample "$name" -o "$scratch/$name.ply"
  # shellcheck disable=SC2086  # three numbers
  "$program" render "$scratch/$name.ply" -o "page/public/samples/$name.png" --from $from --transparent \
    --width 144 --height 144
done

# The same graft by both shapes: FT05's figures 1, 6, 7 and 8 with our own samples.
shapes() {  # edit, direction to the eye
  for shape in ft05 similar; do
    "$program" merge "examples/$1.json" --shape $shape -o "$scratch/$shape.ply"
  done
  "$program" render "$scratch/ft05.ply" "$scratch/similar.ply" -o "docs/images/merge_shapes_$1.png" \
    --width 600 --height 560 --from $2
}
shapes head_on_bust "0.5 -1 0.35"
shapes horns "0.5 -1 0.4"
shapes dinosaur_bust "0.8 -1 0.3"
shapes bracket_on_posts "0.5 -1 0.6"

# A cut with pins: the lower half, and the upper one turned over.
cat > "$scratch/pins.json" <<'EDIT'
{"format": "meshgraft-edit", "version": 2, "inputs": {"head": {"sample": "head"}},
 "steps": [{"kind": "cut", "mesh": "head", "plane": {"point": [0, 0, 0.5], "normal": [0, 0, 1]}, "keep": "above", "pins": {}},
           {"kind": "transform", "mesh": "head", "pose": {"rotate": {"axis": [1, 0, 0], "angle_deg": 180}}}]}
EDIT
"$program" run "$scratch/pins.json" -o "$scratch/holes.ply"
"$program" sample head -o "$scratch/head.ply"
"$program" cut "$scratch/head.ply" --plane z=0.5 --keep below --pins -o "$scratch/pins.ply"
"$program" render "$scratch/pins.ply" "$scratch/holes.ply" -o docs/images/cut_pins.png --width 500 --height 420 \
  --from 0.3 -0.8 0.8

# The colours at a seam: of both meshes, blended, and a source without colours.
"$program" sample bust -o "$scratch/bust.ply"
"$program" sample dinosaur -o "$scratch/dinosaur.ply"
"$program" cut "$scratch/dinosaur.ply" --plane z=2.3 --keep above -o "$scratch/neck.ply"
"$program" cut "$scratch/dinosaur.ply" --plane z=2.3 --keep above -o "$scratch/neck.stl"
"$program" merge "$scratch/bust.ply" "$scratch/neck.ply" -o "$scratch/both.ply"
"$program" merge "$scratch/bust.ply" "$scratch/neck.ply" -o "$scratch/blended.ply" --blend-colours 0.3
"$program" merge "$scratch/bust.ply" "$scratch/neck.stl" -o "$scratch/of_target.ply"
"$program" render "$scratch/both.ply" "$scratch/blended.ply" "$scratch/of_target.ply" \
  -o docs/images/merge_colours.png --width 440 --height 480

(cd page && MESHGRAFT_PIXEL_RATIO=1 MESHGRAFT_SCREENSHOTS="$scratch" node node_modules/vitest/vitest.mjs run \
  tests/e2e/tour.test.ts tests/e2e/mending.test.ts tests/e2e/printing.test.ts tests/e2e/accessibility.test.ts)
cp "$scratch"/editor_*.jpg docs/images/

if [ -d build/release/python/meshgraft ]; then
  PYTHONPATH=build/release/python build/venv/bin/python tools/python_pictures.py
fi
python3 tools/method_pictures.py "$program" docs/images
python3 tools/published_pictures.py "$program" docs/images
python3 tools/defect_pictures.py "$program" docs/images
python3 tools/repair_pictures.py "$program" docs/images
[ "$made" -gt 0 ] || { echo "docs_pictures: no edit files in examples" >&2; exit 1; }
