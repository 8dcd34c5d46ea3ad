"""CPU seconds by phase."""

from __future__ import annotations

import time


class Clock:
    """CPU seconds of this process by phase."""

    def __init__(self) -> None:
        """Start."""
        self.seconds: dict[str, float] = {}
        self._last = time.process_time()

    def lap(self, phase: str) -> None:
        """Add the time since the last lap to a phase."""
        now = time.process_time()
        self.seconds[phase] = self.seconds.get(phase, 0.0) + now - self._last
        self._last = now
