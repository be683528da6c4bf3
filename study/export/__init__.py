# SPDX-License-Identifier: MIT
"""Export: tidy tables with a codebook, in the Psych-DS layout, from one moment of the database."""

from verisim.study.export.tree import export

__all__ = ["export"]
