# SPDX-License-Identifier: MIT
"""Runs migrations on the connection that `prepare_database` hands over, in its transaction."""

from alembic import context

context.configure(connection=context.config.attributes["connection"], transactional_ddl=True)
with context.begin_transaction():
    context.run_migrations()
