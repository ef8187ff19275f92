"""Contacts from keys of the table [interface] of a case file, for tests that vary these keys."""

from restitution.case.models import adhesion_of, plasticity_of
from restitution.contact.contact import Contact
from restitution.contact.interface import interface_of

_PLASTICITY = ("plasticity", "yield_pressure", "yield_strength", "tangent_modulus")
_ADHESION = ("adhesion", "work_of_adhesion", "approach", "detachment", "equilibrium_separation")


def models_of(**keys):
    """The arguments of `Contact` or of `replace` that these keys stand for."""
    taken = {key: keys.pop(key) for key in _PLASTICITY if key in keys}
    models = {"plasticity": plasticity_of(**taken)} if taken else {}
    taken = {key: keys.pop(key) for key in _ADHESION if key in keys}
    return models | ({"adhesion": adhesion_of(**taken)} if taken else {}) | keys


def contact_of(pair, surface, **keys):
    return Contact(pair, surface, **models_of(**keys))


def load(contact, indentation, *, start=None, residual=1e-8):
    """Load without the work that has to be integrated."""
    return interface_of(contact).load(contact, indentation, start=start, residual=residual)
