#!/usr/bin/env bash
# Installs the Debian packages of the given groups (tools/packages.txt) that are missing:
#   tools/bootstrap.sh build test
# Does nothing, and needs neither network nor root, where all of them are there. With MESHGRAFT_BOOTSTRAP=off
# it does nothing at all: for people whose libraries do not come from packages.
#
# For the group test it also makes build/venv, an environment of Debian's own Python with what python/requirements.txt
# names, and makes it anew when that file has changed. MESHGRAFT_PYTHON is another Python for it, MESHGRAFT_VENV another
# folder, or "none": tools/run_tests.py makes it later, beside the first tests.
set -euo pipefail
cd "$(dirname "$0")/.."

[ "${MESHGRAFT_BOOTSTRAP:-on}" != off ] || exit 0

# Lines "package  purpose" of the groups.
wanted() {
  awk -v groups=" $* " '$1 !~ /^#/ && NF && index(groups, " " $1 " ") && !seen[$2]++ {
    name = $2; $1 = $2 = ""; sub(/^ +/, ""); printf "%-20s %s\n", name, $0 }' tools/packages.txt
}

for group in "$@"; do
  if ! grep -q "^$group " tools/packages.txt; then
    echo "bootstrap: no group '$group' in tools/packages.txt" >&2
    exit 2
  fi
done
list=$(wanted "$@")

# Makes the environment for the group test, unless it is there and of the current requirements.
make_venv() {
  case " $* " in *" test "*) ;; *) return 0 ;; esac
  [ "${MESHGRAFT_VENV:-}" != none ] || return 0
  local folder=${MESHGRAFT_VENV:-build/venv} python=${MESHGRAFT_PYTHON:-/usr/bin/python3}
  [ -x "$python" ] || python=python3
  if [ -f "$folder/requirements.txt" ] && [ "$(<"$folder/requirements.txt")" = "$(<python/requirements.txt)" ]; then
    return 0
  fi
  echo "meshgraft makes $folder, with the Python packages of python/requirements.txt"
  if ! "$python" -m venv "$folder" || ! "$folder/bin/python" -m pip install -q -r python/requirements.txt; then
    echo "Making $folder failed. 'python/requirements.txt' lists what the tests of the Python package need." >&2
    exit 1
  fi
  printf '%s\n' "$(<python/requirements.txt)" > "$folder/requirements.txt"
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  # Not Debian: the compiler and CMake stand for the rest, and CMake names a library that is missing.
  if command -v g++ >/dev/null && command -v cmake >/dev/null && command -v ninja >/dev/null; then
    make_venv "$@"
    exit 0
  fi
  printf '%s\n' "This system has no apt-get. Please install, under your system's names for them:" "" "$list" "" \
    "then run make again." | sed 's/^/  /' >&2
  exit 1
fi

installed=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' $(awk '{print $1}' <<<"$list") 2>/dev/null |
            awk '$1 == "installed" {print $2}' || true)
missing=$(awk 'NR == FNR {have[$1] = 1; next} !($1 in have)' <(printf '%s\n' "$installed") <(printf '%s\n' "$list"))

# Node.js often comes from elsewhere than Debian, with an npm that Debian's would stand in the way of.
provided_otherwise() {
  case $1 in
    nodejs) command -v node ;;
    npm) command -v npm ;;
    *) false ;;
  esac >/dev/null
}
missing=$(while read -r name purpose; do
  [ -z "$name" ] || provided_otherwise "$name" || printf '%-20s %s\n' "$name" "$purpose"
done <<<"$missing")
if [ -z "$missing" ]; then
  make_venv "$@"
  exit 0
fi

echo "meshgraft needs these Debian packages, and installs them now:"
sed 's/^/  /' <<<"$missing"
names=$(awk '{print $1}' <<<"$missing")

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "Neither root nor sudo: please have them installed with" >&2
    echo "  apt-get install" $names >&2
    exit 1
  fi
  as_root=(sudo)
fi

install() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $names
}
"${as_root[@]}" apt-get update -qq || echo "bootstrap: apt-get update failed; trying with the lists there are" >&2
if ! install; then
  echo "Installing failed. Please install by hand, then run make again:" >&2
  echo "  apt-get install" $names >&2
  exit 1
fi
make_venv "$@"
