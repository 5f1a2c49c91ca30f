"""How far a result lies from the truth of a rendered image set. Only Python's standard library.

    tests/integration/accuracy.py TRUTH_DIR RESULT_DIR      prints the figures of cameras.json, dense.ply and report.json
"""
import json
import math
import pathlib
import random
import statistics
import struct
import sys

SPOT_RADIUS_SLACK = 0.7  # a found defect's centre lies within this share of the true defect's radius ...
MIN_MATCH_MM = 0.8       # ... or within this, whichever is more
CLOUD_SAMPLE = 3000      # points of the dense cloud that are compared
NEIGHBOUR_CELL_MM = 0.75
FRUIT_MARGIN_MM = 1.5


def subtract(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def norm(a):
    return math.sqrt(dot(a, a))


def apply(matrix, vector):
    return [dot(row, vector) for row in matrix]


def transpose(matrix):
    return [list(row) for row in zip(*matrix)]


def mean(vectors):
    return [sum(column) / len(vectors) for column in zip(*vectors)]


def camera_centre(camera):
    """-R^T t of x_cam = R X + t."""
    return [-x for x in apply(transpose(camera["R"]), camera["t"])]


def largest_eigenvector(matrix):
    """Of a symmetric matrix, for its largest eigenvalue: power iteration, shifted so that it is also the largest in size."""
    shift = max(sum(abs(x) for x in row) for row in matrix)
    shifted = [[x + (shift if i == j else 0) for j, x in enumerate(row)] for i, row in enumerate(matrix)]
    vector = [1.0, 0.1, 0.01, 0.001]
    for _ in range(20000):
        product = apply(shifted, vector)
        length = norm(product)
        product = [x / length for x in product]
        if norm(subtract(product, vector)) < 1e-15:
            break
        vector = product
    return vector


def rotation_of(quaternion):
    w, x, y, z = quaternion
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def align(source, target):
    """(scale, R, t) that brings `source` onto `target` best: Horn's closed form with unit quaternions (1987)."""
    source_mean, target_mean = mean(source), mean(target)
    a = [subtract(p, source_mean) for p in source]
    b = [subtract(p, target_mean) for p in target]
    s = [[sum(p[i] * q[j] for p, q in zip(a, b)) for j in range(3)] for i in range(3)]
    n = [[s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]],
         [s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]],
         [s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]],
         [s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]]]
    rotation = rotation_of(largest_eigenvector(n))
    scale = sum(dot(q, apply(rotation, p)) for p, q in zip(a, b)) / sum(dot(p, p) for p in a)
    return scale, rotation, subtract(target_mean, [scale * x for x in apply(rotation, source_mean)])


def transformed(alignment, point):
    scale, rotation, translation = alignment
    return [scale * x + t for x, t in zip(apply(rotation, point), translation)]


def pose_figures(truth, cameras):
    """Figures of the registered cameras, and the alignment of the result with the truth."""
    true_centre = {view["image"]: camera_centre(view) for view in truth["views"]}
    found = [camera for camera in cameras["cameras"] if camera["registered"]]
    centres = [camera_centre(camera) for camera in found]
    targets = [true_centre[camera["image"]] for camera in found]
    alignment = align(centres, targets)
    errors = [norm(subtract(transformed(alignment, c), t)) for c, t in zip(centres, targets)]
    return {"registered": len(found), "of": len(true_centre), "centre_error_mm": statistics.mean(errors),
            "scale_needed": alignment[0]}, alignment


def defect_figures(truth, report, alignment):
    """Every true defect takes the nearest reported one that is near enough; what is left over is false."""
    reported = [d for fruit in report["fruits"] for d in fruit["defects"]]
    false, errors = len(reported), []
    for true in truth["defects"]:
        def distance(defect, true=true):
            return norm(subtract(transformed(alignment, defect["centre_mm"]), true["centre_mm"]))

        limit = max(MIN_MATCH_MM, SPOT_RADIUS_SLACK * math.sqrt(true["area_mm2"] / math.pi))
        nearest = min(reported, key=distance, default=None)
        if nearest is not None and distance(nearest) < limit:
            reported.remove(nearest)
            false -= 1
            errors.append(abs(nearest["area_mm2"] - true["area_mm2"]) / true["area_mm2"])
    return {"true": len(truth["defects"]), "found": len(errors), "false": false,
            "median_area_error": statistics.median(errors) if errors else None}


PLY_TYPES = {"float": "f", "float32": "f", "double": "d", "uchar": "B", "uint8": "B", "int": "i", "uint": "I"}


def read_ply_points(path):
    """x y z of every vertex of a binary little-endian PLY file."""
    data = pathlib.Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    count, layout, names, in_vertex = 0, "<", [], False
    for words in (line.split() for line in data[:end].decode("ascii").splitlines()):
        if words[0] == "element":
            in_vertex = words[1] == "vertex"
            count = int(words[2]) if in_vertex else count
        elif words[0] == "property" and in_vertex:
            layout += PLY_TYPES[words[1]]
            names.append(words[2])
    step = struct.Struct(layout)
    columns = [names.index(axis) for axis in "xyz"]
    rows = step.iter_unpack(data[end:end + count * step.size])
    return [[row[c] for c in columns] for row in rows]


def cell_of(point):
    return tuple(math.floor(x / NEIGHBOUR_CELL_MM) for x in point)


def distance_to_surface(point, centre, cells):
    """|radius of the point - radius of the true skin beside it|, or None when no skin is near."""
    cx, cy, cz = cell_of(point)
    near = [q for dx in (-1, 0, 1) for dy in (-1, 0, 1) for dz in (-1, 0, 1) for q in cells.get((cx + dx, cy + dy, cz + dz), ())]
    if not near:
        return None
    six = sorted((norm(subtract(point, q)), norm(subtract(q, centre))) for q in near)[:6]
    weights = [1 / (distance + 1e-6) for distance, _ in six]
    radius = sum(w * r for w, (_, r) in zip(weights, six)) / sum(weights)
    return abs(norm(subtract(point, centre)) - radius)


def cloud_figures(truth, surface, cloud, alignment):
    """Points on the fruit, and the median distance of a sample of them from the true skin."""
    centre = truth["centre_mm"]
    reach = max(norm(subtract(q, centre)) for q in surface) + FRUIT_MARGIN_MM
    on_fruit = [p for p in (transformed(alignment, point) for point in cloud) if norm(subtract(p, centre)) < reach]
    cells = {}
    for q in surface:
        cells.setdefault(cell_of(q), []).append(q)
    sample = random.Random(1).sample(on_fruit, min(CLOUD_SAMPLE, len(on_fruit)))
    errors = [distance_to_surface(p, centre, cells) for p in sample]
    return {"on_fruit": len(on_fruit), "median_error_mm": statistics.median(math.inf if e is None else e for e in errors)}


def figures(truth_dir, cameras, report, dense_ply):
    """All figures of one result. `dense_ply` is a path."""
    truth_dir = pathlib.Path(truth_dir)
    truth = json.loads((truth_dir / "truth.json").read_text())
    poses, alignment = pose_figures(truth, cameras)
    surface = read_ply_points(truth_dir / "surface.ply")
    return {"poses": poses, "defects": defect_figures(truth, report, alignment),
            "cloud": cloud_figures(truth, surface, read_ply_points(dense_ply), alignment)}


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    result = pathlib.Path(sys.argv[2])
    found = figures(sys.argv[1], json.loads((result / "cameras.json").read_text()),
                    json.loads((result / "report.json").read_text()), result / "dense.ply")
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
