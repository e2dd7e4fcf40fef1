"""Worlds of Python: motion against closed forms, arrays without copies, mistakes as exceptions."""
import gc
import math
import pathlib
import threading
import unittest

import numpy as np

import cdot

g = 9.81


def pendulum(length=1.0, angle=0.0, integrator="rk4"):
    """A point mass on a rod that hangs from the origin, at rest at an angle from straight down."""
    world = cdot.World(gravity=[0, -g], integrator=integrator)
    world.add_body("bob", mass=2, position=[length * math.sin(angle), -length * math.cos(angle)])
    world.add_joint("rod", "distance", ["world", "bob"], pa=[0, 0], pb=[0, 0])
    return world


class Motion(unittest.TestCase):
    def test_scene_of_the_catalogue_steps(self):
        world = cdot.World.from_scene("four_bar")
        before = world.states()
        world.step()
        self.assertEqual(world.bodies, ["v0", "h0", "v1", "world"])
        self.assertEqual(world.positions.shape, (4, 2))
        self.assertAlmostEqual(world.time, world.usual_step)
        # The crank's end moves at 1 m/s along x at the start; gravity acts on no link in that direction.
        self.assertAlmostEqual(world.positions[1, 0] - before[1, 0], 1 * world.usual_step, places=4)
        self.assertLess(world.worst_error(), 1e-9)

    def test_pendulum_has_the_period_of_the_elliptic_integral(self):
        angle = 1.2
        a, b = 1.0, math.cos(angle / 2)  # their arithmetic-geometric mean
        for _ in range(6):
            a, b = (a + b) / 2, math.sqrt(a * b)
        period = 2 * math.pi / a * math.sqrt(1 / g)
        world = pendulum(angle=angle)
        start = np.array(world.positions[0])
        world.step(period / 400, count=400)
        np.testing.assert_allclose(world.positions[0], start, atol=1e-7)

    def test_space_has_quaternions(self):
        world = cdot.World.from_scene("spatial/gyroscope")
        self.assertIsInstance(world, cdot.SpatialWorld)
        world.step(count=20)
        self.assertEqual(world.orientations.shape[1], 4)
        self.assertEqual(world.states().shape[1], 13)
        np.testing.assert_allclose(np.linalg.norm(world.orientations, axis=1), 1, atol=1e-12)

    def test_reaction_carries_the_weight(self):
        world = pendulum()
        world.step(1e-3)
        np.testing.assert_allclose(world.reaction("rod", "bob"), [0, 2 * g, 0], atol=1e-9)

    def test_energies_and_work_of_a_motor(self):
        world = cdot.World()
        world.add_body("wheel", mass=1, inertia=0.5)
        world.add_joint("axle", "revolute", ["world", "wheel"], pa=[0, 0], pb=[0, 0])
        world.add_effect("axle", "angle", "motor", speed=3, max=2)
        world.step(1e-3, count=2000)
        self.assertAlmostEqual(world.rates("axle")["angle"], 3)
        self.assertAlmostEqual(world.work()["motor"], 0.5 * 0.5 * 3**2, places=9)
        self.assertAlmostEqual(world.balance()["kinetic"], 0.5 * 0.5 * 3**2, places=9)
        self.assertAlmostEqual(world.balance()["method"], 0, places=9)

    def test_effects_by_the_paths_of_their_specs(self):
        def turned(motor, brake):
            world = cdot.World()
            for name in ("wheel", "rim"):
                world.add_body(name, mass=1, inertia=0.5)
            world.add_joint("axle", "revolute", ["world", "wheel"], pa=[0, 0], pb=[0, 0])
            world.add_joint("shoe", brake, ["wheel", "rim"], torque=0.3)
            world.add_effect("axle", "angle", motor, speed=3, max=2)
            world.step(1e-3, count=500)
            return world.velocities.tolist()

        specs = pathlib.Path(__file__).parents[3] / "specs"
        own = turned(str(specs / "coordinate/motor.effect"), str(specs / "planar/brake.effect"))
        self.assertEqual(own, turned("motor", "brake"))
        self.assertGreater(own[1][2], 0.1)

    def test_an_effect_ends_a_joint(self):
        specs = pathlib.Path(__file__).parents[3] / "specs"
        for breaking in ("breaking", str(specs / "coordinate/breaking.effect")):
            for strength, broken in ((1.9 * g, ["rod"]), (2.1 * g, [])):
                world = pendulum()  # the rod carries 2 g
                world.add_effect("rod", breaking, strength=strength)
                world.step(1e-3, count=2)
                self.assertEqual(world.broken(), broken)
        with self.assertRaisesRegex(cdot.Error, "name the coordinate"):
            pendulum().add_effect("rod", "motor", speed=1)

    def test_joints_change_and_break(self):
        world = pendulum()
        world.set_parameters("rod", l=1.5)
        world.step(1e-3)
        self.assertAlmostEqual(np.hypot(*world.positions[0]), 1.5, places=9)
        world.set_breaking_load("rod", g)
        self.assertEqual(world.broken(), [])
        world.step(1e-3, count=2)
        self.assertEqual(world.broken(), ["rod"])
        before = world.velocities[0, 1]
        world.step(0.1)
        self.assertAlmostEqual(world.velocities[0, 1] - before, -0.1 * g)

    def test_batch_has_the_bits_of_single_worlds(self):
        angles = np.linspace(0.1, 2, 9)
        states = cdot.batch([pendulum(angle=angle) for angle in angles], 1e-3, 200, threads=4)
        for angle, state in zip(angles, states):
            alone = pendulum(angle=angle)
            alone.step(1e-3, count=200)
            np.testing.assert_array_equal(state, alone.states())
        with self.assertRaisesRegex(ValueError, "a World occurs twice"):
            cdot.batch([alone, alone], 1e-3, 1)


class Arrays(unittest.TestCase):
    def test_views_show_the_world_itself(self):
        world = pendulum(angle=1)
        positions, velocities = world.positions, world.velocities
        self.assertTrue(np.shares_memory(positions, world.positions))
        start = positions.copy()
        world.step(0.01, count=5)
        self.assertFalse(np.array_equal(positions, start))
        np.testing.assert_array_equal(positions, world.states()[:, :2])
        np.testing.assert_array_equal(world.orientations, world.states()[:, 2])
        np.testing.assert_array_equal(velocities, world.states()[:, 3:])
        with self.assertRaises(ValueError):
            positions[0, 0] = 1

    def test_a_view_keeps_its_world_alive(self):
        positions = pendulum(angle=1).positions
        kept = positions.copy()
        gc.collect()
        garbage = [np.full(4096, np.nan) for _ in range(64)]
        np.testing.assert_array_equal(positions, kept)
        del garbage

    def test_a_view_keeps_the_memory_of_an_older_layout(self):
        world = pendulum(angle=1)
        old = world.positions
        kept = old.copy()
        world.remove_joint("rod")
        world.add_body("more", mass=1)
        world.step(0.01)
        garbage = [np.full(4096, np.nan) for _ in range(64)]
        np.testing.assert_array_equal(old, kept)
        self.assertEqual(world.positions.shape, (3, 2))
        self.assertFalse(np.array_equal(world.positions[:2], kept))
        del garbage

    def test_out_is_filled_in_place(self):
        world, twin = pendulum(angle=1), pendulum(angle=1)
        out = np.empty((300, 2, 6))
        world.step(1e-3, count=300, out=out)
        for state in out:
            twin.step(1e-3)
            np.testing.assert_array_equal(state, twin.states())
        for wrong in (np.empty((300, 2, 5)), np.empty((300, 2, 6), dtype=np.float32), np.empty((6, 2, 300)).T):
            with self.assertRaises((TypeError, ValueError)):
                world.step(1e-3, count=300, out=wrong)
        self.assertEqual(world.time, twin.time)

    def test_states_go_in_as_they_come_out(self):
        world = pendulum(angle=1)
        world.step(1e-3, count=50)
        kept, bits = world.states(), world.hash()
        world.set_states(kept)
        self.assertEqual(world.hash(), bits)
        world.step(1e-3, count=50)
        world.set_states(kept)
        self.assertEqual(world.hash(), bits)
        with self.assertRaisesRegex(ValueError, r"states must have the shape \(2, 6\), but has \(1, 6\)"):
            world.set_states(kept[:1])

    def test_snapshots_restore_to_the_bit(self):
        world = pendulum(angle=1)
        world.step(1e-3, count=10)
        snapshot = world.snapshot()
        world.step(1e-3, count=10)
        bits = world.hash()
        world.restore(cdot.Snapshot.read(snapshot.text()))
        self.assertEqual(world.time, snapshot.time)
        world.step(1e-3, count=10)
        self.assertEqual(world.hash(), bits)
        self.assertIn("bodies.pose", world.snapshot().differences(snapshot))


class Mistakes(unittest.TestCase):
    def check(self, kind, message, call, *arguments, **keywords):
        with self.assertRaisesRegex(kind, message):
            call(*arguments, **keywords)

    def test_names_have_suggestions(self):
        world = pendulum()
        self.check(KeyError, "there is no joint `rodd`; did you mean `rod`", world.coordinates, "rodd")
        self.check(KeyError, "there is no body `bub`", world.reaction, "rod", "bub")
        self.check(IndexError, "there is no joint number 7: the World has 1", world.impulse, 7)
        self.check(TypeError, "no keyword `mas`; did you mean `mass`", world.add_body, "x", mas=1)
        self.check(ValueError, "the name `bob` of a body is taken", world.add_body, "bob", mass=1)
        self.check(ValueError, "integrator must be one of euler, .* but is `ruler`", cdot.World, integrator="ruler")

    def test_the_world_refuses(self):
        world = pendulum()
        self.check(cdot.Error, "mass > 0", world.add_body, "x")
        self.check(cdot.Error, "distence", world.add_joint, "j", "distence", ["world", "bob"])
        self.check(cdot.Error, "this is a state of planar double, direct, rattle", world.restore, cdot.World.from_scene("four_bar").snapshot())
        self.check(cdot.Error, r"(?s)step.*Likely fix", world.step, -1)
        self.assertEqual(world.time, 0)

    def test_scenes_show_line_and_fix(self):
        self.check(cdot.SceneError, "there is no such scene\n.*four_bar", cdot.World.from_scene, "four_baar")
        self.check(cdot.SceneError, r"(?s)mine.toml:2:1.*positon.*did you mean.*position", cdot.Scene.of_text,
                   "[[body]]\npositon = [0, 0]\nmass = 1", "mine.toml")

    def test_a_world_belongs_to_one_thread_at_a_time(self):
        world = pendulum(angle=1)
        thread = threading.Thread(target=lambda: world.step(1e-4, count=200_000))
        thread.start()
        refused = False
        while thread.is_alive() and not refused:
            try:
                world.energy()
            except cdot.Error as error:
                refused = "another thread steps this World" in str(error)
        thread.join()
        self.assertTrue(refused)
        self.assertAlmostEqual(world.time, 20)


if __name__ == "__main__":
    unittest.main()
