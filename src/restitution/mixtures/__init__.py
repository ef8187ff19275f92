"""Mixtures: the laws of all pairs of several materials and sizes, from as few runs as possible."""
