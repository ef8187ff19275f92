"""Coefficient of restitution of rough elastic-plastic particles from their surface topography."""

import lazy_loader

# `__init__.pyi` lists the public names. A module is imported when one of its names is first used,
# so `import restitution` does not load NumPy, which would delay help texts and Ctrl-C.
_load, _, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        return version(__name__)
    return _load(name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
