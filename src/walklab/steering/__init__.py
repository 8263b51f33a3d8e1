"""Suitability maps, the dependency blending space and the motion models learned from it."""
