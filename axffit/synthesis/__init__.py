"""Seeded synthetic materials and samples, for demonstrations and tests: labeled synthetic, never measured."""

from .carbon import brushed_carbon as brushed_carbon
from .carbon import carbon_twill as carbon_twill
from .carpaint import PaintRecipe as PaintRecipe
from .carpaint import metallic_paint as metallic_paint
from .carpaint import paint as paint
from .carpaint import paint_model as paint_model
from .carpaint import relative_noise as relative_noise
from .carpaint import unit_luminance_paint as unit_luminance_paint
from .fabrics import lace as lace
from .flakes import FlakeRecipe as FlakeRecipe
from .flakes import FlakeStack as FlakeStack
from .flakes import flake_stack as flake_stack
from .leathers import leather as leather
from .leathers import patent_leather as patent_leather
from .leathers import perforated_leather as perforated_leather
from .metal import brushed_metal as brushed_metal
from .metal import hammered_copper as hammered_copper
from .metal import turned_brass as turned_brass
from .packages import PACKAGES as PACKAGES
from .packages import Package as Package
from .packages import generate as generate
from .paints import pearlescent as pearlescent
from .paints import ruby_metallic as ruby_metallic
from .paints import silver_metallic as silver_metallic
from .paints import solid_yellow as solid_yellow
from .wood import lacquered_walnut as lacquered_walnut
