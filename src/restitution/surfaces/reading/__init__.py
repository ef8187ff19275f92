"""Read files of scans: one module for each kind of file, `instrument_files` for all others."""
