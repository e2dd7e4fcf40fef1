"""Derivations as sympy: laws between C, J and K, the runtime's kernels as a second route, texts as generated/ has them."""
import os
import random
import unittest

import numpy as np
import sympy

import cdot

source = os.environ["CDOT_SOURCE_DIR"]


def zero(matrix):
    return all(sympy.simplify(entry) == 0 for entry in matrix)


class Sympy(unittest.TestCase):
    def test_jacobian_is_the_slope_of_the_constraint(self):
        for name in ("line", "distance", "prismatic", "pulley"):
            joint = cdot.derive(name)
            C, J = joint.in_pose(joint.C), joint.in_pose(joint.J)
            q = sympy.Matrix([joint.symbols[column.replace("v_", "x_").replace("w_", "theta_")]
                              for column in joint.columns])
            self.assertTrue(zero(C.jacobian(q) - J), name)

    def test_effective_mass_is_made_of_the_jacobian(self):
        joint = cdot.derive("line")
        masses = [joint.symbols[f"inv_{'I' if column[0] == 'w' else 'm'}_{column[2]}"] for column in joint.columns]
        off = joint.J * sympy.diag(*masses) * joint.J.T - joint.K
        turn = sympy.Symbol("turn", real=True)  # t has length 1
        self.assertTrue(zero(off.subs({joint.symbols["t_x"]: sympy.cos(turn), joint.symbols["t_y"]: sympy.sin(turn)})))

    def test_right_hand_side_and_rate(self):
        joint = cdot.derive("driven_crank")  # depends on time
        v = sympy.Matrix([joint.symbols[column] for column in joint.columns])
        self.assertTrue(zero(joint.b + joint.J * v + joint.C_t))
        self.assertFalse(zero(joint.C_t))

    def test_gamma_is_the_turning_of_the_jacobian(self):
        """gamma = -Jdot v, with J on the way q + s v."""
        s = sympy.Symbol("s")
        for name in ("line", "pulley"):
            joint = cdot.derive(name)
            v = sympy.Matrix([joint.symbols[column] for column in joint.columns])
            q = [joint.symbols[column.replace("v_", "x_").replace("w_", "theta_")] for column in joint.columns]
            on_the_way = joint.in_pose(joint.J).subs({x: x + s * rate for x, rate in zip(q, v)}, simultaneous=True)
            off = joint.in_pose(joint.gamma) + ((on_the_way * v).diff(s)).subs(s, 0)
            numbers = {symbol: sympy.Rational(k + 2, 7) for k, symbol in
                       enumerate(sorted(off.free_symbols, key=lambda symbol: symbol.name))}
            self.assertLess(abs(off.subs(numbers).evalf(30)[0]), 1e-25, name)

    def test_coordinates(self):
        joint = cdot.derive("revolute")
        angle = joint.coordinates["angle"]
        self.assertEqual(angle.J, sympy.Matrix([[0, 0, -1, 0, 0, 1]]))
        self.assertEqual(angle.K, sympy.Matrix([[joint.symbols["inv_I_a"] + joint.symbols["inv_I_b"]]]))

    def test_laws_of_effects(self):
        """Forces are the slopes of energies, and slopes those of forces: sympy differentiates on its own."""
        laws = bounds = 0
        for folder in ("planar", "coordinate"):
            for file in sorted(os.listdir(f"{source}/specs/{folder}")):
                if not file.endswith(".effect"):
                    continue
                effect = cdot.derive(f"{source}/specs/{folder}/{file}")
                bounds += len(effect.bounds)
                if effect.law is None:
                    self.assertTrue(effect.bounds, file)
                    continue
                laws += 1
                law = effect.law
                rows = range(len(law.rate))
                slope = lambda e, by: 0 if by is None else sympy.diff(e, by)
                off = [law.force[i] - law.unstored[i] + slope(law.energy, law.value[i]) for i in rows]
                off += [law.stiffness[i, j] + slope(law.force[i], law.value[j]) for i in rows for j in rows]
                off += [law.damping[i, j] + slope(law.force[i], law.rate[j]) for i in rows for j in rows]
                free = sorted(set().union(*(sympy.sympify(e).free_symbols for e in off)), key=lambda symbol: symbol.name)
                numbers = {symbol: sympy.Rational(2 * k + 3, 5 + k) for k, symbol in enumerate(free)}
                for e in off:
                    self.assertLess(abs(sympy.sympify(e).subs(numbers).doit().evalf(30)), 1e-20, f"{file}: {e}")
        self.assertGreater(laws, 25)
        self.assertGreater(bounds, 12)

    def test_bounds_of_an_effect(self):
        brake = cdot.derive("planar/rough_line")
        hold = next(bound for bound in brake.bounds if bound.rate is not None)
        self.assertEqual(hold.rate, 0)
        self.assertEqual(hold.by_upper, brake.symbols["mu"])
        self.assertEqual(hold.by_lower, -brake.symbols["mu"])

    def test_numbers_of_the_runtime(self):
        """C, Cdot of a World by its compiled kernel, and by sympy."""
        rng = random.Random(5)
        world = cdot.World()
        for body in "ab":
            world.add_body(body, mass=1, inertia=1, position=[rng.random(), rng.random()], angle=rng.uniform(-3, 3),
                           velocity=[rng.random(), rng.random()], omega=rng.random())
        world.add_joint("j", "line", ["a", "b"], pa=[0.3, 0.2], pb=[-0.1, 0.4], t=[0.6, 0.8])
        numbers = {}
        for body, (x, y, angle, vx, vy, w) in zip("ab", world.states()):
            numbers |= {f"x_{body}_x": x, f"x_{body}_y": y, f"theta_{body}": angle, f"v_{body}_x": vx,
                        f"v_{body}_y": vy, f"w_{body}": w, f"inv_m_{body}": 1, f"inv_I_{body}": 1}
        for name, (x, y) in world.parameters("j").items():
            numbers |= {f"{name}_local_x": x, f"{name}_local_y": y}
        joint = cdot.derive("line")
        np.testing.assert_allclose(joint.function("C")(**numbers)[:, 0], world.position_error("j"), rtol=1e-12)
        np.testing.assert_allclose(joint.function("Cdot")(**numbers)[:, 0], world.velocity_error("j"), rtol=1e-12)
        many = {name: np.full(7, value) for name, value in numbers.items()}
        self.assertEqual(joint.function("J")(**many).shape, (1, 6, 7))
        many["theta_a"] = np.linspace(0, 1, 7)
        slopes = joint.function("J")(**many)
        for k, angle in enumerate(many["theta_a"]):
            np.testing.assert_array_equal(slopes[..., k], joint.function("J")(**{**numbers, "theta_a": angle}))
        with self.assertRaisesRegex(TypeError, "needs the numbers inv_I_a"):
            joint.function("K")()
        with self.assertRaisesRegex(TypeError, "has no symbols mass"):
            joint.function("C")(**numbers, mass=1)


class Texts(unittest.TestCase):
    def test_kernel_is_the_generated_file(self):
        for spec in ("planar/line", "spatial/universal", "planar/spring", "coordinate/motor"):
            with open(f"{source}/generated/{spec}.hpp", encoding="utf-8") as file:
                self.assertEqual(cdot.derive(spec).kernel(), file.read(), spec)

    def test_formulas(self):
        plain, latex = zip(*cdot.derive("line").formulas()[0])
        self.assertIn("u = pa - pb", plain)
        self.assertIn(r"\mathbf{u} = \mathbf{p}_{a} - \mathbf{p}_{b}", latex)
        text = cdot.derive("line").latex()
        self.assertTrue(text.startswith("\\begin{aligned}\n"))
        self.assertEqual(text.count(" &= "), len(latex))

    def test_lectures(self):
        joint = cdot.derive("spatial/distance")
        self.assertIn("\\end{document}", joint.lecture("latex"))
        self.assertIn("<math", joint.lecture("html"))
        self.assertNotEqual(joint.lecture(), joint.lecture(form="euler"))
        with self.assertRaisesRegex(ValueError, "in the plane w is one number"):
            cdot.derive("line").lecture(form="euler")

    def test_engines(self):
        hinge = cdot.derive("hinge")
        self.assertIn("btTypedConstraint", hinge.emit("bullet"))
        with self.assertRaisesRegex(ValueError, "engine must be one of .* but is `bulet`"):
            hinge.emit("bulet")
        with self.assertRaisesRegex(RuntimeError, "line cannot be emitted for dart: it is planar"):
            cdot.derive("line").emit("dart")

    def test_own_spec_from_text(self):
        joint = cdot.derive("joint rod planar\npoint pa on a\npoint pb on b\n"
                            "scalar l [m] = norm(pa - pb)\nnorm(pa - pb) = l\n")
        self.assertEqual(joint.name, "rod")
        self.assertTrue(zero(joint.K - cdot.derive("distance").K))
        self.assertEqual(cdot.derive("joint pin planar\ninclude revolute\n").rows, cdot.derive("revolute").rows)

    def test_mistakes_show_the_line(self):
        with self.assertRaisesRegex(cdot.Error, r"(?s)rod.joint:3:1.*nrom\(pa - pb\).*\^.*did you mean `norm`"):
            cdot.derive("joint rod planar\npoint pa on a, pb on b\nnrom(pa - pb) = 1 [m]\n")
        with self.assertRaisesRegex(cdot.NoSuchSpec, "did you mean `distance`"):
            cdot.derive("distence")


if __name__ == "__main__":
    unittest.main()
