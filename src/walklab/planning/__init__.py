"""Planners: Lazy Theta*, path following, and the protocol any other planner follows."""
