"""Travel times that others have published: what the resampled walks are scaled to.

Sources
-------
Seethapathi & Srinivasan 2015, Biology Letters 11:20150486: preferred mean speeds from stop to stop, about 0.4 to 0.5 m/s
    over 0.5 m and 0.7 to 1.1 m/s over 4 m (the middle of either range is taken).
Agethen et al. 2017, section 8.3 (``inputs``): medians and interquartile ranges of captured travel times over 10, 25 and 50 m.
"""

from __future__ import annotations

import numpy as np

# Distance (m) -> mean speed (m/s) from stop to stop.
SHORT_WALKS = ((0.5, 0.45), (4.0, 0.90))
# Distance (m) -> median and interquartile range of the travel time (s).
LONG_WALKS = {10.0: (6.310, 0.538), 25.0: (15.685, 1.428), 50.0: (29.260, 2.395)}
SLOWEST_M_S = 0.2


def mean_speed_m_s(distance_m: float) -> float:
    """Mean speed of a short walk, on a straight line through the published ones over the logarithm of the distance.

    The line goes on beyond 4 m (the longest way of the scenarios is about 5 m) and below 0.5 m, there not under 0.2 m/s.
    """
    # ASSUME: Between its two published distances mean speed grows with the logarithm of distance, since only the ends are
    # published; a law of constant acceleration would be the planner's.
    (near, slow), (far, fast) = SHORT_WALKS
    share = np.log(distance_m / near) / np.log(far / near)
    return float(max(slow + share * (fast - slow), SLOWEST_M_S))
