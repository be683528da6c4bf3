# SPDX-License-Identifier: MIT
"""The raw log of a submission may be emptied, so that a redacted comment is gone from there too."""

from alembic import op

revision = "0003"
down_revision = "0002"

# All that may happen to a logged body: it goes, and every other column stays as it was.
EMPTIED = (
    "NEW.body = '' AND NEW.submission_id = OLD.submission_id AND NEW.session_id = OLD.session_id "
    "AND NEW.kind = OLD.kind AND NEW.outcome = OLD.outcome "
    "AND NEW.body_sha256 = OLD.body_sha256 AND NEW.received_utc = OLD.received_utc"
)
SQLITE = f"""
CREATE TRIGGER submission_is_never_changed BEFORE UPDATE ON submission WHEN NOT ({EMPTIED})
BEGIN SELECT RAISE(ABORT, 'submission rows are never changed'); END
"""
POSTGRESQL = f"""
CREATE OR REPLACE FUNCTION submission_never_changes() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  IF NOT ({EMPTIED}) THEN RAISE EXCEPTION 'submission rows are never changed'; END IF;
  RETURN NEW;
END $$
"""


def upgrade() -> None:
    if op.get_bind().dialect.name == "postgresql":
        op.execute(POSTGRESQL)
        return
    op.execute("DROP TRIGGER submission_is_never_changed")
    op.execute(SQLITE)
