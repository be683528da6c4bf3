# SPDX-License-Identifier: MIT
"""`python -m verisim` is the verisim command."""

from verisim.cli import main

main()
