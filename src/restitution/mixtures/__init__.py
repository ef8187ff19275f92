"""Mixtures: laws of all pairs of particles of several materials and sizes, from few runs."""
