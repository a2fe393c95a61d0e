"""Reports: JSON first, then one self-contained HTML page of verdicts, fits and comparisons."""

from axffit.report.junit import junit_xml as junit_xml
from axffit.report.page import Page as Page
from axffit.report.page import Run as Run
from axffit.report.page import compare_page as compare_page
from axffit.report.page import demo_page as demo_page
from axffit.report.page import fit_page as fit_page
from axffit.report.page import schema as schema
from axffit.report.page import verdict_page as verdict_page
from axffit.report.page import verify_page as verify_page
from axffit.report.sections import ComparedSamples as ComparedSamples
from axffit.report.sections import FittedSamples as FittedSamples
from axffit.report.sections import Section as Section
from axffit.report.sections import VerifiedMaterial as VerifiedMaterial
