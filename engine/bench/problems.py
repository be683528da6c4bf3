# SPDX-License-Identifier: MIT
"""What can be wrong with a request for a bench."""

from __future__ import annotations


class BenchError(RuntimeError):
    """The bench cannot be run as asked; the message ends in a hint."""
