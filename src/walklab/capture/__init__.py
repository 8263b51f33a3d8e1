"""Recordings to walks: synthetic capture, importers, segmentation, centre of mass."""
