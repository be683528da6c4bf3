# SPDX-License-Identifier: MIT
"""Turns an export tree into tables, figures and one report; reads nothing else."""

from verisim.analysis.load import Export, check_export, load_export
from verisim.analysis.problems import AnalysisError, ExportError, Problem
from verisim.analysis.report import SECTIONS, AnalysisResult, analyse

__all__ = [
    "SECTIONS",
    "AnalysisError",
    "AnalysisResult",
    "Export",
    "ExportError",
    "Problem",
    "analyse",
    "check_export",
    "load_export",
]
