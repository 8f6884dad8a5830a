#!/usr/bin/env bash
# Uses a wheel as a person would who has nothing but a bare Debian with Python:
#   tools/try_wheel.sh dist/meshgraft-….whl [FOLDER]
# Makes a root file system of Debian 12 in FOLDER (build/wheel/debian) by debootstrap, installs the wheel and NumPy there,
# and runs module, program and editor. Needs root, debootstrap, pip and the network, and writes only to FOLDER.
set -euo pipefail
wheel=$(realpath "${1:?usage: tools/try_wheel.sh WHEEL [FOLDER]}")
cd "$(dirname "$0")/.."
folder=${2:-build/wheel/debian}

if [ ! -x "$folder/usr/bin/python3" ]; then
  mkdir -p "$folder"
  debootstrap --variant=minbase --include=python3-venv bookworm "$folder" >"$folder.log" 2>&1 ||
    { tail -n 20 "$folder.log" >&2; exit 1; }
fi

# What pip would fetch there, so that the root itself needs no network.
rm -rf "$folder/try" && mkdir "$folder/try"
cp "$wheel" "$folder/try"
python3 -m pip download -q --only-binary=:all: --python-version 3.11 --platform manylinux_2_28_x86_64 \
  --platform manylinux_2_17_x86_64 --no-deps -d "$folder/try" numpy

cat >"$folder/try/try.sh" <<'END'
set -eu
cd /try
if command -v gcc cc c++ || ldconfig -p | grep -E 'tbb|openblas|embree|libfmt|libpng'; then
  echo "not a bare system" >&2
  exit 1
fi
python3 -m venv venv
find venv ! -path '*__pycache__*' | sort >before
venv/bin/pip install -q --no-index --find-links . meshgraft*.whl
PATH=/try/venv/bin:$PATH
meshgraft --version
python -m meshgraft --version
meshgraft sample octopus --resolution 48 -o octopus.ply
python - <<'PYTHON'
import meshgraft as mg
octopus = mg.read("octopus.ply")
tip = mg.select.nearest((0.65, -1.49, 0.35)).grow(length=0.5)
edit = mg.Edit().input("octopus", octopus)
edit.deform("octopus", region=tip.grow(length=1.25), handles={"tip": tip}, poses={"tip": mg.Pose(rotate=("z", 40))})
edit.save("edit.json")
mg.write(edit.run().mesh, "module.ply")
mg.picture(octopus, width=160, height=120).save("module.png")
PYTHON
meshgraft run edit.json -o program.ply
cmp module.ply program.ply
if cmp -s module.ply octopus.ply; then exit 1; fi
meshgraft render program.ply -o program.png --width 160 --height 120
meshgraft edit --no-browser --port 0 octopus.ply >address &
editor=$!
while [ ! -s address ]; do kill -0 $editor; sleep 0.1; done
python - <<'PYTHON'
import urllib.request
assert b"<script" in urllib.request.urlopen(open("address").read().strip()).read()
PYTHON
kill $editor
wait $editor
pip uninstall -q -y meshgraft numpy
find venv ! -path '*__pycache__*' | sort >after
cmp before after
END
# The loader finds the libraries beside a program through /proc. The mount is seen by these commands alone.
unshare --mount sh -c 'mount -t proc proc "$1/proc" &&
  exec chroot "$1" env -i PATH=/usr/sbin:/usr/bin HOME=/root sh /try/try.sh' sh "$folder"
echo "$(basename "$wheel") works in a bare Debian 12"
