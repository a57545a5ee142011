"""Meaning of a trial's arrays in one sentence each, for message definitions and dataset cards."""

from __future__ import annotations

import json

from slipbench._export.series import Series
from slipbench.bin import _core

_RULES = {rule.name: rule.meaning for rule in _core.label_rules()}
# By the array's name in the group `labels`.
LABELS = {
    "state": f"slip state of the pad, rule strict: {_RULES['strict']}",
    "state_micro": f"slip state of the pad, rule micro: {_RULES['micro']}",
    "state_paper": f"slip state of the pad by {_RULES['paper']}",
    "state_recorded": "slip state of the pad as labelled in an imported recording",
    "unit_state": "contact state of each unit",
    "slip_velocity": "velocity at which the tip of each unit slips, x and y in the contact plane; 0 while the tip sticks",
    "slip_distance": "path that each unit has slipped since the beginning of the trial",
    "margin": "1 - tangential force / (static friction x normal force) of each unit: 0 at the limit; NaN without contact",
    "force": "true force on each unit, without noise: x and y tangential, z normal, in the contact plane",
    "stuck_fraction": "share of the touching elements that stick, 0 to 1; NaN without contact",
    "slip_direction": "direction of the slip's translation; NaN without slip",
    "slip_centre": "centre of the slip's rotation, x and y in the pad's plane; NaN without rotation",
    "slip_angle": "accumulated rotation of the slip",
    "kind": "change of a unit's contact state",
    "detector_class": "slip state that the detector of the control loop reported",
}


def codes_of(series: Series) -> dict[str, int]:
    """Codes of an array, word to number; empty for other arrays."""
    return dict(json.loads(series.codes)) if series.codes else {}
