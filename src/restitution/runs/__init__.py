"""Runs of one case: on one surface, on many, or on several grids, with error estimates."""
