"""Points of curves with plain values, for tests."""

from restitution.curve.point import MeanPoint, Point


def point(kind=Point, **values):
    """A point whose fields are 1, errors 0 and flags true, except for the given ones."""
    ones = {
        column.variable: True if column.flag else 0.0 if "error" in header else 1.0
        for header, column in kind.columns().items()
    }
    ones |= {"refine": ones.pop("refinement"), "surface_scatter": 0.0}
    ones["restitution_with_losses"] = values.get("restitution", 1.0)
    return kind(**ones | values)


def mean_point(**values):
    """The same for the mean of surfaces."""
    return point(MeanPoint, **values)
