"""The table `[roughness]`, of either kind."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from restitution.case.generated import GeneratedRoughness
from restitution.case.joined import JoinedRoughness
from restitution.case.measured import MeasuredRoughness

Roughness = Annotated[
    GeneratedRoughness | MeasuredRoughness | JoinedRoughness, Field(discriminator="kind")
]
