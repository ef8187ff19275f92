"""Kendall (1971): a flat circular punch stuck to an elastic half-space, all of it at once.

K. Kendall, J. Phys. D: Appl. Phys. 4 (1971) 1186–1195, doi 10.1088/0022-3727/4/8/320. The contact
radius a stays fixed, so the punch is a spring of stiffness 2E*a whose rim is a crack of energy
release rate F²/(8πE*a³). It parts where that reaches the work of adhesion w:

    F = (8πE*wa³)^½,   drawn apart by F/(2E*a) = (2πwa/E*)^½.

Nothing recedes first: the least tension is the last. F grows as a^{3/2}, so the pressure F/(πa²) it
takes falls with size, and the work ½F²/(2E*a) = 2πwa² is twice the surface energy; the other half
is lost. Both numbers are what JKR takes off Hertz at the same contact radius (`jkr`).

Valid for a rigid punch (or an elastic one, in E*, where its sides do not matter), frictionless or
incompressible, with forces of range much shorter than the opening (2πwa/E*)^½, and a ≪ the bodies.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

import numpy as np

from ._inputs import Array, Values, positive, touching


def pull_off_force(
    contact_radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """Tension (8πE*wa³)^½ (N), as a magnitude, that parts the punch."""
    a = touching(contact_radius)
    E_star, w = positive(contact_modulus=contact_modulus, work_of_adhesion=work_of_adhesion)
    return (8 * np.pi * E_star * w) ** 0.5 * a**1.5


def pull_off_displacement(
    contact_radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """Distance (2πwa/E*)^½ (m), as a magnitude, by which the punch is drawn out when it parts."""
    a = touching(contact_radius)
    E_star, w = positive(contact_modulus=contact_modulus, work_of_adhesion=work_of_adhesion)
    return (2 * np.pi * w * a / E_star) ** 0.5
