"""Every number of the synthetic capture, with where it comes from.

Nothing else under ``walklab.capture`` holds a number that shapes how people walk. A figure
given with "chosen" is a choice inside the range that the named work reports, not a figure
it states. The published *results* of Agethen et al. 2017 (``claims``) had no influence on
any of them.

Sources
-------
Bohannon 1997: Comfortable and maximum walking speed of adults aged 20-79 years, Age and Ageing 26:15-19.
Seethapathi & Srinivasan 2015: The metabolic cost of changing walking speeds is significant, implies lower optimal
    speeds for shorter distances, Biology Letters 11:20150486 (with its open data of preferred speeds at 0.5 to 89 m).
Carlisle & Kuo 2023: Optimization of energy and time predicts dynamic speeds for human walking, eLife 12:e81939.
Wong, Darici & Kuo 2026: On attaining and estimating steady walking speed (preprint).
Maroger et al. 2020, IROS: 400 goal-directed walks of 10 people; peak speeds by distance (``shared/data/maroger_laas``).
Vieilledent et al. 2001, Neuroscience Letters 305; Hicheur et al. 2005, Experimental Brain Research 162: the power law
    between speed and curvature in human locomotion.
Brown, Seethapathi & Srinivasan 2021: A unified energy-optimality criterion predicts human navigation paths and
    speeds, PNAS 118 (preprint arXiv:2001.02287).
Sekiya et al. 1996: the invariant ratio of step length to step rate in free walking.
Orendurff et al. 2004: The effect of walking speed on center of mass displacement, J Rehabil Res Dev 41:829-834.
Alexander 1989: Optimization and gaits in the locomotion of vertebrates, Physiological Reviews 69 (dynamic similarity).
Niehorster, Li & Lappe 2017: accuracy and precision of the HTC Vive, i-Perception 8.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace


@dataclass(frozen=True)
class Spread:
    """A person's trait over the population: normal, cut at ``reach`` standard deviations."""

    mean: float
    sd: float
    reach: float = 2.0


@dataclass(frozen=True)
class Physique:
    """How stature, mass and torso depth hang together.

    Attributes
    ----------
    sex_shift_sd : women's mean stature below men's, in standard deviations of the men (about 13 cm of 7 cm in
        European anthropometric surveys such as DIN 33402-2; the groups' own limits cut it)
    height_mass_correlation : 0.4 to 0.55 in military surveys (ANSUR); chosen
    age_log_sd : the published ages (19 to 59 around 26) lean to the right; ages enter as exp(normal)
    torso_depth_m : at ``torso_reference_bmi``; chosen within the 0.22 to 0.26 m of adult chest and abdominal depths
    torso_depth_sd_m : what body-mass index does not explain; chosen
    body_mass_index, body_mass_index_sd : where a group's mass is not published; adults in their twenties, chosen
    """

    sex_shift_sd: float = 1.8
    height_mass_correlation: float = 0.5
    age_log_sd: float = 0.8
    torso_depth_m: float = 0.235
    torso_reference_bmi: float = 23.7
    torso_depth_sd_m: float = 0.008
    body_mass_index: float = 23.7
    body_mass_index_sd: float = 2.5


@dataclass(frozen=True)
class WalkerConstants:
    """How people walk, stand, bend and are seen; the module docstring names the sources.

    The groups in order: speed, gait, path, repetition, standing, work, sensor, long distances.
    """

    physique: Physique = field(default_factory=Physique)

    # --- speed ---
    # Bohannon 1997, table 2: comfortable speed by decade of age, m/s (20s, 30s, 40s, 50s, 60s, 70s).
    comfortable_men_m_s: tuple[float, ...] = (1.393, 1.458, 1.462, 1.393, 1.359, 1.330)
    comfortable_women_m_s: tuple[float, ...] = (1.407, 1.415, 1.391, 1.395, 1.296, 1.272)
    # Bohannon 1997: standard deviations of 0.09 to 0.23 m/s in these groups; as a ratio of the mean, what height leaves.
    comfortable_ratio: Spread = Spread(1.0, 0.10)
    # The norms are means over a timed distance; the speed that a walk tends to lies above its mean. Chosen so that the peak
    # speeds of walks from 3 m on lie in the interquartile range of the walks of Maroger et al.
    peak_over_norm: float = 1.09
    # Alexander 1989: at dynamic similarity speed grows with the square root of stature; it gives a correlation
    # with height like the 0.22 or more that Bohannon reports. Means of his adults, chosen.
    height_exponent: float = 0.5
    reference_height_men_m: float = 1.77
    reference_height_women_m: float = 1.64
    # Peak speed grows with the distance and nears comfortable speed at about 10 m (Wong et al.; Carlisle & Kuo):
    # peak = comfortable * (1 - shortfall * exp(-length / distance_constant)). Both numbers chosen so that peak speeds lie
    # in the interquartile range of the walks of Maroger et al., and mean speeds in the range of Seethapathi & Srinivasan's data.
    short_walk_shortfall: float = 0.55
    distance_constant_m: Spread = Spread(2.2, 0.25)
    distance_constant_speed_correlation: float = 0.55  # Wong, Darici & Kuo: rho = 0.55 with preferred speed
    # Two to three steps to and from steady speed (Carlisle & Kuo, figures of speed over time); at about 1.8 steps/s. Chosen.
    start_time_s: Spread = Spread(1.40, 0.11)
    stop_time_s: Spread = Spread(1.50, 0.12)
    # Power law of speed and curvature with an exponent of about a third (Vieilledent et al.; Hicheur et al.).
    turn_exponent: Spread = Spread(0.33, 0.05)
    # Curvature from which it is felt: chosen, gives about 0.83 of the straight speed on a circle of 1 m radius,
    # as in the circle walks of Brown et al.
    turn_onset_1_m: float = 0.7
    turn_look_ahead_m: float = 0.35  # speed adapts over about half a step length; chosen

    # --- gait ---
    walk_ratio_m_min: Spread = Spread(0.0064, 0.0005)  # step length / steps per minute: Sekiya et al. 1996, chosen in their range
    # Orendurff et al. 2004: medio-lateral excursion 7.0 cm at 0.7 m/s to 3.9 cm at 1.6 m/s, i.e. half of it as amplitude.
    sway_lateral_m: Spread = Spread(0.020, 0.004)
    # The forward speed of the centre of mass swings by about 0.1 m/s within a step of comfortable walking; chosen.
    sway_fore_aft_m: Spread = Spread(0.007, 0.0015)
    sway_onset_m_s: float = 0.4  # below this speed the steps are too short for a full sway; chosen

    # --- path ---
    # Centre of mass to the edge of an obstacle that is passed: half a shoulder breadth (0.23 m) and 0.1 to 0.3 m of
    # personal space (Gerin-Lajoie, Richards & McFadyen 2005 found personal space of that order); chosen.
    clearance_m: Spread = Spread(0.42, 0.045)
    least_clearance_m: float = 0.25  # nobody's centre comes closer than half a shoulder breadth
    freedom_at_station_m: float = 0.6  # near the place of work people do not keep their clearance; chosen
    rounding_m: Spread = Spread(0.16, 0.025)  # corners are rounded over about a quarter of a step length; chosen
    wander_ratio: Spread = Spread(0.010, 0.003)  # slow lateral deviation per metre of path; chosen, a few centimetres at 4 m
    wander_modes: int = 3

    # --- repetition: the same person again ---
    # Bohannon 1997: reliability above 0.903 -> within-person deviation below sqrt(1 - 0.903) of 11 % = 3.5 %; the three trials
    # a distance of Seethapathi & Srinivasan differ by about 5 % at short distances.
    repeated_speed_sd: float = 0.045
    repeated_start_stop_sd: float = 0.08  # chosen
    place_scatter_m: float = 0.018  # where on a mark people come to stand; chosen, cut at place_reach_m
    place_reach_m: float = 0.045

    # --- standing ---
    # Quiet standing: the centre of mass moves a few millimetres, at about 5 mm/s; two cascaded low passes. Chosen.
    standing_sway_m: float = 0.003
    standing_sway_slow_s: float = 1.5
    standing_sway_fast_s: float = 0.3
    standing_jitter_s: float = 0.4  # counting five seconds is not exact; chosen

    # --- work between the walks of experiment 2 (all chosen; the paper gives only what is done) ---
    pause_before_bending_s: tuple[float, float] = (0.05, 0.5)
    bending_down_s: tuple[float, float] = (0.8, 1.2)
    bending_hold_s: tuple[float, float] = (0.6, 1.4)
    upright_reach_m: float = 1.2  # at and above this height nobody bends
    pelvis_tilt_rad_per_m: float = 0.95  # forward tilt per metre of lower reach: about 33 degrees for a shelf at 0.6 m
    pelvis_back_per_m: float = 0.17  # the hip goes back as the hands go forward: 10 cm for a shelf at 0.6 m
    pelvis_down_per_m: float = 0.25
    turning_time_s: tuple[float, float] = (0.8, 1.3)  # turning on the spot towards or away from the work
    fastening_s: tuple[float, float] = (3.0, 6.0)
    pelvic_rotation_rad: float = 0.07  # about 4 degrees to each side with each stride
    pelvis_height_ratio: float = 0.56  # of stature, height of the belt: near the centre of mass

    # --- sensors ---
    optical_noise_m: float = 0.0003  # whole-body centre of mass from passive markers: tenths of a millimetre; chosen
    belt_noise_m: float = 0.0006  # Niehorster et al. 2017: sub-millimetre precision; worn on a belt, chosen at the upper end
    belt_noise_rad: float = 0.0008
    belt_gap_error_m: Spread = Spread(0.0, 0.004)  # the stated distance of controller and skin is not exact for each belt; chosen
    dropouts_per_min: float = 0.8
    dropout_s: tuple[float, float] = (0.01, 0.07)
    long_dropout_s: tuple[float, float] = (0.35, 0.8)  # of the flawed walks
    interruption_s: tuple[float, float] = (0.3, 0.6)  # a stop on the way, of the flawed walks
    shortest_interrupted_m: float = 1.5  # shorter walks are spoilt by a dropout instead

    # --- long distances: calibrated to the captured travel times (Agethen et al. 2017, section 8.3, inputs) ---
    # ASSUME: The people of section 8.3 were told to walk briskly, since the published pace of 1.6 to 1.8 m/s is
    # no comfortable one.
    long_distance_pace: float = 1.135
    # ASSUME: Under that common instruction people differ from each other half as much as at their own choice of speed,
    # since the published interquartile ranges are 8 to 9 % of the medians.
    long_distance_conformity: float = 0.55
    # ASSUME: A brisk start and stop take less than half the time of a comfortable one, since the published times leave
    # about 0.6 s over those of constant speed.
    long_distance_start_stop: float = 0.45

    # --- switches, for negative controls: they act when people walk, not when they are drawn ---
    effect_of_length: bool = True
    effect_of_curvature: bool = True
    effect_of_height: bool = True
    paths_wander: bool = True


def without_dependency_effects(constants: WalkerConstants) -> WalkerConstants:
    """People whose way of walking depends neither on length nor on curvature nor on height.

    Short walks then end before the same start-up has reached the same speed; turns
    are taken at the straight speed; tall people walk no faster.
    """
    return replace(constants, effect_of_length=False, effect_of_curvature=False, effect_of_height=False)


def without_repetition_variation(constants: WalkerConstants) -> WalkerConstants:
    """People who repeat a walk exactly, seen by perfect sensors."""
    return replace(
        constants,
        repeated_speed_sd=0.0,
        repeated_start_stop_sd=0.0,
        place_scatter_m=0.0,
        paths_wander=False,
        standing_sway_m=0.0,
        optical_noise_m=0.0,
        belt_noise_m=0.0,
        belt_noise_rad=0.0,
        dropouts_per_min=0.0,
    )
