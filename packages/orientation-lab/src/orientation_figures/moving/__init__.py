"""Interactive figures, which work in Jupyter and, without a kernel, on the pages of the book.

``orientation`` does not load this package, which needs anywidget.
"""

from importlib import import_module
from typing import TYPE_CHECKING

# These imports also tell the book's build which files a cell with a figure uses.
if TYPE_CHECKING:
    from .belt import BeltFigure
    from .challenge import ChallengeFigure
    from .cloud import CloudFigure
    from .converter import ConverterFigure
    from .explorer import SequenceExplorer
    from .figure import MovingFigure
    from .gate import GateFigure
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

# The module of each figure. Importing a name loads only the module of that figure.
_MODULES = {
    "BeltFigure": "belt",
    "ChallengeFigure": "challenge",
    "CloudFigure": "cloud",
    "ConverterFigure": "converter",
    "SequenceExplorer": "explorer",
    "MovingFigure": "figure",
    "GateFigure": "gate",
    "GimbalFigure": "gimbal",
    "GraphFigure": "graph",
    "HandsFigure": "hands",
    "MotionFigure": "motion",
    "NineNumbersFigure": "nine_numbers",
    "PhoneFigure": "phone",
    "QuaternionFigure": "quaternion",
    "SimpleFigure": "simple",
    "SuccessiveFigure": "successive",
    "TriadFigure": "triad",
    "WorkbenchFigure": "workbench",
}


def __getattr__(name: str) -> type:
    """Return a figure, which is loaded on first use."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    # If anywidget is missing, the error says so.
    import_module(".figure", __name__)
    figure: type = getattr(import_module(f".{_MODULES[name]}", __name__), name)
    globals()[name] = figure
    return figure


__all__ = [
    "BeltFigure",
    "ChallengeFigure",
    "CloudFigure",
    "ConverterFigure",
    "GateFigure",
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
