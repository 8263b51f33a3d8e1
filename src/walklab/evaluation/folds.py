"""Group-wise splits: all walks of one participant are left out together, because they are not independent."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from walklab.errors import InputError

Rows = NDArray[np.int64]


def by_participant(participants: Sequence[str] | NDArray[np.str_], least: int = 2) -> dict[str, tuple[Rows, Rows]]:
    """Participant -> rows of everybody else, rows of that participant; sorted by participant.

    Parameters
    ----------
    participants : (W,) who walked
    least : participants that are needed

    Raises
    ------
    InputError
        If there are fewer participants than that.
    """
    from sklearn.model_selection import LeaveOneGroupOut  # late: half a second of imports

    owners = np.asarray(participants, dtype=str)
    count = len(np.unique(owners))
    if count < least:
        raise InputError(f"leave-one-participant-out: {count} participants are too few; at least {least} are needed")
    splits = LeaveOneGroupOut().split(owners, groups=owners)
    return {str(owners[asked[0]]): (known.astype(np.int64), asked.astype(np.int64)) for known, asked in splits}
