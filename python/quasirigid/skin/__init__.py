"""How the skin answers a force: material and response, prepared for a surface, joined from parts."""

from .elastic import ElasticSkin as ElasticSkin
from .load import load_prepared as load_prepared
from .material import Skin as Skin
from .parts import CombinedSkin as CombinedSkin
from .parts import CutOut as CutOut
from .parts import cut_out as cut_out
from .prepared import PreparedSkin as PreparedSkin
from .response import Body as Body
from .response import GaussianCorrected as GaussianCorrected
from .response import GivenMatrix as GivenMatrix
from .response import HalfSpace as HalfSpace
from .response import Layer as Layer
from .response import Response as Response
