"""Collisions in time, from stored contact forces: head-on and oblique."""
