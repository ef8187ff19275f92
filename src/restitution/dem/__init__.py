"""Exports of laws to DEM codes."""
