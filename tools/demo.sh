#!/usr/bin/env bash
# Runs every example edit, and says what came out. make demo builds the program first.
set -euo pipefail
cd "$(dirname "$0")/.."
program=build/release/meshgraft
out=out
mkdir -p "$out"

edits=(examples/*.json)
if [ ! -e "${edits[0]}" ]; then
  echo "demo: there are no edit files in examples/" >&2
  exit 1
fi

for edit in "${edits[@]}"; do
  name=$(basename "$edit" .json)
  echo
  echo "$program run $edit -o $out/$name.ply --report $out/$name.report.json --picture $out/$name.png"
  "$program" run "$edit" -o "$out/$name.ply" --report "$out/$name.report.json" --picture "$out/$name.png"
done

echo
echo "Before and after, side by side:"
for edit in "${edits[@]}"; do
  echo "  $out/$(basename "$edit" .json).png"
done
first=$(basename "${edits[0]}" .json)
cat <<TXT
The edited meshes (.ply) and the measurements (.report.json) lie beside them.

Try next:
  $program edit   (bend and graft by hand, in the browser: docs/editor.md)
  change an angle or a length in ${edits[0]} and run make demo again
  $program info $out/$first.ply
  $program sample --list
  $program deform --help
  $program merge --help
TXT
