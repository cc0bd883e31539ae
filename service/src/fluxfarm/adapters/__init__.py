"""How the ports are met: SQLite, files and local engine processes."""
