# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Camera centres beside others: aligned by what most of them agree on, so that a wrong few bend nothing."""
import itertools
import math
import random

from arithmetic import median

TRIALS = 800
INLIERS = 2.5   # times the median error, in the last alignments
ROUNDS = 8
FAR = 0.05      # of the reference's bounding box diagonal: wrongly placed


def _mean(points):
    return tuple(sum(point[axis] for point in points) / len(points) for axis in range(3))


def _minus(points, origin):
    return [tuple(a - b for a, b in zip(point, origin)) for point in points]


def _largest_eigenvector(matrix):
    """Of a symmetric matrix, by Jacobi's rotations."""
    size = len(matrix)
    a = [list(row) for row in matrix]
    vectors = [[float(i == j) for j in range(size)] for i in range(size)]
    for _ in range(12):
        if sum(a[i][j] ** 2 for i in range(size) for j in range(i)) <= 1e-26 * sum(a[i][i] ** 2 for i in range(size)):
            break
        for p, q in itertools.combinations(range(size), 2):
            if a[p][q] == 0:
                continue
            angle = 0.5 * math.atan2(2 * a[p][q], a[q][q] - a[p][p])
            c, s = math.cos(angle), math.sin(angle)
            for row in (*a, *vectors):
                row[p], row[q] = c * row[p] - s * row[q], s * row[p] + c * row[q]
            a[p], a[q] = ([c * x - s * y for x, y in zip(a[p], a[q])], [s * x + c * y for x, y in zip(a[p], a[q])])
    best = max(range(size), key=lambda i: a[i][i])
    return [row[best] for row in vectors]


def _rotation(source, target):
    """That turns centred `source` closest to `target` (Horn, JOSA A 1987): the quaternion of the largest eigenvalue."""
    m = [[sum(s[i] * t[j] for s, t in zip(source, target)) for j in range(3)] for i in range(3)]
    trace = m[0][0] + m[1][1] + m[2][2]
    skew = (m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0])
    symmetric = [[m[i][j] + m[j][i] - (trace if i == j else 0.0) for j in range(3)] for i in range(3)]
    w, x, y, z = _largest_eigenvector([[trace, *skew], *([skew[i], *symmetric[i]] for i in range(3))])
    return ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))


def _turned(rotation, point):
    return tuple(sum(row[i] * point[i] for i in range(3)) for row in rotation)


def similarity(source, target):
    """(scale, rotation, mean of source, mean of target), by least squares; None where `source` is one point."""
    mean_s, mean_t = _mean(source), _mean(target)
    source, target = _minus(source, mean_s), _minus(target, mean_t)
    spread = sum(math.hypot(*point) ** 2 for point in source)
    if spread == 0:
        return None
    rotation = _rotation(source, target)
    scale = sum(t[i] * turned[i] for s, t in zip(source, target) for turned in [_turned(rotation, s)]
                for i in range(3)) / spread
    return scale, rotation, mean_s, mean_t


def _errors(fit, source, target):
    scale, rotation, mean_s, mean_t = fit
    moved = (_turned(rotation, point) for point in _minus(source, mean_s))
    return [math.dist([scale * point[i] + mean_t[i] for i in range(3)], there) for point, there in zip(moved, target)]


def _triples(count):
    if math.comb(count, 3) <= TRIALS:
        return itertools.combinations(range(count), 3)
    draw = random.Random(1)
    return (draw.sample(range(count), 3) for _ in range(TRIALS))


def robust_errors(source, target):
    """Distances after the alignment with the least median (Rousseeuw, JASA 1984), then by the inliers of that."""
    best = None
    for triple in _triples(len(source)):
        fit = similarity([source[i] for i in triple], [target[i] for i in triple])
        if fit is None or fit[0] <= 0:
            continue
        errors = _errors(fit, source, target)
        if best is None or median(errors) < median(best):
            best = errors
    for _ in range(ROUNDS if best else 0):
        bound = max(INLIERS * median(best), 1e-12)
        inliers = [i for i, error in enumerate(best) if error <= bound]
        if len(inliers) < 4:
            break
        best = _errors(similarity([source[i] for i in inliers], [target[i] for i in inliers]), source, target)
    return best


def compare(centres, reference):
    """Of images that both have: {name: point} each. None with fewer than four, which say nothing.

    @return common, median and mean error and the greatest, in the reference's units; the median in per cent of the
            extent (root mean square distance from the mean), the greatest in per cent of the bounding box's diagonal,
            and how many are off by more than 5 % of that
    """
    names = sorted(set(centres) & set(reference))
    if len(names) < 4:
        return None
    target = [reference[name] for name in names]
    errors = robust_errors([centres[name] for name in names], target)
    if errors is None:
        return None
    around = _minus(target, _mean(target))
    extent = math.sqrt(sum(math.hypot(*point) ** 2 for point in around) / len(around))
    diagonal = math.dist(*([of(point[axis] for point in reference.values()) for axis in range(3)] for of in (min, max)))
    return {"common": len(names), "median": median(errors), "mean": sum(errors) / len(errors), "most": max(errors),
            "median_of_extent": 100 * median(errors) / extent, "most_of_diagonal": 100 * max(errors) / diagonal,
            "beyond": sum(error > FAR * diagonal for error in errors),
            "far": [name for name, error in zip(names, errors) if error > FAR * diagonal]}


def read_centres(file):
    """{name: point} of lines "photograph x y z"; '#' begins a comment."""
    rows = [line.split() for line in file.read_text().splitlines() if not line.startswith("#")]
    return {row[0]: tuple(float(word) for word in row[1:4]) for row in rows if len(row) >= 4}
