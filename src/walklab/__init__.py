"""walklab learns from captured human walks how people steer and simulates them with it."""
