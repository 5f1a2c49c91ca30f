#!/usr/bin/env python3
"""Fails when a file includes upward, or when the top level holds something that is not on its list.

    tests/layout/check_layout.py [ROOT]

The layers, lower first; a file includes its own folder and what is below it:

    base <- geometry <- image <- scene <- stage folders <- pipeline <- routes <- main
    base <- store, jobs, http <- service, which only a service's own files (pipeline, routes, main) include

A stage folder never includes another stage. A service never includes another; the command line includes the stages and
pipelines of all of them, for it runs them in one process. Headers of slow libraries stay in .cpp files.
"""
import pathlib
import re
import sys

TOP_LEVEL = {"api", "services", "shared", "deploy", "docker", "tests", "build", "CMakeLists.txt", "CMakePresets.json",
             "CMakeUserPresets.json", "LICENSE", "README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md"}

SHARED = {  # folder of shared/ -> the folders of shared/ it may include beside itself
    "base": set(),
    "geometry": {"base"},
    "image": {"base", "geometry"},
    "scene": {"base", "geometry", "image"},
    "store": {"base"},
    "jobs": {"base"},
    "http": {"base"},
    "service": {"base", "store", "jobs", "http"},
}
COMPUTING = {"base", "geometry", "image", "scene"}
SERVING = {"store", "jobs", "http", "service"}
KEEPING = {"store", "jobs", "service"}  # what `drupe store` looks after
RANKS = ["pipeline", "routes", "main"]  # of the files that lie directly in a service's folder

SLOW_HEADERS = re.compile(r"(pcl|ceres|opencv2|CLI|spdlog|prometheus)/|httplib\.h$|arv\.h$|sqlite3\.h$")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def rank_of(file_name):
    """Where a file that lies directly in a service's folder stands: main, routes*, or the pipeline and its helpers."""
    stem = file_name.split(".")[0]
    if stem == "main" or stem.endswith("_test"):
        return "main"
    return "routes" if stem.startswith("routes") or stem.endswith("_routes") else "pipeline"


def place_of(path):
    """(service or None, folder or None, rank or None) of a path below shared/ or services/, written as in an include."""
    parts = path.split("/")
    if parts[0] in SHARED:
        return None, parts[0], None
    if len(parts) == 2:
        return parts[0], None, rank_of(parts[1])
    return parts[0], parts[1], None


def may_include_shared(service, folder, rank, target):
    if service is None:
        return target == folder or target in SHARED[folder]
    if service == "cli":
        return target in COMPUTING | KEEPING
    if rank is not None:
        return target in COMPUTING | SERVING
    return target in COMPUTING


def may_include_service(service, folder, rank, target):
    target_service, target_folder, target_rank = target
    if service is None:
        return False
    if service == "cli":
        return target_service == "cli" or target_rank in (None, "pipeline")
    if service != target_service:
        return False
    if folder is not None:
        return folder == target_folder
    return target_rank is None or RANKS.index(target_rank) <= RANKS.index(rank)


def problem_with(source, target):
    """What is wrong with `source` including `target` (both as written in an include), or None."""
    service, folder, rank = place_of(source)
    to = place_of(target)
    if to[0] is None:
        allowed = may_include_shared(service, folder, rank, to[1])
    else:
        allowed = may_include_service(service, folder, rank, to)
    return None if allowed else f'must not include "{target}": it lies higher or beside, not below'


def check_includes(root, path, source):
    """Yields (line, problem) of one file."""
    with open(path, encoding="utf-8") as lines:
        for number, line in enumerate(lines, 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            kind, target = match.groups()
            if SLOW_HEADERS.search(target) and path.suffix == ".h":
                yield number, f"<{target}> slows every includer: keep it in a .cpp file"
            if kind == "<":
                continue
            generated = (root / "shared" / f"{target}.in").exists()
            if not generated and not any((root / top / target).is_file() for top in ("shared", "services")):
                yield number, f'"{target}" is not a path from the top of shared/ or services/'
            elif problem := problem_with(source, target):
                yield number, problem


def check(root):
    """Every problem of the tree at `root`, as lines to print."""
    problems = []
    for entry in sorted(root.iterdir()):
        if not entry.name.startswith(".") and entry.name not in TOP_LEVEL and not entry.name.startswith("build-"):
            problems.append(f"{entry.name}: not on the list of the top level")
    for top in ("shared", "services"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            source = path.relative_to(root / top).as_posix()
            if top == "shared" and source.split("/")[0] not in SHARED:
                problems.append(f"{top}/{source}: a folder without a layer; give it one in tests/layout/check_layout.py")
                continue
            problems += [f"{top}/{source}:{line}: {text}" for line, text in check_includes(root, path, source)]
    return problems


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve()
    problems = check(root)
    print("\n".join(problems) if problems else "layout: every include points downward")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
