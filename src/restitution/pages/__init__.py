"""Pages of stored results as self-contained HTML files. Nothing is computed here."""
