#!/usr/bin/env python3
"""Checks that no source includes upward, or uses what only some operating systems have.

    tools/check_layers.py [ROOT]

Prints each violation as file:line and exits with 1 if there are any. The layers and what each may use stand
in USES; docs/architecture.md explains them.
"""

import re
import sys
from pathlib import Path

# Layer: the layers that it may include, directly. What is not a layer here (tests, bench) may include all.
USES = {
    "core": set(),
    "mesh": {"core"},
    "io": {"core", "mesh"},
    "linalg": {"core", "mesh"},
    "samples": {"core", "mesh"},
    "render": {"core", "mesh"},
    "operators": {"core", "mesh", "linalg"},
    "deform": {"core", "mesh", "linalg", "operators"},
    "baselines": {"core", "mesh", "linalg", "operators", "deform"},
    "merge": {"core", "mesh", "linalg", "operators", "deform"},
    "script": {"core", "mesh", "io", "linalg", "samples", "operators", "deform", "baselines", "merge"},
    "server": {"core"},
    "cli": {"core", "mesh", "io", "linalg", "samples", "render", "operators", "deform", "baselines", "merge", "script"},
}
USES["python"] = USES["cli"]
USES["editor"] = USES["cli"] | {"server"}
USES["cli"] = USES["cli"] | {"editor"}
for used in USES.values():
    used.add("platform")  # src/core/platform, below all
USES["platform"] = set()

# Headers, and folders of them, that only one source file may include (of a folder, one of each layer): they stand
# behind one of our own interfaces.
SINGLE_USE = {"camd.h", "meshoptimizer.h", "metis.h", "nanoflann.hpp", "CGAL", "boost"}

SOURCE_SUFFIXES = {".h", ".hpp", ".cpp"}
FACTS = re.compile(r"(\w+)/facts\.h")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')

# The only folder whose sources may use what not every operating system has, and what counts as that: headers,
# functions and constants that hide in standard headers, and paths.
PLATFORM = Path("src/core/platform")
PLATFORM_HEADERS = re.compile(
    r"(arpa|bits|linux|mach|mach-o|net|netinet|sys)/|"
    r"(dirent|dlfcn|fcntl|io|poll|pthread|pwd|sched|semaphore|signal|spawn|syslog|termios|unistd|windows)\.h$")
PLATFORM_FUNCTIONS = re.compile(
    r"\b(fileno|fdopen|mkdtemp|mkstemp|popen|putenv|realpath|setenv|sigaction|unsetenv)\s*\(|\bM_PI\b")
PLATFORM_PATHS = re.compile(r'"(/(?:dev|proc|sys)/[^"]*)"')
STRING_OR_COMMENT = re.compile(r'("(?:\\.|[^"\\])*")|//.*')


def layer_of(path):
    """The layer of a path relative to the root, or None."""
    if path.is_relative_to(PLATFORM):
        return "platform"
    parts = path.parts
    if parts[:2] == ("include", "meshgraft"):
        parts = parts[1:]
    if parts[0] in ("src", "meshgraft") and len(parts) > 2:
        return parts[1]
    return parts[0] if parts[0] in USES else None


def find_included(root, source, bracket, name):
    """The included file relative to the root, or None for one that is not ours."""
    if name.startswith("meshgraft/"):
        return Path("include") / name  # also where the build makes it (core/version.h)
    folders = [root / "src", root / "include"]
    if bracket == '"':
        folders.insert(0, (root / source).parent)
    for folder in folders:
        candidate = (folder / name).resolve()
        if candidate.is_file() and candidate.is_relative_to(root):
            return candidate.relative_to(root)
    return None


def sources(root):
    """Our own sources below the root, relative to it, in a fixed order."""
    for folder in ("include", "src", "cli", "python"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in SOURCE_SUFFIXES:
                yield path.relative_to(root)


def find_platform_use(line):
    """What a line of source uses that not every operating system has, or None."""
    include = INCLUDE.match(line)
    if include:
        return f"<{include[2]}>" if include[1] == "<" and PLATFORM_HEADERS.match(include[2]) else None
    code = STRING_OR_COMMENT.sub(lambda match: match[1] or "", line)
    used = PLATFORM_FUNCTIONS.search(code) or PLATFORM_PATHS.search(code)
    return used[1] if used else None


def check_platform(root, source):
    """Violations in a file that may only use what every operating system has."""
    if source.is_relative_to(PLATFORM):
        return []
    lines = (root / source).read_text(encoding="utf-8").splitlines()
    uses = ((number, find_platform_use(line)) for number, line in enumerate(lines, start=1))
    return [f"{source}:{number}: not every operating system has {use}; call a function of {PLATFORM}, or add one there"
            for number, use in uses if use]


def find_layer_of_facts(root, folder):
    """The layer of the header "FOLDER/facts.h", which the build makes of the table in that folder."""
    return next((path.parent.relative_to(root / "src").parts[0] for path in (root / "src").rglob(f"{folder}/facts.json")),
                folder)


def check(root):
    """A list of violations, as text."""
    root = root.resolve()
    problems = []
    single_users = {}
    for source in sources(root):
        layer = layer_of(source)
        if layer not in USES:
            problems.append(f"{source}: not in a known layer; add it to USES in tools/check_layers.py")
            continue
        problems += check_platform(root, source)
        for number, line in enumerate((root / source).read_text(encoding="utf-8").splitlines(), start=1):
            match = INCLUDE.match(line)
            if not match:
                continue
            place = f"{source}:{number}"
            name = match[2]
            for single in SINGLE_USE.intersection((Path(name).parts[0], Path(name).name)):
                group = "" if single.endswith(".h") else layer
                single_users.setdefault((single, group), {})[source] = place
                if source.parts[0] == "include":
                    problems.append(f"{place}: a public header includes {name}")
            included = find_included(root, source, match[1], name)
            if included is None and FACTS.fullmatch(name):  # the build makes it
                included = Path("src") / find_layer_of_facts(root, FACTS.fullmatch(name)[1]) / "facts.h"
            if included is None:
                continue
            used = layer_of(included)
            if source.parts[0] == "include" and included.parts[0] != "include":
                problems.append(f"{place}: a public header includes the private {included}")
            if used != layer and used not in USES[layer]:
                problems.append(f"{place}: {layer} must not use {used} ({name})")
    for (header, _), users in sorted(single_users.items()):
        if len(users) > 1:
            problems.append(f"{header} is included by {len(users)} files, one is allowed: {', '.join(users.values())}")
    return problems


def main(arguments):
    root = Path(arguments[0]) if arguments else Path(__file__).resolve().parent.parent
    count = sum(1 for _ in sources(root.resolve()))
    if count == 0:
        print(f"check_layers: no sources below {root}")
        return 1
    problems = check(root)
    for problem in problems:
        print(problem)
    print(f"check_layers: {count} files, {len(problems)} violations")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
