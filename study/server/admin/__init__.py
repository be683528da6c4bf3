# SPDX-License-Identifier: MIT
"""The researcher's page: a port of its own, a login, and a record of everything done there."""
