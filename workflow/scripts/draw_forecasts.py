"""Scores, calibration and PIT of the forecasts of the held-out scenarios."""

from adapter import job
from walklab.figures.forecasts import fig_calibration, fig_forecast_scores, fig_pit
from walklab.figures.style import save
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        scores, calibration = read_table(snakemake.input.scores), read_table(snakemake.input.calibration)
        figures = (fig_forecast_scores(scores), fig_calibration(calibration, scores), fig_pit(calibration))
        for number, figure in enumerate(figures):
            save(figure, *snakemake.output[2 * number : 2 * number + 2])
