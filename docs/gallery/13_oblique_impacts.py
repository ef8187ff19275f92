r"""
Oblique impacts: computed and measured
======================================

Alumina spheres of 5 mm hit glass at 3.9 m/s and several angles. Kharaz, Gorham and Salman (2001)
measured the tangential restitution :math:`e_t`, the ratio of the tangential velocities of the
centres after and before the impact. The coefficient of friction is 0.092, and nothing is fitted.
Nearly normal impacts stick. From 28.3 degrees on the whole contact slides, and
:math:`e_t = 1 - \mu (1 + e_n)/\tan\theta`.
"""

import matplotlib.pyplot as plt
import numpy as np

import restitution as rs

MEASURED = {
    1.84: 0.793, 3.70: 0.745, 9.50: 0.673, 20.0: 0.597, 30.1: 0.688, 39.4: 0.771, 49.7: 0.848,
    60.0: 0.901,
}  # fmt: skip
alumina = {
    "radius": "2.5 mm",
    "youngs_modulus": "380 GPa",
    "poissons_ratio": 0.23,
    "density": "4000 kg/m^3",
}
glass = {"radius": "flat", "youngs_modulus": "70 GPa", "poissons_ratio": 0.22}
case = {
    "total_error": False,
    "first": alumina,
    "second": glass,
    "interface": {"yield_pressure": "elastic", "work_of_adhesion": "0 J/m^2", "friction": 0.092},
    "grid": {"nodes": 64, "spacing": "12 um"},
    "impact": {
        "velocity": "3.9 m/s",
        "angle": [f"{angle} deg" for angle in (2, 5, 8, 12, 16, 20, 25, 32, 45, 62)],
    },
}
points = rs.run(case).oblique

fig, ax = plt.subplots(layout="constrained")
angles = np.degrees([point.angle for point in points])
ax.plot(angles, [point.tangential_restitution for point in points], "o-", ms=4, label="computed")
ax.plot(list(MEASURED), list(MEASURED.values()), "ks", label="measured")
ax.axvline(28.3, color="grey", ls=":")
ax.text(29, 0.58, "full slip", color="grey")
ax.set(xlabel="angle of impact from the normal (°)", ylabel="tangential restitution")
ax.legend()
plt.show()
