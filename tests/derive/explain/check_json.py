"""Evaluates with sympy and 40 digits what `cdot explain --json` wrote, and checks it.

At random poses J and dC/dt are the finite differences of C, Cdot is J v + dC/dt, K is J M^-1 J^T,
gamma is minus the rate of Cdot at constant velocities. Exit status 0 if all of it holds for all
files of a folder.
"""
import functools
import glob
import json
import os
import random
import re
import sys

import sympy
from mpmath import mp, mpf

mp.dps = 40
STEP = mpf(10) ** -12
TOLERANCE = mpf(10) ** -18
NAME = re.compile(r"[A-Za-z_]\w*")
FUNCTIONS = {"sqrt", "sin", "cos", "tan", "atan2", "exp", "log", "abs", "sign"}


@functools.cache  # entries repeat, within a file and between joints
def function_of(text):
    names = sorted(set(NAME.findall(text)) - FUNCTIONS)
    symbols = {name: sympy.Symbol(name, real=True) for name in names}
    expression = sympy.sympify(text, locals={**symbols, "abs": sympy.Abs})
    function = sympy.lambdify([symbols[n] for n in names], expression, modules="mpmath")
    return lambda values: mpf(function(*(values[n] for n in names)))


class Program:
    """One file: symbols, intermediates, entries, as functions of a dictionary of values."""

    def __init__(self, data):
        self.data = data
        self.spatial = data["dimension"] == 3
        self.symbols = data["symbols"]
        self.known = list(self.symbols)
        self.derived = [(n, self.compiled(s["from"])) for n, s in self.symbols.items() if s["from"]]
        self.intermediates = []
        for item in data["intermediates"]:
            self.intermediates.append((item["name"], self.compiled(item["definition"])))
            assert item["name"] not in self.known, item["name"] + " is defined twice"
            self.known.append(item["name"])

    def compiled(self, text):
        unknown = set(NAME.findall(text)) - set(self.known) - FUNCTIONS
        assert not unknown, f"{text}: undocumented or not yet defined: {unknown}"
        return function_of(text)

    def values(self, state):
        values = dict(state)
        for name, function in self.derived + self.intermediates:
            values[name] = function(values)
        return values

    def random_state(self, rng):
        state = {}
        for name, symbol in self.symbols.items():
            if symbol["kind"] == "constant":
                state[name] = mp.pi
            elif symbol["kind"] in ("mass", "parameter", "time", "value", "rate", "force"):
                state[name] = mpf(rng.uniform(0.5, 2))
            elif symbol["kind"] in ("position", "velocity", "orientation"):
                state[name] = mpf(rng.uniform(-2, 2))
        for body in self.data["bodies"] if self.spatial else []:
            normalise(state, [f"e_{body}_{k}" for k in range(4)])
        letters = "xyz" if self.spatial else "xy"
        for name, symbol in self.symbols.items():
            if symbol["unit_length"] and name in state and name.endswith("_x"):
                normalise(state, [name[:-1] + c for c in letters], rng)
        for frame in self.data["frames"]:
            columns = zip(*rotation([mpf(rng.uniform(-1, 1)) for _ in range(4)]))
            for names, axis in zip(frame["axes"], columns):
                state.update(zip(names, axis))
        return state

    def directions(self, state):
        """Of each column of J: what changes, and how fast."""
        result = []
        for column in self.data["columns"]:
            if column.startswith("v_"):
                result.append({"x_" + column[2:]: mpf(1)})
            elif self.spatial:
                result.append(self.turn(state, column[2:-2], "xyz".index(column[-1])))
            else:
                result.append({"theta_" + column[2:]: mpf(1)})
        return result

    def turn(self, state, body, axis):
        """de/dt = 1/2 G^T w, of a turn about a world axis at unit rate."""
        names = [f"e_{body}_{k}" for k in range(4)]
        e = [state[name] for name in names]
        G = [[-e[1], e[0], -e[3], e[2]], [-e[2], e[3], e[0], -e[1]], [-e[3], -e[2], e[1], e[0]]]
        return dict(zip(names, [g / 2 for g in G[axis]]))

    def inverse_mass(self, state, j, k):
        a, b = self.data["columns"][j], self.data["columns"][k]
        if a[0] == "v":
            return state["inv_m_" + a[2:-2]] if j == k else 0
        if not self.spatial:
            return state["inv_I_" + a[2:]] if j == k else 0
        if b[0] == "v" or a[:-1] != b[:-1]:
            return 0
        return state["inv_I_" + a[2:-1] + min(a[-1], b[-1]) + max(a[-1], b[-1])]


def normalise(state, names, rng=None):
    if rng is not None:
        state.update({name: mpf(rng.uniform(-1, 1)) for name in names})
    length = mp.sqrt(sum(state[name] ** 2 for name in names))
    state.update({name: state[name] / length for name in names})


def rotation(e):
    length = mp.sqrt(sum(x * x for x in e))
    a, b, c, d = (x / length for x in e)
    return [[a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d]]


def close(a, b):
    return abs(a - b) <= TOLERANCE * (1 + abs(a) + abs(b))


class State:
    """A random state, and its neighbours by which all entries are differentiated."""

    def __init__(self, program, symbols):
        self.program, self.symbols = program, symbols
        self.values = program.values(symbols)
        directions = program.directions(symbols)
        motion = {}
        for direction, column in zip(directions, program.data["columns"]):
            for name, rate in direction.items():
                motion[name] = motion.get(name, 0) + rate * symbols[column]
        in_time = {"time": mpf(1)} if "time" in symbols else {}
        self.along_columns = [self.neighbours(direction) for direction in directions]
        self.in_time = self.neighbours(in_time)
        self.along_motion = self.neighbours({**motion, **in_time})

    def neighbours(self, direction):
        return [self.program.values({**self.symbols, **{name: self.symbols[name] + step * rate
                                                        for name, rate in direction.items()}})
                for step in (STEP, -STEP)]


def difference(function, neighbours):
    there, back = neighbours
    return (function(there) - function(back)) / (2 * STEP)


class Checks:
    def __init__(self, program, block, kinds, where):
        self.program, self.kinds, self.where = program, kinds, where
        self.failures, self.done = [], 0
        matrix = lambda rows: [[program.compiled(e) for e in row] for row in rows]
        vector = lambda entries: [program.compiled(e) for e in entries]
        self.C, self.Cdot, self.C_t = (vector(block[key]) for key in ("C", "Cdot", "C_t"))
        self.J, self.K, self.gamma = matrix(block["J"]), matrix(block["K"]), vector(block["gamma"])
        self.text = block

    def expect(self, name, a, b):
        self.done += 1
        if not close(a, b):
            self.failures.append(f"{self.where}: {name}: {mp.nstr(a, 12)} is not {mp.nstr(b, 12)}")

    def at(self, state):
        columns, symbols, values = self.program.data["columns"], state.symbols, state.values
        J = [[f(values) for f in row] for row in self.J]
        for i, kind in enumerate(self.kinds):
            if kind != "velocity":
                for j, neighbours in enumerate(state.along_columns):
                    self.expect(f"J[{i}][{j}]", J[i][j], difference(self.C[i], neighbours))
                self.expect(f"C_t[{i}]", self.C_t[i](values), difference(self.C[i], state.in_time))
                self.expect(f"Cdot[{i}] along the motion", self.Cdot[i](values),
                            difference(self.C[i], state.along_motion))
            Jv = sum(J[i][j] * symbols[c] for j, c in enumerate(columns))
            self.expect(f"Cdot[{i}]", self.Cdot[i](values), Jv + self.C_t[i](values))
            self.expect(f"gamma[{i}]", self.gamma[i](values),
                        -difference(self.Cdot[i], state.along_motion))
            assert len(self.K) == len(self.K[i]) == len(self.kinds), "K is not square"
            for k in range(len(self.kinds)):
                K = sum(J[i][j] * self.program.inverse_mass(symbols, j, l) * J[k][l]
                        for j in range(len(columns)) for l in range(len(columns)))
                self.expect(f"K[{i}][{k}]", self.K[i][k](values), K)
        return J

    def zeros(self, Js):
        """An entry that is zero at every pose is written 0."""
        for i, row in enumerate(self.text["J"]):
            for j, text in enumerate(row):
                if all(J[i][j] == 0 for J in Js) and text != "0":
                    self.failures.append(f"{self.where}: J[{i}][{j}] is zero but says {text}")


class Law:
    """Forces are the slopes of the energy, and slopes those of the forces; expressions of bounds can be read."""

    def __init__(self, program, data):
        self.program, self.where, self.failures, self.done = program, data["joint"] + ".law", [], 0
        law = data["law"] or {"value": [], "rate": [], "energy": None, "force": [], "unstored": [], "stiffness": [],
                              "damping": []}
        self.leaves = {"stiffness": law["value"], "damping": law["rate"]}
        self.energy = program.compiled(law["energy"] or "0")
        self.force, self.unstored = ([program.compiled(e) for e in law[key]] for key in ("force", "unstored"))
        self.slopes = {key: [[program.compiled(e) for e in row] for row in law[key]] for key in self.leaves}
        self.bounds = [program.compiled(e) for bound in data["bounds"] for key, e in bound.items()
                       if e is not None and key not in ("name", "text", "coordinate")]

    def at(self, state):
        along = {leaf: state.neighbours({leaf: mpf(1)}) for leaves in self.leaves.values() for leaf in leaves if leaf}
        slope = lambda function, leaf: difference(function, along[leaf]) if leaf else mpf(0)
        for i, force in enumerate(self.force):
            stored = force(state.values) - self.unstored[i](state.values)
            self.expect(f"force[{i}]", stored, -slope(self.energy, self.leaves["stiffness"][i]))
            for key, leaves in self.leaves.items():
                for j, leaf in enumerate(leaves):
                    self.expect(f"{key}[{i}][{j}]", self.slopes[key][i][j](state.values), -slope(force, leaf))
        for bound in self.bounds:
            self.done += 1
            if not mp.isfinite(bound(state.values)):
                self.failures.append(f"{self.where}: a bound has no value")

    expect = Checks.expect


def check(path):
    with open(path) as file:
        data = json.load(file)
    program = Program(data)
    for name, symbol in data["symbols"].items():
        assert symbol["meaning"] and symbol["unit"], f"{name} is not documented"
    blocks = [Checks(program, data, [r["kind"] for r in data["rows"]], data["joint"])]
    for c in data["coordinates"]:
        blocks.append(Checks(program, c, [c.get("kind", "equality")], data["joint"] + "." + c["name"]))
    rng = random.Random(7)
    states = [State(program, program.random_state(rng)) for _ in range(3)]
    law = Law(program, data)
    for state in states:
        law.at(state)
    for block in blocks:
        block.zeros([block.at(state) for state in states])
    blocks.append(law)
    return sum(b.done for b in blocks), [f for b in blocks for f in b.failures]


def main():
    files = sorted(glob.glob(os.path.join(sys.argv[1], "*.json")))
    assert files, "no file to check"
    failures, done = [], 0
    for path in files:
        try:
            count, wrong = check(path)
            assert count > 0, "nothing was checked"
        except AssertionError as e:
            count, wrong = 0, [f"{path}: {e}"]
        done += count
        failures += wrong
    summary = f"{done} values in {len(files)} files, {len(failures)} wrong"
    print("\n".join(failures + [f"sympy {sympy.__version__}: {summary}"]))
    return 1 if failures else 0


sys.exit(main())
