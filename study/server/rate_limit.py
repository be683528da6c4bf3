# SPDX-License-Identifier: MIT
"""A token bucket per caller, in memory only: generous to people, firm with loops."""

from __future__ import annotations

import time

RATE_HZ = 50.0  # requests per second, for ever; the page needs about one
BURST = 500.0
MAX_CALLERS = 20_000


class RateLimit:
    def __init__(self) -> None:
        self._buckets: dict[str, tuple[float, float]] = {}  # caller → (tokens left, at)

    def allows(self, caller: str) -> bool:
        """Takes one token of the caller's bucket; False where it is empty."""
        now = time.monotonic()
        left, at = self._buckets.get(caller, (BURST, now))
        left = min(BURST, left + (now - at) * RATE_HZ)
        if left < 1:
            return False
        if len(self._buckets) >= MAX_CALLERS and caller not in self._buckets:
            self._forget_full(now)
        self._buckets[caller] = (left - 1, now)
        return True

    def _forget_full(self, now: float) -> None:
        """Drops buckets that have filled up again: they say the same as no bucket."""
        refill_s = BURST / RATE_HZ
        self._buckets = {c: (n, at) for c, (n, at) in self._buckets.items() if now - at < refill_s}
        if len(self._buckets) >= MAX_CALLERS:
            self._buckets.clear()
