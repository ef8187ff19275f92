"""Reproduce the figures of Ghanbarzadeh, Hassanpour and Neville (2019) and check their claims."""
