# SPDX-License-Identifier: MIT
"""Speed against accuracy: every method and other engines on the same scenes, one chart each."""

from verisim.bench.chart.run_chart import Result, run_chart

__all__ = ["Result", "run_chart"]
