"""Exports of laws to codes of the discrete element method (DEM)."""
