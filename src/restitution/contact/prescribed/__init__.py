"""Contacts under a prescribed force, impact velocity or nominal pressure."""
