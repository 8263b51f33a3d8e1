"""Agents of a JuPedSim simulation get their desired speeds from a motion model.

pip install "walklab[simulators]"
python examples/jupedsim_speeds.py [MODEL.safetensors]
"""

from __future__ import annotations

import sys

import jupedsim as jps
import numpy as np
from shapely import box
from simulators import CORRIDOR_M, WALK_M, model_from, report, wished_speeds

HEIGHTS_M = np.array([1.66, 1.72, 1.78, 1.83])


def main(arguments: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Walk all agents side by side down the corridor; their wished speeds (m/s) and the distances walked (m)."""
    wished = wished_speeds(model_from(arguments), HEIGHTS_M, np.random.default_rng(1))
    length_m, width_m = CORRIDOR_M
    simulation = jps.Simulation(model=jps.CollisionFreeSpeedModel(), geometry=box(0, 0, length_m, width_m), dt=0.05)
    exit_area = simulation.add_exit_stage(box(length_m - 0.5, 0, length_m, width_m))
    journey = simulation.add_journey(jps.JourneyDescription([exit_area]))
    places = np.column_stack([np.full(len(wished), 1.0), np.linspace(0.6, width_m - 0.6, len(wished))])
    agents = [
        simulation.add_agent(
            jps.CollisionFreeSpeedModelAgentParameters(
                position=tuple(place), journey_id=journey, stage_id=exit_area, desired_speed=float(speed), radius=0.2
            )
        )
        for place, speed in zip(places, wished, strict=True)
    ]
    steps = int(WALK_M / wished.max() / simulation.delta_time())  # until the fastest has walked its way
    simulation.iterate(steps)
    ends = np.array([simulation.agent(agent).position for agent in agents])
    walked = np.linalg.norm(ends - places, axis=1)
    report("JuPedSim", wished, walked, steps * simulation.delta_time())
    return wished, walked


if __name__ == "__main__":
    main(sys.argv[1:])
