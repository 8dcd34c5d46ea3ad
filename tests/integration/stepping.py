"""The steps of a stepper."""

from __future__ import annotations

from fsi.bodies.configuration import Configuration
from fsi.integration.state import Advance, Step


def run(stepper: Advance, q: Configuration) -> list[Step]:
    steps = [stepper.start(q)]
    while steps[-1].state.t < stepper.schedule.end:
        steps.append(stepper.advance(steps[-1].state))
    return steps
