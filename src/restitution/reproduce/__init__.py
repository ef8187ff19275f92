"""Reproduce the figures of Ghanbarzadeh, Hassanpour and Neville (2019); check their claims."""
