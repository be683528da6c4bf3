# SPDX-License-Identifier: MIT
"""A PostgreSQL server of its own for the tests: a new cluster, one socket, gone afterwards."""

from __future__ import annotations

import os
import pwd
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

START_S = 60


def find_programs() -> Path:
    """Returns where Debian's newest PostgreSQL keeps initdb and postgres."""
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"))
    assert found, "PostgreSQL is missing: apt-get install postgresql"
    return found[-1].parent


@contextmanager
def running_postgres() -> Iterator[str]:
    """Yields the folder of the server's socket, e.g. for postgresql:///name?host=FOLDER."""
    programs = find_programs()
    folder = Path(tempfile.mkdtemp(prefix="verisim-pg-", dir="/tmp"))
    as_user: list[str] = []
    if os.geteuid() == 0:  # PostgreSQL refuses to run as root
        owner = pwd.getpwnam("postgres")
        os.chown(folder, owner.pw_uid, owner.pw_gid)
        as_user = ["runuser", "-u", "postgres", "--"]
    folder.chmod(0o755)
    data = folder / "data"
    initdb = [str(programs / "initdb"), "-D", str(data), "-A", "trust", "-U", "verisim", "-N"]
    subprocess.run([*as_user, *initdb], check=True, capture_output=True)
    settings = ["-c", "listen_addresses=", "-k", str(folder), "-c", "unix_socket_permissions=0777"]
    server = subprocess.Popen(
        [*as_user, str(programs / "postgres"), "-D", str(data), *settings],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        wait_until_ready(programs, folder)
        yield str(folder)
    finally:
        stop = [str(programs / "pg_ctl"), "-D", str(data), "-m", "immediate", "stop"]
        subprocess.run([*as_user, *stop], check=False, capture_output=True)
        server.wait(timeout=START_S)
        shutil.rmtree(folder, ignore_errors=True)


def wait_until_ready(programs: Path, folder: Path) -> None:
    deadline = time.monotonic() + START_S
    ask = [str(programs / "pg_isready"), "-q", "-h", str(folder), "-U", "verisim"]
    while subprocess.run(ask, check=False).returncode != 0:
        assert time.monotonic() < deadline, "PostgreSQL did not start"
        time.sleep(0.1)


def create_database(folder: str, name: str) -> str:
    """Returns the address of a new, empty database."""
    import psycopg

    with psycopg.connect(f"host={folder} user=verisim dbname=postgres", autocommit=True) as admin:
        admin.execute(f'CREATE DATABASE "{name}"'.encode())
    return f"postgresql://verisim@/{name}?host={folder}"
