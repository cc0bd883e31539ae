"""Tables of the ledger: numbered migrations, forward only, and the same tables for SQLAlchemy Core.

A released migration is never edited; a change is a new one at the end. A test compares the two descriptions.
"""

from sqlalchemy import Column, Float, Integer, MetaData, Table, Text

MIGRATIONS: tuple[str, ...] = (
    """
    CREATE TABLE jobs (
        id TEXT PRIMARY KEY,
        state TEXT NOT NULL,
        reason TEXT,
        request TEXT NOT NULL,
        created_at REAL NOT NULL,
        facts TEXT,
        tile_size INTEGER,
        warnings TEXT NOT NULL DEFAULT '[]',
        tiles_done INTEGER NOT NULL DEFAULT 0,
        samples_done INTEGER NOT NULL DEFAULT 0,
        rays INTEGER NOT NULL DEFAULT 0,
        non_finite_samples INTEGER NOT NULL DEFAULT 0,
        passes_opened INTEGER NOT NULL DEFAULT 0,
        running_s REAL NOT NULL DEFAULT 0,
        crashes INTEGER NOT NULL DEFAULT 0,
        resource_failures INTEGER NOT NULL DEFAULT 0,
        last_seq INTEGER NOT NULL DEFAULT 0
    ) STRICT;
    CREATE INDEX jobs_by_state ON jobs (state);
    CREATE INDEX jobs_by_age ON jobs (created_at);
    CREATE TABLE deleted_jobs (id TEXT PRIMARY KEY, deleted_at REAL NOT NULL) STRICT, WITHOUT ROWID;
    CREATE TABLE idempotency_keys (
        key TEXT PRIMARY KEY,
        body_sha256 TEXT NOT NULL,
        job_id TEXT NOT NULL,
        created_at REAL NOT NULL
    ) STRICT, WITHOUT ROWID;
    CREATE TABLE leases (
        fence INTEGER PRIMARY KEY AUTOINCREMENT,
        job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE
    ) STRICT;
    CREATE INDEX leases_by_job ON leases (job_id);
    CREATE TABLE passes (
        job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
        pass_index INTEGER NOT NULL,
        sample_begin INTEGER NOT NULL,
        sample_end INTEGER NOT NULL,
        PRIMARY KEY (job_id, pass_index)
    ) STRICT, WITHOUT ROWID;
    CREATE TABLE tiles (
        job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
        pass_index INTEGER NOT NULL,
        tile INTEGER NOT NULL,
        sha256 TEXT NOT NULL,
        PRIMARY KEY (job_id, pass_index, tile)
    ) STRICT, WITHOUT ROWID;
    CREATE TABLE revisions (
        job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
        number INTEGER NOT NULL,
        passes INTEGER NOT NULL,
        min_samples INTEGER NOT NULL,
        max_samples INTEGER NOT NULL,
        error_noise REAL,
        mean_r REAL NOT NULL,
        mean_g REAL NOT NULL,
        mean_b REAL NOT NULL,
        non_finite_samples INTEGER NOT NULL,
        running_s REAL NOT NULL,
        exr TEXT NOT NULL,
        exr_bytes INTEGER NOT NULL,
        png TEXT NOT NULL,
        film TEXT,
        at REAL NOT NULL,
        PRIMARY KEY (job_id, number)
    ) STRICT, WITHOUT ROWID;
    CREATE TABLE events (
        job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
        seq INTEGER NOT NULL,
        kind TEXT NOT NULL,
        at REAL NOT NULL,
        data TEXT NOT NULL,
        PRIMARY KEY (job_id, seq)
    ) STRICT, WITHOUT ROWID;
    """,
    """
    ALTER TABLE revisions ADD COLUMN error_bound REAL
    """,
    """
    ALTER TABLE passes ADD COLUMN tiles TEXT;
    ALTER TABLE revisions ADD COLUMN mean_samples REAL NOT NULL DEFAULT 0;
    UPDATE revisions SET mean_samples = min_samples;
    ALTER TABLE revisions ADD COLUMN next_round TEXT;
    ALTER TABLE revisions ADD COLUMN samples_expected REAL;
    -- Unfinished jobs with an error goal were cut into other tiles: they begin anew.
    CREATE TEMP TABLE renewed AS SELECT id FROM jobs
        WHERE json_extract(request, '$.goal.rel_error') IS NOT NULL
        AND state NOT IN ('SUCCEEDED', 'FAILED', 'CANCELLED');
    DELETE FROM tiles WHERE job_id IN (SELECT id FROM renewed);
    DELETE FROM passes WHERE job_id IN (SELECT id FROM renewed);
    DELETE FROM revisions WHERE job_id IN (SELECT id FROM renewed);
    UPDATE jobs SET state = iif(state = 'PAUSED', state, 'QUEUED'), facts = NULL, tile_size = NULL, tiles_done = 0,
        samples_done = 0, rays = 0, non_finite_samples = 0, passes_opened = 0 WHERE id IN (SELECT id FROM renewed);
    DROP TABLE renewed
    """,
    """
    ALTER TABLE revisions ADD COLUMN error_unseen REAL;
    ALTER TABLE revisions ADD COLUMN unseen_warning TEXT
    """,
    """
    ALTER TABLE revisions ADD COLUMN error_bias REAL;
    -- All were path traced.
    UPDATE revisions SET error_bias = 0
    """,
    """
    ALTER TABLE jobs ADD COLUMN owner TEXT;
    CREATE INDEX jobs_by_owner ON jobs (owner, state);
    CREATE TABLE api_keys (
        id TEXT PRIMARY KEY,
        sha256 TEXT NOT NULL UNIQUE,
        name TEXT NOT NULL,
        scope TEXT NOT NULL,
        quota_jobs INTEGER,
        quota_bytes INTEGER,
        quota_samples INTEGER,
        created_at REAL NOT NULL
    ) STRICT, WITHOUT ROWID;
    CREATE TABLE key_usage (
        key_id TEXT NOT NULL,
        hour INTEGER NOT NULL,
        bytes INTEGER NOT NULL DEFAULT 0,
        samples INTEGER NOT NULL DEFAULT 0,
        PRIMARY KEY (key_id, hour)
    ) STRICT, WITHOUT ROWID
    """,
)

metadata = MetaData()


def _table(name: str, keys: str, texts: str = "", integers: str = "", floats: str = "") -> Table:
    """A table whose columns are named in blank-separated lists by type; `keys` are its primary key."""
    kinds = ((texts, Text()), (integers, Integer()), (floats, Float()))
    columns: list[Column[object]] = [
        Column(column, kind, primary_key=column in keys.split()) for names, kind in kinds for column in names.split()
    ]
    return Table(name, metadata, *columns)


jobs = _table(
    "jobs",
    "id",
    "id state reason request facts warnings owner",
    "tile_size tiles_done samples_done rays non_finite_samples passes_opened crashes resource_failures last_seq",
    "created_at running_s",
)
deleted_jobs = _table("deleted_jobs", "id", "id", "", "deleted_at")
idempotency_keys = _table("idempotency_keys", "key", "key body_sha256 job_id", "", "created_at")
leases = _table("leases", "fence", "job_id", "fence")
passes = _table("passes", "job_id pass_index", "job_id tiles", "pass_index sample_begin sample_end")
tiles = _table("tiles", "job_id pass_index tile", "job_id sha256", "pass_index tile")
revisions = _table(
    "revisions",
    "job_id number",
    "job_id exr png film next_round unseen_warning",
    "number passes min_samples max_samples non_finite_samples exr_bytes",
    "mean_samples samples_expected error_noise error_bias error_bound error_unseen mean_r mean_g mean_b running_s at",
)
events = _table("events", "job_id seq", "job_id kind data", "seq", "at")
api_keys = _table("api_keys", "id", "id sha256 name scope", "quota_jobs quota_bytes quota_samples", "created_at")
key_usage = _table("key_usage", "key_id hour", "key_id", "hour bytes samples")
