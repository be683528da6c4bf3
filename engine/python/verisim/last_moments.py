# SPDX-License-Identifier: MIT
"""What led to a failure: a pose log of the last moments with every contact in them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from verisim.pose_log import PoseLog

# Arrays of C contacts; each lies at one of the pose log's times. The normal pushes the first of
# the two bodies away from the second; the load is the normal force.
LAST_CONTACTS = (
    "contact_time_s",  # [C]
    "contact_bodies",  # [C, 2] names of bodies, or of a body and the ground
    "contact_place_m",  # [C, 3]
    "contact_normal",  # [C, 3]
    "contact_depth_m",  # [C]
    "contact_load_n",  # [C]
)


@dataclass
class LastMoments:
    """States and contacts before the first failure of a run."""

    poses: PoseLog
    contacts: dict[str, Any]  # by the names in LAST_CONTACTS

    def save(self, file: Path) -> None:
        """Writes FILE.npz: a pose log, which `verisim view --poses` shows, with the contacts."""
        contacts = {name: np.asarray(values) for name, values in self.contacts.items()}
        contacts["contact_bodies"] = np.array(self.contacts["contact_bodies"], dtype=np.str_)
        contacts["contact_bodies"] = contacts["contact_bodies"].reshape(-1, 2)
        self.poses.save(file, contacts)
