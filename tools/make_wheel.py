#!/usr/bin/env python3
"""Makes a wheel of the Python package that needs nothing but Python and the C++ runtime of the system.

    build/venv/bin/python tools/make_wheel.py [--python PYTHON] [--to FOLDER]

Runs in the environment that tools/bootstrap.sh makes. The wheel has the extension module, the program with the editor,
the libraries that they are linked to (auditwheel copies them into it), and the licences of all these. Its BLAS is that
of scipy-openblas32, which has kernels for old and new processors and chooses among them when it is loaded.

PYTHON is the interpreter that the wheel is for; without, the environment's own. From 3.12 on the wheel is for it and
all later ones (abi3). Prints the path of the wheel.
"""

import argparse
import importlib.metadata
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WORK = ROOT / "build" / "wheel"
COPYRIGHTS = Path("/usr/share/doc")
COMMON_LICENCES = Path("/usr/share/common-licenses")
# Tools of the group build of tools/packages.txt, of which nothing is in the binaries.
TOOLS = {"g++", "cmake", "ninja-build", "python3", "nodejs", "npm"}
# Packages of libraries that stay those of the system.
RUNTIME = {"libc6", "libgcc-s1", "libstdc++6"}


def run(*command, **options):
    """Runs a command quietly. Shows what it said and exits if it fails."""
    done = subprocess.run([str(part) for part in command], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{done.stdout}\nmake_wheel: {' '.join(map(str, command))} failed")
    return done.stdout


def openblas():
    """The folder of scipy-openblas32, the one of its library, and its distribution's files."""
    try:
        import scipy_openblas32
    except ImportError:
        sys.exit(f"make_wheel: {sys.executable} has no scipy-openblas32. 'tools/bootstrap.sh test' makes build/venv, "
                 "which has it.")
    library = Path(scipy_openblas32.get_lib_dir())
    return library.parent, library, importlib.metadata.distribution("scipy-openblas32")


def requirement(name):
    lines = (ROOT / "python/requirements.txt").read_text(encoding="utf-8").splitlines()
    return next(line for line in lines if line.startswith(f"{name}=="))


def builder(python):
    """The interpreter to build with: this one, or an environment of the other one with what a build needs."""
    version = run(python, "-c", "import sys; print('{}.{}'.format(*sys.version_info))").strip()
    own = "{}.{}".format(*sys.version_info)
    if version == own:
        return Path(sys.executable), version
    folder = WORK / f"venv-{version}"
    if not (folder / "ready").exists():
        shutil.rmtree(folder, ignore_errors=True)
        run(python, "-m", "venv", folder)
        run(folder / "bin/python", "-m", "pip", "install", "-q", requirement("nanobind"),
            requirement("scikit-build-core"))
        (folder / "ready").touch()
    return folder / "bin/python", version


def build(python, version, blas_root, to):
    """Builds the wheel as pip does, with the libraries where they are on this system."""
    options = [f"cmake.define.DenseKernels_ROOT={blas_root}"]
    if tuple(map(int, version.split("."))) >= (3, 12):
        options.append("wheel.py-api=cp312")
    shutil.rmtree(to, ignore_errors=True)
    # The compiler by the name that CMake knows it by, rather than Python: ccache then has most objects already.
    compilers = {"CC": os.environ.get("CC", "cc"), "CXX": os.environ.get("CXX", "c++")}
    run(python, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--disable-pip-version-check", "-w", to,
        *(f"--config-settings={option}" for option in options), ".", env={**os.environ, **compilers})
    return next(to.glob("*.whl"))


def linked_libraries(wheel, library_folder):
    """Paths of all libraries that the wheel's binaries are linked to."""
    folder = WORK / "unpacked"
    shutil.rmtree(folder, ignore_errors=True)
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    environment = {**os.environ, "LD_LIBRARY_PATH": str(library_folder)}
    binaries = [*folder.glob("meshgraft/_core*.so"), *folder.glob("meshgraft/bin/*")]
    return {Path(match[1]) for binary in binaries
            for match in re.finditer(r"=> (/\S+)", run("ldd", binary, env=environment))}


def package_of(file):
    """The Debian package of a library or header. dpkg may know it by its path with or without /usr."""
    for path in (file, file.resolve(), Path("/usr") / file.relative_to("/")):
        done = subprocess.run(["dpkg", "-S", str(path)], capture_output=True, text=True)
        if done.returncode == 0:
            return done.stdout.split(":")[0]
    sys.exit(f"make_wheel: {file} is of no Debian package, and its licence is unknown")


def built_with():
    """The packages whose headers are compiled into the binaries."""
    lines = (ROOT / "tools/packages.txt").read_text(encoding="utf-8").splitlines()
    packages = {line.split()[1] for line in lines if line.startswith("build ")} - TOOLS
    # libboost-dev only names the package of the current version.
    return packages - {"libboost-dev"} | {package_of(Path("/usr/include/boost/version.hpp"))}


def notices(packages, distributions):
    """The licences of everything in the wheel that is not meshgraft's own, as one text."""
    texts, seen, common = [], set(), set()
    for package in sorted(packages):
        text = (COPYRIGHTS / package / "copyright").read_text(encoding="utf-8", errors="replace")
        if package.startswith("libboost"):
            # Boost's licence asks for no notices of compiled code. Those of all its files would be 2 MB.
            text = re.search(r"^License: BSL-1\.0\n(?: .*\n)+", text, re.MULTILINE)[0]
        common |= {name for name in ("Apache-2.0", "LGPL-2.1", "MPL-2.0") if f"common-licenses/{name}" in text}
        if text not in seen:
            texts.append((package, text))
        seen.add(text)
    for distribution in distributions:
        files = [file for file in distribution.files if re.search(r"licen[cs]e", file.name, re.IGNORECASE)]
        texts += [(distribution.name, file.locate().read_text(encoding="utf-8")) for file in files]
        # robin-map, which nanobind brings, has its licence at the head of its source.
        heads = [file for file in distribution.files if file.name == "robin_map.h"]
        texts += [("robin-map", file.locate().read_text(encoding="utf-8").split("*/")[0]) for file in heads]
    texts += [(name, (COMMON_LICENCES / name).read_text(encoding="utf-8")) for name in sorted(common)]
    line = "=" * 100
    return "\n".join(f"{line}\n{name}\n{line}\n\n{text.strip()}\n" for name, text in texts)


def add_notices(wheel, text):
    """Adds a licence file to a wheel. auditwheel writes the wheel's list of files anew."""
    changed = wheel.with_suffix(".part")
    with zipfile.ZipFile(wheel) as old, zipfile.ZipFile(changed, "w", zipfile.ZIP_DEFLATED) as new:
        for entry in old.infolist():
            content = old.read(entry)
            if entry.filename.endswith(".dist-info/METADATA"):
                own = b"License-File: LICENSE\n"
                content = content.replace(own, own + b"License-File: NOTICES.txt\n", 1)
                new.writestr(entry.filename.replace("METADATA", "licenses/NOTICES.txt"), text)
            new.writestr(entry, content, zipfile.ZIP_DEFLATED)
    changed.replace(wheel)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--python", default=sys.executable, help="the interpreter that the wheel is for")
    parser.add_argument("--to", type=Path, default=ROOT / "dist", metavar="FOLDER")
    arguments = parser.parse_args()
    if not shutil.which("dpkg"):
        sys.exit("make_wheel: this needs Debian or a system like it, whose packages have the licences of the libraries")
    blas_root, library_folder, blas = openblas()
    python, version = builder(arguments.python)
    wheel = build(python, version, blas_root, WORK / "plain")
    libraries = {library for library in linked_libraries(wheel, library_folder) if library.parent != library_folder}
    packages = {package_of(library) for library in libraries} - RUNTIME | built_with()
    add_notices(wheel, notices(packages, [blas, importlib.metadata.distribution("nanobind")]))

    repaired = WORK / "repaired"
    shutil.rmtree(repaired, ignore_errors=True)
    tools = str(Path(sys.executable).parent)
    run(sys.executable, "-m", "auditwheel", "repair", "--strip", "--wheel-dir", repaired, wheel,
        env={**os.environ, "LD_LIBRARY_PATH": str(library_folder), "PATH": f"{tools}:{os.environ['PATH']}"})
    arguments.to.mkdir(parents=True, exist_ok=True)
    made = next(repaired.glob("*.whl"))
    print(shutil.move(made, arguments.to / made.name))


if __name__ == "__main__":
    main()
