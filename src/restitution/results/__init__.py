"""Results folders: safe writing, and reading with checks."""
