"""Waves below the grid: their law from periodic patches, and the contact under this law."""
