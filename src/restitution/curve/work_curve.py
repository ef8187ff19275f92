"""Unloading work against loading work: what curves at equal kinetic energy are compared by."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Self

import numpy as np

from restitution.collision import Collision
from restitution.curve.columns import Array

# Energy losses up to this fraction of the loading work count as rounding errors of elastic impacts.
_LOSSLESS = 1e-6


@dataclass(frozen=True)
class WorkCurve:
    """Loading and unloading work (J) of impacts, at increasing values of the loading work.

    `pull_off` is the pull-off force (N) after each impact; NaN if it is not known.
    """

    work: Array
    unloading_work: Array
    pull_off: Array

    @classmethod
    def of(cls, collisions: Iterable[Collision]) -> Self:
        """Take the impacts of `collisions` at which the loading work increases."""
        known: list[Collision] = []
        for collision in collisions:
            if collision.loading_work > (known[-1].loading_work if known else 0.0):
                known.append(collision)
        works = [(c.loading_work, c.unloading_work, c.pull_off_force) for c in known]
        return cls(*np.reshape(works, (len(works), 3)).T)

    @property
    def restitution(self) -> Array:
        return np.sqrt(np.clip(self.unloading_work / self.work, 0.0, 1.0))

    def ratio(self, work: Array) -> Array:
        """Ratio of unloading to loading work at `work` (J), negative where the bodies stick.

        The energy loss is interpolated as by `at`, and constant beyond the ends.
        """
        if not self.work.size:
            return np.full(np.shape(work), math.nan)
        inside = np.clip(work, self.work[0], self.work[-1])
        lost = self._loss(inside)
        if lost is None:
            lost = np.interp(np.log(inside), np.log(self.work), self.work - self.unloading_work)
        return np.asarray(1 - lost / work)

    def pull_off_at(self, work: Array) -> Array:
        """Pull-off force (N) at `work` (J): linear in ln(work), constant beyond the ends."""
        if not self.work.size:
            return np.full(np.shape(work), math.nan)
        return np.asarray(np.interp(np.log(work), np.log(self.work), self.pull_off))

    def at(self, work: Array) -> Array:
        """COR at `work` (J): monotone cubic in ln(work), constant beyond the ends; NaN if empty.

        If every impact loses energy, the logarithm of the loss is interpolated, which is accurate
        where COR rises steeply from zero between impacts that stick and impacts that separate.
        """
        from scipy.interpolate import PchipInterpolator

        if self.work.size < 2:
            return np.full(np.shape(work), self.restitution[0] if self.work.size else math.nan)
        inside = np.clip(work, self.work[0], self.work[-1])
        lost = self._loss(inside)
        if lost is not None:
            return np.asarray(np.sqrt(np.maximum(1 - lost / inside, 0.0)))
        return np.asarray(PchipInterpolator(np.log(self.work), self.restitution)(np.log(inside)))

    def _loss(self, work: Array) -> Array | None:
        """Energy loss (J) between the ends; None if it is not known or vanishes at an impact."""
        from scipy.interpolate import PchipInterpolator

        lost = self.work - self.unloading_work
        if self.work.size < 2 or np.any(lost <= _LOSSLESS * self.work):
            return None
        return np.asarray(np.exp(PchipInterpolator(np.log(self.work), np.log(lost))(np.log(work))))
