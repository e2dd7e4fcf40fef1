#!/usr/bin/env python3
"""The angles of clutches.toml by a second route: backward Euler, where each torque is a set at the rate at which it
jumps. I dw = h tau(w) has one solution, since tau falls with w."""
import math

m, g, k, d, motor, friction, h = 0.5, 9.81, 5.0, 3.0, 10.0, 4.0, 2e-6
I = m / 3


def torque(w, speed, q, side_of_motor, side_of_friction):
    return -m * g * 0.5 * math.cos(q) - k * q - d * w + motor * side_of_motor - friction * side_of_friction


def next_rate(w0, q, speed):
    sign = lambda x: (x > 0) - (x < 0)
    for w in (0.0, speed):  # the rates at which a torque may take any value between its bounds
        sides = [(s, f) for s in ((-1, 1) if w == speed else (sign(speed - w),))
                 for f in ((-1, 1) if w == 0 else (sign(w),))]
        needs = [I * (w - w0) - h * torque(w, speed, q, s, f) for s, f in sides]
        if min(needs) <= 0 <= max(needs):
            return w
    for s in (-1, 1):
        for f in (-1, 1):
            w = (I * w0 + h * (torque(0, speed, q, s, f))) / (I + h * d)
            if sign(speed - w) == s and sign(w) == f:
                return w
    raise ArithmeticError("no solution")


q = w = 0.0
for step in range(1, round(1.5 / h) + 1):
    w = next_rate(w, q, 1.22 * math.cos(2 * step * h))
    q += h * w
    if step % round(0.25 / h) == 0:
        print(f"{step * h:.2f} s: {q:.5f}")
