"""Which parameters explain a sampled BRDF, and how sure that is.

The modules load JAX; the names below are what other rooms use.
"""

from axffit.fitting.compare import Comparison as Comparison
from axffit.fitting.compare import Region as Region
from axffit.fitting.compare import compare as compare
from axffit.fitting.fit import Negatives as Negatives
from axffit.fitting.fit import fit as fit
from axffit.fitting.limits import Limit as Limit
from axffit.fitting.limits import half_difference_limit as half_difference_limit
from axffit.fitting.limits import reciprocal_limit as reciprocal_limit
from axffit.fitting.metrics import POLAR_LIMIT as POLAR_LIMIT
from axffit.fitting.metrics import Metrics as Metrics
from axffit.fitting.metrics import evaluate_samples as evaluate_samples
from axffit.fitting.metrics import metrics_of as metrics_of
from axffit.fitting.models import AbstractFitModel as AbstractFitModel
from axffit.fitting.models import CarPaintModel as CarPaintModel
from axffit.fitting.models import Coat as Coat
from axffit.fitting.models import LambertModel as LambertModel
from axffit.fitting.models import SingleLobeModel as SingleLobeModel
from axffit.fitting.multilobe import LobesModel as LobesModel
from axffit.fitting.names import MODEL_NAMES as MODEL_NAMES
from axffit.fitting.names import parse_f0 as parse_f0
from axffit.fitting.names import parse_model as parse_model
from axffit.fitting.parameters import ParameterEstimate as ParameterEstimate
from axffit.fitting.residuals import RESIDUALS as RESIDUALS
from axffit.fitting.residuals import AbstractResidual as AbstractResidual
from axffit.fitting.residuals import CosineWeighted as CosineWeighted
from axffit.fitting.residuals import CubeRoot as CubeRoot
from axffit.fitting.residuals import LogCosine as LogCosine
from axffit.fitting.residuals import NoiseWeighted as NoiseWeighted
from axffit.fitting.residuals import Robust as Robust
from axffit.fitting.result import FitResult as FitResult
from axffit.fitting.result import Outcome as Outcome
from axffit.fitting.selection import Candidate as Candidate
from axffit.fitting.selection import Selection as Selection
from axffit.fitting.selection import select as select
from axffit.fitting.studies import Study as Study
