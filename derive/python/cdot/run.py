"""Runs of scenes, and batches of Worlds."""
from __future__ import annotations

import copy
import os
from typing import Iterable, Optional, Sequence, Union

import numpy as np

from . import _cdot

AnyWorld = Union[_cdot.World, _cdot.SpatialWorld]


def simulate(scene: Union[_cdot.Scene, str], *, until: Optional[float] = None, step: Optional[float] = None,
             accuracy: Optional[float] = None, times: Sequence[float] = (), record: Sequence[str] = (),
             start: Optional[_cdot.Snapshot] = None, save: bool = False) -> _cdot.Result:
    """Runs a scene as `cdot-run simulate` does: by the method that it names, or by one that reaches its accuracy.

    until     duration [s] in place of the scene's
    step      [s] in place of the scene's
    accuracy  of the trajectory [m, rad]: the run chooses a method that reaches it
    times     of the rows of the result [s]; without them one row per step
    record    sensors beside those of the scene: "all", "coordinates", "reactions", ... (cdot-run simulate --help)
    start     a Snapshot to continue from
    save      True: Result.state is the Snapshot at the end

    Result.failure says why a run failed its tolerances; mistakes of the scene raise SceneError.
    """
    scene = copy.copy(scene) if isinstance(scene, _cdot.Scene) else _cdot.Scene(scene)
    for name, value in (("duration", until), ("step", step), ("accuracy", accuracy)):
        if value is not None:
            setattr(scene, name, value)
    if record:
        scene.record(list(record))
    return scene._simulate([float(time) for time in times], start, save)


def compile(scene: Union[_cdot.Scene, str], variants: int = 1, *, integrator: str = "rk4",
            inputs: Sequence[str] = (), lanes: int = 8) -> _cdot.Compiled:
    """Many variants of a scene in lockstep: its own step, written by Cdot and built by the machine's C++ compiler.

    A variant in each SIMD lane, and packs of them on all cores. They begin alike; set_states() and set() make them
    differ. batch() steps them.

    integrator  euler, implicit, rattle, rk4, dop853 or radau5, with fixed steps; specs/scenes/README.md lists what each
                can have
    inputs      numbers that may differ and change, as "crank.angle.motor.speed"
    lanes       4, 8 or 16 variants at once

    Raises Error where the scene cannot be compiled, or where there is no compiler ($CXX, or c++).
    """
    if not isinstance(scene, _cdot.Scene):
        scene = _cdot.Scene(scene)
    return _cdot.Compiled(scene, variants, integrator, list(inputs), lanes)


def batch(worlds: Union[Iterable[AnyWorld], _cdot.Compiled], h: float, count: int, *, out: Optional[np.ndarray] = None,
          threads: Optional[int] = None) -> np.ndarray:
    """Steps many Worlds of equal size at once, on all cores: each has the bits that it has alone. Or all variants of a
    compiled scene (compile()), a variant in each SIMD lane.

    Returns their states at the end, float64 [worlds, bodies, 6], in space [worlds, bodies, 13] (World.states()).
    `out` of this shape is filled in place of a new array. A World that fails raises Error with its number, after all
    others have ended.
    """
    threads = threads or os.cpu_count() or 1
    if isinstance(worlds, _cdot.Compiled):
        worlds.step(h, count, threads)
        states = worlds.states()
        if out is None:
            return states
        out[...] = states
        return out
    worlds = list(worlds)
    if not worlds:
        raise ValueError("a batch needs a World at least")
    if len(set(map(id, worlds))) < len(worlds):
        raise ValueError("a World occurs twice in the batch")
    if out is None:
        out = np.empty((len(worlds), *worlds[0].states().shape))
    _cdot._batch(worlds, h, count, out, threads)
    return out
