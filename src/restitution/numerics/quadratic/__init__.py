"""Minimisation of a convex quadratic within bounds, started from the solutions on coarser grids."""
