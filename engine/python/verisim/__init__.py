# SPDX-License-Identifier: MIT
"""Verisim: perceptual studies of simulated physics."""

__version__ = "0.1.0"
