"""Names of derived quantities for people, and the units in which they are printed."""

from __future__ import annotations

# For each derived quantity: label, conversion factor from SI, displayed unit.
LABELS: dict[str, tuple[str, float, str]] = {
    "reduced_radius_m": ("reduced radius R*", 1e6, "um"),
    "contact_modulus_Pa": ("contact modulus E*", 1e-9, "GPa"),
    "reduced_mass_kg": ("reduced mass m*", 1, "kg"),
    "yield_strength_Pa": ("yield strength Y", 1e-6, "MPa"),
    "yield_pressure_Pa": ("yield pressure p_y", 1e-6, "MPa"),
    "yield_indentation_m": ("yield indentation δ_y, smooth", 1e9, "nm"),
    "yield_force_N": ("yield force F_y, smooth", 1, "N"),
    "yield_velocity_m_per_s": ("yield velocity V_y, smooth", 1, "m/s"),
    "work_of_adhesion_J_per_m2": ("work of adhesion w", 1, "J/m^2"),
    "pull_off_force_smooth_N": ("pull-off force F_c, smooth", 1, "N"),
    "pull_off_radius_m": ("pull-off radius a_c, smooth", 1e6, "um"),
    "nodes_over_pull_off_radius": ("nodes over the pull-off radius, a_c/h", 1, ""),
    "expected_pull_off_error": ("expected error of pull-off on this grid", 100, "%"),
    "tabor_parameter": ("Tabor parameter (large in the JKR limit)", 1, ""),
    "sticking_velocity_m_per_s": ("sticking velocity V_s, smooth elastic", 1, "m/s"),
    "deepest_indentation_m": ("deepest indentation", 1e9, "nm"),
    "predicted_contact_radius_m": ("contact radius there, smooth", 1e6, "um"),
    "domain_half_width_m": ("half width of the grid", 1e6, "um"),
    "nodes_over_contact_radius": ("nodes over the contact radius", 1, ""),
    "rms_slope": ("rms slope h'", 1, ""),
    "reduced_pressure_Pa": ("unit of pressure E* h'", 1e-6, "MPa"),
    "mean_gap_at_first_touch_m": ("mean gap at first touch", 1e9, "nm"),
    "nominal_area_m2": ("nominal area, one period", 1e12, "um^2"),
}
