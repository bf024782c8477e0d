"""How the skin answers a force: material and response, prepared for a surface, joined from parts."""

from .cut_out import CutOut as CutOut
from .cut_out import cut_out as cut_out
from .elastic import ElasticSkin as ElasticSkin
from .load import load_prepared as load_prepared
from .prepared import PreparedSkin as PreparedSkin
from .progress import Progress as Progress
from .response import Body as Body
from .response import Discretization as Discretization
from .response import GaussianCorrected as GaussianCorrected
from .response import GivenMatrix as GivenMatrix
from .response import HalfSpace as HalfSpace
from .response import Layer as Layer
from .response import PressureBasis as PressureBasis
from .response import Response as Response
from .skins import CombinedSkin as CombinedSkin
from .skins import Skin as Skin
