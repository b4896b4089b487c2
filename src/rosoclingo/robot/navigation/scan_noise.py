"""How noisy a laser is, estimated from its scans."""

import math

import numpy as np

__all__ = ["ScanNoise"]

EVERY = 4  # beams: of so many one is looked at
SLOWLY = 0.1  # part that a new scan has in the estimate
# The median of the absolute value of a normal deviate, and what differences of second order do to noise.
MEDIAN, SECOND = 0.6745, math.sqrt(6.0)


class ScanNoise:
    """Estimates the standard deviation (m) of ranges, ``deviation``, from how they differ from those beside them.

    On what is smooth, as most things are, a range is the mean of its two neighbours but for noise; the median leaves
    out where that is not so. 0.0 before the first scan.
    """

    def __init__(self) -> None:
        self.deviation = 0.0
        self._known = False

    def see(self, ranges: np.ndarray) -> None:
        """Take a scan (m; float64 n), with NaN for beams that hit nothing."""
        bends = np.abs(ranges[:-2:EVERY] - 2.0 * ranges[1:-1:EVERY] + ranges[2::EVERY])
        bends = bends[~np.isnan(bends)]
        if not len(bends):
            return
        found = _median(bends) / (MEDIAN * SECOND)
        self.deviation += (SLOWLY if self._known else 1.0) * (found - self.deviation)
        self._known = True


def _median(values: np.ndarray) -> float:
    """Return the median of some numbers (float64 n): ``np.median`` takes ten times as long for so few."""
    half = len(values) // 2
    ordered = np.sort(values)
    return float(ordered[half] if len(values) % 2 else 0.5 * (ordered[half - 1] + ordered[half]))
