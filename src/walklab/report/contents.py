"""What a report is made of, read and ready to be set."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

PX_PER_MM = 1.4 * 96 / 25.4  # enlarged: figures are drawn for a column of paper, with letters too small for a screen


@dataclass(frozen=True)
class ReportFigure:
    """A figure of the run.

    Attributes
    ----------
    category : decides on the section of figures that no section names
    caption : HTML of the caption
    summary : the caption's plain text, read to those who cannot see the image
    image : data URI
    pixels : the PNG file, for print
    size_mm : width and height that it was drawn for
    """

    name: str
    category: str
    caption: str
    summary: str
    image: str
    pixels: bytes
    size_mm: tuple[float, float]

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height on the screen in CSS pixels."""
        return round(self.size_mm[0] * PX_PER_MM), round(self.size_mm[1] * PX_PER_MM)


@dataclass(frozen=True)
class ReportTable:
    """A table of the run: its title, the file it stands in, its data."""

    title: str
    file: str
    frame: pd.DataFrame


@dataclass(frozen=True)
class Contents:
    """Everything the page shows.

    Attributes
    ----------
    record : the run's ``run.json``
    paper : published figures; empty for walks that the paper does not speak of
    maps : of :func:`walklab.report.map_lattice.map_lattice`
    scenes : of :func:`walklab.report.shown_walks.scene_data`
    """

    record: Mapping[str, Any]
    paper: Mapping[str, Any]
    figures: Mapping[str, ReportFigure]
    tables: Mapping[str, ReportTable]
    maps: Mapping[str, Any] | None = None
    scenes: list[Mapping[str, Any]] = field(default_factory=list)

    @property
    def frames(self) -> dict[str, pd.DataFrame]:
        """The tables' data by name."""
        return {name: table.frame for name, table in self.tables.items()}
