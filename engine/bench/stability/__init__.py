# SPDX-License-Identifier: MIT
"""Stability maps: where each method fails, written down before it is run."""

from verisim.bench.problems import BenchError
from verisim.bench.stability.run_maps import Result, run_stability

__all__ = ["BenchError", "Result", "run_stability"]
