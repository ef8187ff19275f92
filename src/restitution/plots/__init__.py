"""Figures: described once, drawn by matplotlib or Plotly. Nothing is computed here."""
