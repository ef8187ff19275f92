"""Reproduce the figures, and check the claims, of Ghanbarzadeh, Hassanpour and Neville (2019)."""
