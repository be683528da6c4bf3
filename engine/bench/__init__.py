# SPDX-License-Identifier: MIT
"""`verisim bench`: what methods cost and where they fail."""
