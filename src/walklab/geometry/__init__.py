"""Plane curves, scenes and moments of standing: what capture and planning both need."""
