"""One case, run: on one surface, on many, or on several grids, with its errors."""
