#!/usr/bin/env python3
"""Checks that no source includes upward, or uses what only some operating systems have.

    tools/check_layers.py [ROOT]          check
    tools/check_layers.py --draw [ROOT]   draw into docs/architecture.md what is checked

Prints each violation as file:line and exits with 1 if there are any. The layers and what each may use are read from
src/*/CMakeLists.txt (target_link_libraries), the folders of a layer stand in ROOMS; docs/architecture.md explains them.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LINKED = re.compile(r"target_link_libraries\(\s*meshgraft_layer_(\w+)([^)]*)\)")
DECLARED = re.compile(r"^meshgraft_layer\((\w+)\)", re.MULTILINE)


def read_uses(root):
    """Returns the layers that each layer may use, as the build system links them."""
    uses = {}
    for path in sorted((root / "src").rglob("CMakeLists.txt")):
        text = re.sub(r"#.*", "", path.read_text(encoding="utf-8"))
        for layer in DECLARED.findall(text):
            uses.setdefault(layer, set())
        for layer, linked in LINKED.findall(text):
            uses.setdefault(layer, set()).update(re.findall(r"\bmeshgraft_layer_(\w+)", linked))
    uses.pop("facts", None)  # data, no folder
    return uses


# Layer: the layers that it may include, directly. What is not a layer here (tests, bench) may include all.
USES = read_uses(ROOT)
USES["cli"] = set(USES) - {"server"}
USES["python"] = USES["cli"] - {"editor"}
for used in USES.values():
    used.add("platform")  # src/core/platform, below all
USES["platform"] = set()

# What a layer is for, in the drawing.
PURPOSE = {
    "core": "Error, Fact, Context, parallel_blocks",
    "mesh": "Mesh, topology, diagnostics, repair, refinement, cuts",
    "select": "descriptions of vertex sets",
    "io": "PLY, OBJ, OFF, STL, glTF, 3MF, selection files",
    "linalg": "LinearSolver: multifrontal, Eigen, iterative",
    "samples": "built-in models",
    "render": "pictures (private)",
    "operators": "weights, local affine maps, A and AᵀA",
    "deform": "handles, Deformer, live frames, quality",
    "baselines": "published methods",
    "merge": "correspondence, graft, seam",
    "script": "edit files, run as steps",
    "distributed": "the same edit over MPI, on PETSc",
    "server": "HTTP and WebSockets (private)",
    "cli": "the program",
    "editor": "sessions of the browser's page (private)",
    "platform": "what the operating system gives (private)",
}

# Folder of a layer: the folders of the same layer whose private headers it may include. "" is the layer's own folder.
ROOMS = {
    "deform": {
        "setup": set(),
        "solve": {"setup"},
        "": {"setup", "solve"},
        "measure": {"setup"},
        "reduced": {"", "setup", "solve"},
        "proxy": {"", "setup", "solve"},
        "live": {"", "setup", "solve", "proxy", "reduced"},
    },
    "mesh": {"": set(), "cut": {""}, "repair": {""}},
    "linalg": {"": set(), "direct": {""}, "iterative": {""}},
}

# Header of a layer: the rooms below it, which must not include it.
FACADES = {"include/meshgraft/deform/deformer.h": {"deform/setup", "deform/solve"}}

# Headers, and folders of them, that only one source file of a layer may include: they stand behind one of our own
# interfaces.
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
        if len(parts) == 2 and path.stem in USES:  # the only header of a layer
            return path.stem
    if parts[0] in ("src", "meshgraft") and len(parts) > 2:
        return parts[1]
    return parts[0] if parts[0] in USES else None


def room_of(path, layer):
    """The folder of a private file within its layer, or None."""
    if path.parts[:2] != ("src", layer) or layer not in ROOMS or path.name == "facts.h":
        return None
    return path.parts[2] if len(path.parts) > 3 else ""


def check_rooms(source, included, layer):
    """What an include from one folder of a layer into another violates, or None."""
    here, there = room_of(source, layer), room_of(included, layer)
    if f"{layer}/{here}" in FACADES.get(included.as_posix(), ()):
        return f"{layer}/{here} lies below {included.name}"
    if here is None or there is None or here == there:
        return None
    for room in (here, there):
        if room not in ROOMS[layer]:
            return f"{layer}/{room} is not in ROOMS"
    return None if there in ROOMS[layer][here] else f"{layer}/{here} must not use {layer}/{there}"


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
            problems.append(f"{source}: not in a known layer; add one to src/CMakeLists.txt")
            continue
        problems += check_platform(root, source)
        for number, line in enumerate((root / source).read_text(encoding="utf-8").splitlines(), start=1):
            match = INCLUDE.match(line)
            if not match:
                continue
            place = f"{source}:{number}"
            name = match[2]
            for single in SINGLE_USE.intersection((Path(name).parts[0], Path(name).name)):
                single_users.setdefault((single, layer), {})[source] = place
                if source.parts[0] == "include":
                    problems.append(f"{place}: a public header includes {name}")
            included = find_included(root, source, match[1], name)
            if included is None and FACTS.fullmatch(name):  # the build makes it
                included = Path("src") / find_layer_of_facts(root, FACTS.fullmatch(name)[1]) / "facts.h"
            if included is None:
                continue
            used = layer_of(included)
            if used == layer and (violation := check_rooms(source, included, layer)):
                problems.append(f"{place}: {violation} ({name})")
            if source.parts[0] == "include" and included.parts[0] != "include":
                problems.append(f"{place}: a public header includes the private {included}")
            if used != layer and used not in USES[layer]:
                problems.append(f"{place}: {layer} must not use {used} ({name})")
    for (header, _), users in sorted(single_users.items()):
        if len(users) > 1:
            problems.append(f"{header} is included by {len(users)} files of a layer, one is allowed: {', '.join(users.values())}")
    return problems


def reduced(uses):
    """The arrows that no path of others stands for."""
    def reach(node, seen):
        for used in uses[node]:
            if used not in seen:
                seen.add(used)
                reach(used, seen)
        return seen

    return {node: sorted(used for used in uses[node]
                         if not any(used in reach(other, set()) for other in uses[node] - {used}))
            for node in uses}


def drawing():
    """The layers and the rooms as Mermaid's flowcharts."""
    lines = ["```mermaid", "flowchart TD"]
    arrows = reduced({layer: USES[layer] for layer in PURPOSE})
    lines += [f'  {layer}["<b>{layer}</b><br/>{PURPOSE[layer]}"]' for layer in arrows]
    lines += [f"  {layer} --> {' & '.join(used)}" for layer, used in arrows.items() if used]
    lines += ["```", "", "Folders of a layer:", "", "```mermaid", "flowchart LR"]
    for layer, rooms in ROOMS.items():
        name = {room: f"{layer}/{room}" if room else layer for room in rooms}
        lines.append(f"  subgraph {layer}_rooms[{layer}]")
        lines += [f'    {layer}_{room or "own"}["{name[room]}"]' for room in rooms]
        lines += [f"    {layer}_{room or 'own'} --> " + " & ".join(f"{layer}_{used or 'own'}" for used in uses)
                  for room, uses in reduced(rooms).items() if uses]
        lines.append("  end")
    return "\n".join([*lines, "```"])


DRAWN = re.compile(r"(?<=<!-- drawn by tools/check_layers.py -->\n).*?(?=\n<!-- end -->)", re.DOTALL)


def draw(root):
    page = root / "docs/architecture.md"
    page.write_text(DRAWN.sub(lambda _: drawing(), page.read_text(encoding="utf-8")), encoding="utf-8")


def check_drawing(root):
    page = root / "docs/architecture.md"
    drawn = DRAWN.search(page.read_text(encoding="utf-8")) if page.exists() else None
    return [] if drawn is None or drawn[0] == drawing() else [f"{page}: not what is checked; run tools/check_layers.py --draw"]


def main(arguments):
    drawn = arguments[:1] == ["--draw"]
    arguments = arguments[drawn:]
    root = Path(arguments[0]) if arguments else ROOT
    count = sum(1 for _ in sources(root.resolve()))
    if count == 0:
        print(f"check_layers: no sources below {root}")
        return 1
    if drawn:
        draw(root)
    problems = check(root) + check_drawing(root)
    for problem in problems:
        print(problem)
    print(f"check_layers: {count} files, {len(problems)} violations")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
