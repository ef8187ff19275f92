"""Mixtures of several materials and sizes: compute the laws of all pairs from few runs."""
