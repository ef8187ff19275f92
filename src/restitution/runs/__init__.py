"""Runs of one case, on one or several surfaces or on several grids, with error estimates."""
