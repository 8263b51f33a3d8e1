"""The command ``walklab``."""
