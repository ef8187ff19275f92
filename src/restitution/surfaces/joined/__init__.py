"""Several scans of one surface: their joined power spectrum and its twin."""
