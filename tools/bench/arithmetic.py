# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""What figures are made of: medians, percentiles, moments in a run, and Amdahl's law."""
import math


def median(values):
    return percentile(values, 0.5)


def percentile(values, part):
    """Between the neighbouring values, in proportion; None of nothing."""
    ordered = sorted(values)
    if not ordered:
        return None
    position = part * (len(ordered) - 1)
    low = math.floor(position)
    high = min(low + 1, len(ordered) - 1)
    return ordered[low] + (position - low) * (ordered[high] - ordered[low])


def quotient(value, by):
    return None if value is None or not by else value / by


def geometric_mean(values):
    """None of nothing, or where one is not known or not above 0."""
    if not values or any(value is None or value <= 0 for value in values):
        return None
    return math.exp(sum(map(math.log, values)) / len(values))


def within(points, first, last):
    """Values of the points (position, value) with first < position <= last."""
    return [value for position, value in points if first < position <= last]


def seconds_at(samples, images):
    """When so many images had been published: the first of the samples (seconds, images) that knows of them,
    moved back in proportion to the images that came since the sample before. None: never."""
    before = (0.0, 0)
    for seconds, count in samples:
        if count >= images:
            new = count - before[1]
            part = (images - before[1]) / new if new > 0 else 0.0
            return before[0] + part * (seconds - before[0])
        before = (seconds, count)
    return None


def karp_flatt(speed_up, threads):
    """The serial fraction that a speed-up on `threads` > 1 threads speaks for (Karp & Flatt, CACM 1990)."""
    return (1 / speed_up - 1 / threads) / (1 - 1 / threads)


def amdahl_fit(seconds):
    """Serial fraction s of Amdahl's law T(p) = T(1) (s + (1 - s) / p), by least squares over the relative times.

    @param seconds  {threads: seconds}, 1 thread among them; None when there is nothing to fit
    """
    one = seconds[1]
    upper = lower = 0.0
    for threads, time in seconds.items():
        free = 1 - 1 / threads
        upper += free * (time / one - 1 / threads)
        lower += free * free
    return upper / lower if lower > 0 else None


def scaling_rows(seconds):
    """@return [(threads, seconds, speed-up, efficiency, serial fraction or None)], ascending"""
    one = seconds[1]
    rows = []
    for threads in sorted(seconds):
        speed_up = one / seconds[threads]
        rows.append((threads, seconds[threads], speed_up, speed_up / threads,
                     karp_flatt(speed_up, threads) if threads > 1 else None))
    return rows


def thread_counts(most):
    """1, 2, 4, … and the most."""
    counts = [1]
    while counts[-1] * 2 < most:
        counts.append(counts[-1] * 2)
    return sorted({*counts, most})
