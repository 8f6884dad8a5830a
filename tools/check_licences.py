#!/usr/bin/env python3
"""Holds what is linked and included against the table of THIRD_PARTY.md.

    tools/check_licences.py [--root ROOT] BINARY…

Every shared library that a binary is linked to, directly or through another one, and every header of another project
that src, include, cli or python includes has to stand in the table's last column. No row of what is passed on may be under the
GPL, but for the compiler's runtime with its exception, and none under the LGPL that is not linked dynamically. The
packages of the page have the licences that its lock file names. Prints each violation and exits with 1 if there are any.
"""

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

INCLUDE = re.compile(r"^\s*#\s*include\s*<([^>]+)>")
GPL = re.compile(r"\bA?GPL")
LGPL = re.compile(r"\bLGPL")
RUNTIME_EXCEPTION = "with the runtime library exception"
DYNAMICALLY = "linked dynamically"
OURS = "meshgraft/"
# Headers of C++ have no ending; those of C and POSIX have no folder, or one of these.
SYSTEM_FOLDERS = ("sys/",)
SYSTEM_HEADERS = {"cpuid.h", "dlfcn.h", "fcntl.h", "malloc.h", "poll.h", "signal.h", "spawn.h", "termios.h", "unistd.h"}


class Row:
    def __init__(self, cells):
        self.project = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", cells[0])
        self.licence, self.where = cells[1], cells[3]
        names = re.findall(r"`([^`]+)`", cells[4])
        self.headers = {name for name in names if name.endswith(("/", ".h", ".hpp"))}
        self.libraries = set(names) - self.headers

    def is_passed_on(self):
        """True for what is in the binaries or the page, or linked by them."""
        return not re.search(r"\bonly\b", self.where)


def read_table(page):
    rows = []
    for line in page.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("|") and len(cells) == 5 and cells[0] not in ("project", "---"):
            rows.append(Row(cells))
    return rows


def check_rows(rows):
    for row in rows:
        gpl = GPL.search(row.licence) and not (row.where == "system" and RUNTIME_EXCEPTION in row.licence)
        lgpl = LGPL.search(row.licence) and DYNAMICALLY not in row.licence
        if row.is_passed_on() and (gpl or lgpl):
            yield f"THIRD_PARTY.md: {row.project} is under {row.licence} and would be passed on ({row.where})"


def check_page(root):
    lock = root / "page" / "package-lock.json"
    if not lock.exists():
        return
    for name, package in json.loads(lock.read_text(encoding="utf-8"))["packages"].items():
        licence = package.get("license", "no licence")
        if name and not package.get("dev") and (GPL.search(licence) or LGPL.search(licence) or "license" not in package):
            yield f"page/package-lock.json: {name} is under {licence} and would be passed on"


def is_of_system(header):
    return ("." not in header and "/" not in header) or header in SYSTEM_HEADERS or header.startswith(SYSTEM_FOLDERS)


def check_includes(root, rows):
    allowed = [name for row in rows if row.is_passed_on() for name in row.headers]
    for folder in ("include", "src", "cli", "python"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                found = INCLUDE.match(line)
                if not found or found[1].startswith(OURS) or is_of_system(found[1]):
                    continue
                if not any(found[1] == name or (name.endswith("/") and found[1].startswith(name)) for name in allowed):
                    yield f"{path.relative_to(root)}:{number}: THIRD_PARTY.md has no row for <{found[1]}>"


def linked_libraries(binary):
    """Names as in the table, without their versions."""
    ldd = subprocess.run(["ldd", str(binary)], capture_output=True, text=True)
    if ldd.returncode != 0:
        raise ValueError(f"{binary}: ldd cannot read it: {(ldd.stderr or ldd.stdout).strip()}")
    for line in ldd.stdout.splitlines():
        if "statically linked" not in line:
            yield re.sub(r"\.so\b.*$", "", Path(line.split()[0]).name)


def check_binary(binary, rows):
    allowed = {name for row in rows if row.is_passed_on() for name in row.libraries}
    try:
        linked = set(linked_libraries(binary))
    except ValueError as problem:
        yield str(problem)
        return
    for library in sorted(linked - allowed):
        yield f"{binary}: THIRD_PARTY.md has no row for {library}, to which it is linked"


def check(root, binaries):
    rows = read_table((root / "THIRD_PARTY.md").read_text(encoding="utf-8"))
    if not rows:
        return ["THIRD_PARTY.md: no table"]
    problems = [*check_rows(rows), *check_page(root), *check_includes(root, rows)]
    for binary in binaries:
        problems += check_binary(binary, rows)
    return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    parser.add_argument("binaries", nargs="*", type=Path, metavar="BINARY")
    arguments = parser.parse_args()
    problems = check(arguments.root, arguments.binaries)
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
