"""Runs of scenes: the numbers of `cdot-run simulate`, sensors, states, verdicts."""
import copy
import json
import math
import unittest

import numpy as np

import cdot

SWING = """
gravity = [0, -9.81]
duration = 1
integrator = "rk4"
step = 0.01
[[body]]
name = "bob"
mass = 1
inertia = 1
position = [0, 0]
velocity = [2, 0]
[[sensor]]
name = "rise"
value = "v(bob).y"
"""


class Runs(unittest.TestCase):
    def test_free_fall(self):
        result = cdot.simulate(cdot.Scene.of_text(SWING))
        self.assertEqual(result.failure, "")
        t = result.times
        self.assertEqual(len(t), 101)
        x, y, vy = (result.scene.columns.index(name) for name in ("x", "y", "vy"))
        np.testing.assert_allclose(result.states[:, 0, x], 2 * t, atol=1e-12)
        np.testing.assert_allclose(result.states[:, 0, y], -0.5 * 9.81 * t**2, atol=1e-12)
        np.testing.assert_array_equal(result.sensors[:, 0], result.states[:, 0, vy])
        np.testing.assert_allclose(result.energies, result.energies[0], atol=1e-12)

    def test_wishes_leave_the_scene_as_it_is(self):
        scene = cdot.Scene.of_text(SWING)
        result = cdot.simulate(scene, until=0.5, step=0.1, times=[0, 0.25, 0.5], record=["energies"])
        self.assertEqual(list(result.times), [0, 0.25, 0.5])
        self.assertEqual((scene.duration, scene.step, scene.sensors), (1, 0.01, ["rise"]))
        self.assertGreater(len(result.scene.sensors), 1)
        self.assertEqual(copy.deepcopy(scene).bodies, ["bob"])

    def test_continues_from_a_state_to_the_bit(self):
        scene = cdot.Scene.of_text(SWING)
        whole = cdot.simulate(scene, save=True)
        half = cdot.simulate(scene, until=0.5, save=True)
        rest = cdot.simulate(scene, start=half.state, save=True)
        self.assertAlmostEqual(half.state.time, 0.5, places=12)
        self.assertEqual(rest.state, whole.state)
        self.assertEqual(rest.state.differences(half.state)[0], "time")

    def test_an_accuracy_chooses_the_method(self):
        result = cdot.simulate("simple_pendulum", until=1, accuracy=1e-6, times=[1])
        self.assertEqual(result.failure, "")
        self.assertIn("accuracy", json.loads(result.json))
        self.assertIn("1.0e-06 m, rad asked for", result.text)

    def test_failures_say_why(self):
        scene = cdot.Scene.of_text(SWING.replace('"rk4"', '"euler"').replace("step = 0.01", "step = 0.5"))
        result = cdot.simulate(scene)
        self.assertNotEqual(result.failure + result.warnings, "")
        with self.assertRaisesRegex(ValueError, "finite and > 0, but is -1"):
            cdot.simulate(scene, until=-1)
        with self.assertRaisesRegex(ValueError, "a time of the output must be"):
            cdot.simulate(scene, times=[math.nan])
        with self.assertRaisesRegex(ValueError, "no group `torques` to record. Known groups: all, coordinates"):
            cdot.simulate(scene, record=["torques"])

    def test_world_of_a_scene_moves_as_its_run(self):
        scene = cdot.Scene.of_text(SWING)
        world = cdot.World.from_scene(scene)
        world.step(count=100)
        np.testing.assert_array_equal(world.states(), cdot.simulate(scene).states[-1])


if __name__ == "__main__":
    unittest.main()
