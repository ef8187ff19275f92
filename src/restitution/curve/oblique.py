"""Points of oblique impacts."""

from __future__ import annotations

from dataclasses import dataclass

from restitution.curve.columns import Record, column, magnitude


@dataclass(frozen=True, kw_only=True)
class ObliquePoint(Record):
    """One oblique impact; its fields are the columns of `oblique.csv` (docs/results.md).

    The tangential restitution and the angle of rebound refer to the velocity of the centres.
    """

    velocity: float = magnitude(
        "impact_velocity_m_per_s",
        "m s-1",
        "velocity of the centres before the impact",
        "oblique_velocity",
    )
    angle: float = magnitude("angle_rad", "rad", "angle of impact from the normal", "oblique_angle")
    first_spin_before: float = column(
        "first_spin_before_rad_per_s",
        "rad s-1",
        "spin of the first body before the impact",
        "oblique_first_spin_before",
    )
    second_spin_before: float = column(
        "second_spin_before_rad_per_s",
        "rad s-1",
        "spin of the second body before the impact",
        "oblique_second_spin_before",
    )
    friction: float = magnitude("friction", "1", "coefficient of friction", "oblique_friction")
    normal_restitution: float = magnitude(
        "normal_restitution", "1", "normal restitution", "oblique_normal_restitution", high=1.0
    )
    normal_restitution_error: float = magnitude(
        "normal_restitution_error",
        "1",
        "error of normal_restitution",
        "oblique_normal_restitution_error",
        optional=True,
    )
    tangential_restitution: float = column(
        "tangential_restitution",
        "1",
        "tangential restitution",
        "oblique_tangential_restitution",
        optional=True,
    )
    rebound_angle: float = column(
        "rebound_angle_rad", "rad", "angle of rebound", "oblique_rebound_angle"
    )
    first_spin: float = column(
        "first_spin_rad_per_s",
        "rad s-1",
        "spin of the first body after the impact",
        "oblique_first_spin",
    )
    second_spin: float = column(
        "second_spin_rad_per_s",
        "rad s-1",
        "spin of the second body after the impact",
        "oblique_second_spin",
    )
    friction_loss: float = magnitude(
        "friction_loss_J", "J", "energy lost to friction", "oblique_friction_loss"
    )
    normal_loss: float = magnitude(
        "normal_loss_J", "J", "energy lost in the normal contact", "oblique_normal_loss"
    )
    slides: bool = column(
        "slides", "1", "the whole contact slides from beginning to end", "oblique_slides"
    )
    tangential_restitution_error: float = magnitude(
        "tangential_restitution_error",
        "1",
        "error of tangential_restitution",
        "oblique_tangential_restitution_error",
        optional=True,
    )
    rebound_angle_error: float = magnitude(
        "rebound_angle_error_rad",
        "rad",
        "error of rebound_angle",
        "oblique_rebound_angle_error",
        optional=True,
    )
    first_spin_error: float = magnitude(
        "first_spin_error_rad_per_s",
        "rad s-1",
        "error of first_spin",
        "oblique_first_spin_error",
        optional=True,
    )
    second_spin_error: float = magnitude(
        "second_spin_error_rad_per_s",
        "rad s-1",
        "error of second_spin",
        "oblique_second_spin_error",
        optional=True,
    )


@dataclass(frozen=True, kw_only=True)
class MeanObliquePoint(ObliquePoint):
    """Means over several surfaces; `slides` is true if the contact slides on all of them."""

    realisations: float = magnitude(
        "realisations", "1", "number of surfaces with this impact", "oblique_realisations"
    )
    tangential_restitution_std: float = magnitude(
        "tangential_restitution_std",
        "1",
        "standard deviation of tangential_restitution among surfaces",
        "oblique_tangential_restitution_std",
        optional=True,
    )
