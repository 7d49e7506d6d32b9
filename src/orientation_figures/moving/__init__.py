"""Figures that the reader moves: alive in Jupyter, and on the pages of the book without a kernel.

``orientation`` does not load this package, which needs anywidget.
"""

from .belt import BeltFigure
from .challenge import ChallengeFigure
from .converter import ConverterFigure
from .explorer import SequenceExplorer
from .figure import MovingFigure
from .gimbal import GimbalFigure
from .graph import GraphFigure
from .hands import HandsFigure
from .motion import MotionFigure
from .nine_numbers import NineNumbersFigure
from .phone import PhoneFigure
from .quaternion import QuaternionFigure
from .simple import SimpleFigure
from .successive import SuccessiveFigure
from .triad import TriadFigure
from .workbench import WorkbenchFigure

__all__ = [
    "BeltFigure",
    "ChallengeFigure",
    "ConverterFigure",
    "GimbalFigure",
    "GraphFigure",
    "HandsFigure",
    "MotionFigure",
    "MovingFigure",
    "NineNumbersFigure",
    "PhoneFigure",
    "QuaternionFigure",
    "SequenceExplorer",
    "SimpleFigure",
    "SuccessiveFigure",
    "TriadFigure",
    "WorkbenchFigure",
]
