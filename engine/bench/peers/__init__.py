# SPDX-License-Identifier: MIT
"""Other engines on our scene files: adapters that take a scene and return a pose log.

An optional extra: nothing else needs it. Each engine runs in a process of its own, single-threaded,
at its default settings and at tuned ones.
"""

from __future__ import annotations

from verisim.bench.peers.contestants import CONFIGS, PeerConfig, cannot_pose, contestants
from verisim.bench.peers.driver_run import PeerRun, run_peer, steps_per_frame
from verisim.bench.peers.install import PeerError, install, missing
from verisim.bench.peers.scene import PeerBody, PeerPlane, PeerScene, PeerShape, peer_scene

__all__ = [
    "CONFIGS",
    "PeerBody",
    "PeerConfig",
    "PeerError",
    "PeerPlane",
    "PeerRun",
    "PeerScene",
    "PeerShape",
    "cannot_pose",
    "contestants",
    "install",
    "missing",
    "peer_scene",
    "run_peer",
    "steps_per_frame",
]
