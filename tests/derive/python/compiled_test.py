"""Compiled scenes: a variant in each lane moves as a World does, and as it does alone, bit for bit."""
import os
import unittest

import numpy as np

import cdot

source = os.environ["CDOT_SOURCE_DIR"]
steps, h = 200, 1e-3


class Compiled(unittest.TestCase):
    def varied(self, scene, variants, **wishes):
        """The closed start with other velocities along its motion: the projection keeps what the joints allow."""
        batch = cdot.compile(scene, variants, **wishes)
        states = batch.states()
        half = states.shape[2] // 2
        states[:, :, half:] *= np.linspace(-1, 1.5, variants)[:, None, None]
        batch.set_states(states)
        return batch, batch.states()

    def test_variants_move_as_worlds(self):
        batch, starts = self.varied("four_bar", 11)
        with open(f"{source}/specs/scenes/four_bar.toml", encoding="utf-8") as file:
            by_rk4 = cdot.Scene.of_text('integrator = "rk4"\n' + file.read())
        ends = cdot.batch(batch, h, steps)
        self.assertEqual(ends.shape, (11, 3, 6))
        moved = 0.0
        for start, end in zip(starts, ends):
            world = cdot.World.from_scene(by_rk4)
            before = world.states()
            before[:3] = start
            world.set_states(before)
            world.step(h, count=steps)
            np.testing.assert_allclose(end, world.states()[:3], atol=1e-9)
            moved = max(moved, abs(end - start).max())
        self.assertGreater(moved, 0.2)
        self.assertGreater(abs(ends[0] - ends[-1]).max(), 0.1)
        self.assertLess(batch.errors().max(), 1e-12)
        self.assertAlmostEqual(batch.time, h * steps)

    def test_lanes_have_the_bits_of_one_alone(self):
        batch, starts = self.varied("spatial/gyroscope", 9, integrator="rattle")
        ends = cdot.batch(batch, h, steps)
        for k in (0, 5, 8):
            alone = cdot.compile("spatial/gyroscope", 1, integrator="rattle")
            alone.set_states(starts[k:k + 1])
            alone.step(h, count=steps)
            np.testing.assert_array_equal(alone.states()[0], ends[k])
            self.assertEqual(alone.energies()[0], batch.energies()[k])

    def test_inputs_differ(self):
        servo = "shoulder.angle.servo.target"
        targets = np.linspace(-0.5, 1, 5)
        batch = cdot.compile("robot_arm", 5, integrator="euler", inputs=[servo], lanes=4)
        batch.set(servo, targets)
        ends = cdot.batch(batch, h, 300)
        angles = ends[:, 0, 2]
        self.assertTrue((np.diff(angles) > 1e-4).all(), angles)
        batch.set(servo, 0.25)
        with self.assertRaisesRegex(KeyError, "there is no input `elbow`; the inputs are: shoulder"):
            batch.set("elbow", 1)
        with self.assertRaisesRegex(ValueError, "has 2 numbers, but there are 5 variants"):
            batch.set(servo, [1, 2])

    def test_results_may_fill_an_array(self):
        batch = cdot.compile("four_bar", 3)
        out = np.empty((3, 3, 6))
        self.assertIs(cdot.batch(batch, h, 7, out=out), out)
        np.testing.assert_array_equal(out, batch.states())

    def test_mistakes_are_told(self):
        with self.assertRaisesRegex(ValueError, "integrator must be one of euler, .*, but is `heun`"):
            cdot.compile("four_bar", integrator="heun")
        with self.assertRaisesRegex(cdot.Error, "no number of this scene is called no_number"):
            cdot.compile("four_bar", inputs=["no.number"])
        with self.assertRaisesRegex(cdot.Error, "text.toml is no file. Fix: write the scene into one"):
            cdot.compile(cdot.Scene.of_text('[[body]]\nname = "b"\nmass = 1\nshape = { disc = 1 }\n'))
        with self.assertRaisesRegex(ValueError, "lanes must be 4, 8 or 16, but is 5"):
            cdot.compile("four_bar", lanes=5)
        with self.assertRaisesRegex(ValueError, "variants must be >= 1"):
            cdot.compile("four_bar", 0)
        batch = cdot.compile("four_bar", 2)
        for wrong in (0.0, -1.0, float("nan")):
            with self.assertRaisesRegex(cdot.Error, "a step has a positive length"):
                batch.step(wrong)
        with self.assertRaises(ValueError):
            batch.set_states(np.zeros((2, 4, 6)))
        states = batch.states()
        states[1, 0, 3] = np.inf
        batch.set_states(states)
        with self.assertRaisesRegex(cdot.Error, "variant 1 of the batch: its state is not a number"):
            batch.step(h)


if __name__ == "__main__":
    unittest.main()
