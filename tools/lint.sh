#!/usr/bin/env bash
# Code style (clang-format, all of our C++), analysis (clang-tidy, library and program) and the layers.
#   tools/lint.sh               check; exit status 1 if anything is found
#   tools/lint.sh --fix-format  bring the code into style and do nothing else
set -euo pipefail
cd "$(dirname "$0")/.."

mapfile -t sources < <(git ls-files --cached --others --exclude-standard '*.h' '*.cpp')
if [ "${1:-}" = --fix-format ]; then
  exec clang-format-19 -i "${sources[@]}"
fi

status=0
echo "== clang-format"
for source in "${sources[@]}"; do
  clang-format-19 --dry-run -Werror "$source" 2>/dev/null || { echo "$source: not in style (make format)"; status=1; }
done

echo "== layers"
python3 tools/check_layers.py || status=1

echo "== clang-tidy"
# A compilation database of the configuration that has everything but tests; its headers of facts are made, and nothing
# is compiled.
# Asio does not look for coroutines in this clang, and CGAL's templates name members that they never use.
as_gcc_reads_it=(--extra-arg={-DBOOST_ASIO_HAS_CO_AWAIT,-DBOOST_ASIO_HAS_STD_COROUTINE,-fdelayed-template-parsing})
cmake --preset dev -B build/lint -DMESHGRAFT_BUILD_TESTS=OFF >/dev/null
cmake --build build/lint --target meshgraft_generated >/dev/null
printf '%s\n' "${sources[@]}" | grep -E '^(src|cli)/.*\.cpp$' |
  xargs -P "$(nproc)" -n 1 clang-tidy-19 -p build/lint --quiet "${as_gcc_reads_it[@]}" 2> >(grep -v ' warnings\? generated' >&2) || status=1

[ "$status" -eq 0 ] && echo "lint: nothing found"
exit "$status"
