# SPDX-License-Identifier: MIT
"""What can be wrong with a request for maps."""

from __future__ import annotations


class BenchError(RuntimeError):
    """The maps cannot be run as asked; the message ends in a hint."""
