"""Linear mixed models of the travel-time error: participants as random effects."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from scipy.special import stdtr, stdtrit

from walklab.evaluation.pairs import PAIRS, paired


def mixed_model(trials: pd.DataFrame, pairs: Sequence[tuple[str, str]] = PAIRS, column: str = "abs_dt_s") -> pd.DataFrame:
    """Linear mixed models with a random intercept per participant: what the signed-rank test leaves out.

    Two fits (statsmodels ``MixedLM``, REML). ``levels``: error by model, the participant's intercept shared by
    the models, so that the contrasts still count walks as independent. ``differences``: paired difference
    second - first of each pair, the participant's intercept being that person's own benefit, so that the
    interval answers for other participants.

    Intervals and p values are those of Student's t with (participants - 1) degrees of freedom, not of the normal distribution
    that statsmodels takes: the standard error rests on as many people, and with ten of them a normal tail says 1e-45 where t
    says 1e-7. For ``differences`` of people with equally many walks, whose means vary more than their walks explain, that is
    exactly the one-sample t test on the participants' means. For ``levels``, whose contrasts count walks, it is merely the
    more careful choice.

    Returns
    -------
    DataFrame[fit, term, estimate_s, standard_error_s, low_s, high_s, p, participant_sd_s, residual_sd_s, converged]
    """
    names = list(dict.fromkeys(trials["model"]))
    data = trials[["model", "participant"]].assign(error=trials[column].astype(float))
    reference = names[0]
    rows = _fit_mixed(data, f"error ~ C(model, Treatment('{reference}'))", "levels")
    for row in rows:
        row["term"] = row["term"].split("[T.")[-1].rstrip("]") + f" - {reference}" if "[T." in row["term"] else reference
    for first, second in pairs:
        if {first, second} <= set(names):
            table = paired(trials, first, second, column)
            table["error"] = table["second"] - table["first"]
            for row in _fit_mixed(table, "error ~ 1", "differences"):
                rows.append({**row, "term": f"{second} - {first}"})
    return pd.DataFrame(rows)


def intercept_of(differences: pd.DataFrame) -> dict[str, Any]:
    """The mean difference for other participants: the intercept of ``error ~ 1`` with a random intercept per participant.

    Parameters
    ----------
    differences : DataFrame[participant, error]

    Returns
    -------
    dict as a row of :func:`mixed_model`
    """
    return _fit_mixed(differences, "error ~ 1", "differences")[0]


def _fit_mixed(data: pd.DataFrame, formula: str, fit: str) -> list[dict[str, Any]]:
    import statsmodels.formula.api as smf  # late: a second of imports

    empty = {"participant_sd_s": np.nan, "residual_sd_s": np.nan, "converged": False}
    if data["participant"].nunique() < 2 or np.ptp(data["error"]) == 0:
        return [{"fit": fit, "term": "Intercept", "estimate_s": data["error"].mean(), "standard_error_s": np.nan}
                | {"low_s": np.nan, "high_s": np.nan, "p": np.nan} | empty]  # fmt: skip
    with warnings.catch_warnings():
        # Gradient methods stop on the bound of the variance and report absurd errors; Powell's does not.
        # A variance at its bound of zero is an answer here (the column participant_sd_s says so), not a failure.
        warnings.simplefilter("ignore")
        result = smf.mixedlm(formula, data, groups=data["participant"]).fit(reml=True, method="powell")
    spread = {
        "participant_sd_s": float(np.sqrt(max(float(np.asarray(result.cov_re)[0, 0]), 0.0))),
        "residual_sd_s": float(np.sqrt(result.scale)),
        "converged": bool(result.converged),
    }
    freedom = data["participant"].nunique() - 1
    reach = stdtrit(freedom, 0.975)
    return [
        {"fit": fit, "term": term, "estimate_s": float(estimate), "standard_error_s": error}
        | {"low_s": float(estimate - reach * error), "high_s": float(estimate + reach * error)}
        | {"p": float(2 * stdtr(freedom, -abs(estimate) / error))}
        | spread
        for (term, estimate), error in zip(result.fe_params.items(), _standard_errors(result), strict=True)
    ]


def _standard_errors(result: Any) -> list[float]:
    r"""Roots of the diagonal of :math:`(X^T V^{-1} X)^{-1}`, V having the estimated variances.

    Those of statsmodels come from the curvature of the likelihood: the same inside, undefined where the variance between
    participants is at its bound of zero.
    """
    between, within = max(float(np.asarray(result.cov_re)[0, 0]), 0.0), float(result.scale)
    information = np.zeros((result.k_fe, result.k_fe))
    for design in result.model.exog_li:
        total = design.sum(axis=0)
        information += (design.T @ design - between / (within + between * len(design)) * np.outer(total, total)) / within
    return [float(value) for value in np.sqrt(np.diag(np.linalg.inv(information)))]
