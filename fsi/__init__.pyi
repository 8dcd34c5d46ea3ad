"""What type checkers and editors see of `import fsi`: the names of `fsi.api`."""

from fsi.api import BodySolution as BodySolution
from fsi.api import CalibrationResult as CalibrationResult
from fsi.api import Case as Case
from fsi.api import FsiError as FsiError
from fsi.api import InputError as InputError
from fsi.api import Resistance as Resistance
from fsi.api import Run as Run
from fsi.api import Solution as Solution
from fsi.api import SolveError as SolveError
from fsi.api import StepRecord as StepRecord
from fsi.api import calibrate as calibrate
from fsi.api import load_case as load_case
from fsi.api import make_case as make_case
from fsi.api import open_run as open_run
from fsi.api import resume as resume
from fsi.api import run as run
from fsi.api import solve as solve

__version__: str
