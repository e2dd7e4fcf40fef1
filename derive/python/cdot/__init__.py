"""Cdot: a position constraint in; its Jacobian, its effective mass and a moving mechanism out.

    import cdot

    world = cdot.World.from_scene("four_bar")    # a scene of the catalogue, or the path of a file
    world.step(1 / 240, count=240)               # one second
    world.positions                              # numpy, [bodies, 2] in m: a view of the World's own memory

    line = cdot.derive("line")                   # a spec of the catalogue, a path, or the text of a spec
    line.J, line.K                               # sympy matrices
    line.kernel()                                # the C++ of the joint

Units are metres, radians, seconds and kilograms. Mistakes raise cdot.Error with the message of the program: what
failed, the number, the cause, the likely fix.
"""
import os as _os

from . import _cdot

_cdot._install_in(_os.path.dirname(_os.path.abspath(__file__)))

from ._cdot import (CannotEmit, Compiled, Error, NoSuchSpec, Result, Scene, SceneError, Snapshot,  # noqa: E402
                    SpatialWorld, World, __version__)
from .derivation import Block, Bound, Derivation, Law, derive  # noqa: E402
from .run import batch, compile, simulate  # noqa: E402

for _part in (CannotEmit, Compiled, Error, NoSuchSpec, Result, Scene, SceneError, Snapshot, SpatialWorld, World):
    _part.__module__ = "cdot"  # as messages name it

__all__ = ["Block", "Bound", "CannotEmit", "Compiled", "Derivation", "Error", "Law", "NoSuchSpec", "Result", "Scene",
           "SceneError", "Snapshot", "SpatialWorld", "World", "batch", "compile", "derive", "simulate", "__version__"]
