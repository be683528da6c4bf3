# SPDX-License-Identifier: MIT
"""Studies: the server that shows clips and keeps answers, its page, and the export."""
