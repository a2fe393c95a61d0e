"""Seeded synthetic materials and samples, for demonstrations and tests: labeled synthetic, never measured."""

from .carbon import brushed_carbon as brushed_carbon
from .carpaint import metallic_paint as metallic_paint
from .carpaint import paint_model as paint_model
from .carpaint import relative_noise as relative_noise
from .carpaint import unit_luminance_paint as unit_luminance_paint
from .flakes import FlakeRecipe as FlakeRecipe
from .flakes import FlakeStack as FlakeStack
from .flakes import flake_stack as flake_stack
from .packages import PACKAGES as PACKAGES
from .packages import Package as Package
from .packages import generate as generate
