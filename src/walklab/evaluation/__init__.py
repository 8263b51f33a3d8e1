"""Trials, statistics, analyses and the verdict on each published claim."""
