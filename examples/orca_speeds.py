"""Agents of ORCA (the package pyrvo) get their preferred speeds from a motion model.

pip install "walklab[simulators]"
python examples/orca_speeds.py [MODEL.safetensors]
"""

from __future__ import annotations

import sys

import numpy as np
import pyrvo
from simulators import CORRIDOR_M, WALK_M, model_from, report, wished_speeds

STEP_S = 0.1
RADIUS_M = 0.25
HEIGHTS_M = np.array([1.66, 1.72, 1.78, 1.83])


def main(arguments: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Walk all agents side by side down the corridor; their wished speeds (m/s) and the distances walked (m)."""
    wished = wished_speeds(model_from(arguments), HEIGHTS_M, np.random.default_rng(1))
    simulation = pyrvo.RVOSimulator()
    simulation.set_time_step(STEP_S)
    simulation.set_agent_defaults(2.0, 10, 2.0, 2.0, RADIUS_M, 2.0)
    places = np.column_stack([np.full(len(wished), 1.0), np.linspace(0.5, CORRIDOR_M[1] - 0.5, len(wished))])
    agents = [simulation.add_agent(tuple(place)) for place in places]
    steps = int(WALK_M / wished.max() / STEP_S)  # until the fastest has walked its way
    for agent, speed in zip(agents, wished, strict=True):
        simulation.set_agent_max_speed(agent, float(speed))
    for _ in range(steps):
        for agent, speed in zip(agents, wished, strict=True):
            simulation.set_agent_pref_velocity(agent, (float(speed), 0.0))
        simulation.do_step()
    ends = [simulation.get_agent_position(agent) for agent in agents]
    walked = np.array([end.x for end in ends]) - places[:, 0]
    report("ORCA", wished, walked, steps * STEP_S)
    return wished, walked


if __name__ == "__main__":
    main(sys.argv[1:])
