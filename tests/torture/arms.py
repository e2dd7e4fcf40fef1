"""Random arms of one to three rods, loops and discs, as scenes: scene(kind, seed).

`rods`: motors, limits, friction, springs, dampers and loads on their coordinates, many of them functions of time.
`effects`: effects of specs beside fewer of these, and ropes and springs between their points. `space`: the same on
hinges, sliders, universal and spherical joints. `loops`: a rod on two to four cranks of equal length, of which two
would do, with motors that contradict each other beside brakes; pins and joints break. `discs`: one to four of them
fall, roll and slip on a slope and on each other, with rods, ropes and springs between them."""
import math
import random

KINDS = ("rods", "effects", "space", "loops", "discs")
DURATION = 1.5


def wave(draw, size, unit, about=0.0):
    shape = f"{size:.3g} [{unit}] * {draw.choice(['sin', 'cos'])}({draw.choice([1, 2, 3, 5, 7])}*time / 1 [s])"
    return f'"{about:.3g} [{unit}] + {shape}"' if about else f'"{shape}"'


def some(draw, size, unit):
    return wave(draw, size, unit) if draw.random() < 0.4 else f"{draw.uniform(-size, size):.3g}"


def usual_effects(draw, coordinate, share=1.0):
    """Lines of the scene, each with a chance of its own. A coordinate that is an angle has radians, a slide metres."""
    unit, force = ("rad", "N*m") if coordinate == "angle" else ("m", "N")
    lines = []
    if draw.random() < 0.6 * share:
        steady = f"{draw.uniform(-3, 3):.3g}"
        speed = draw.choice([steady, wave(draw, draw.uniform(0.5, 3), unit + "/s")])
        most = draw.choice(["", f", max = {draw.choice([1, 3, 10, 30])}"])
        lines.append(f"motor = {{ speed = {speed}{most} }}")
    if draw.random() < 0.7 * share:
        lower, upper = draw.uniform(-0.6, -0.1), draw.uniform(0.1, 0.6)
        moves = draw.random() < 0.25
        end = wave(draw, 0.15, unit, upper + 0.2) if moves else f"{upper:.3g}"
        lines.append(f"limit = {{ lower = {lower:.3g}, upper = {end} }}")
    if draw.random() < 0.35 * share:
        lines.append(f"friction = {draw.choice([0.2, 1, 4])}")
    if draw.random() < 0.25 * share:
        lines.append(f"spring = {{ stiffness = {draw.choice([5, 50, 500])}, damping = {draw.choice([0, 0.5, 5])} }}")
    if draw.random() < 0.2 * share:
        lines.append(f"damper = {draw.choice([0.3, 3])}")
    if draw.random() < 0.2 * share:
        lines.append(f"load = {wave(draw, draw.uniform(1, 8), force)}")
    draw.shuffle(lines)
    return [f"{coordinate}.{line}" for line in lines]


def effects_of_specs(draw, coordinate):
    """Up to three of them."""
    def of(*numbers):
        return draw.choice(numbers)

    def drive():
        return f"k = {of(5, 50, 500)}, d = {of(0, 1, 10)}, most = {of(3, 30)}, target = {some(draw, 1, 'rad')}"

    on_angles = [
        lambda: f"servo = {{ {drive()} }}",
        lambda: f"position_drive = {{ {drive()} }}",
        lambda: f"spindle = {{ speed = {draw.uniform(-3, 3):.3g}, ramp = {of(0.1, 0.5)}, most = {of(1, 5, 30)} }}",
        lambda: f"dc_motor = {{ stall = {draw.uniform(0.5, 5):.3g}, idle = {of(2, 8)} }}",
        lambda: f"brake = {{ torque = {of(0.3, 1, 4)} }}",
        lambda: f"air_brake = {{ torque = {of(0.5, 2, 8)}, rise = {of(0.1, 0.5)} }}",
        lambda: of("freewheel = {}", f"freewheel = {{ most = {of(1, 5, 30)} }}"),
        lambda: f"ratchet = {{ count = {of(6, 12)}, most = {of(2, 10, 30)} }}",
        lambda: f"backlash = {{ play = {of(0.1, 0.5)} }}",
        lambda: f"detent = {{ count = {of(4, 8)}, most = {of(1, 5)}, d = {of(0, 0.3)} }}",
        lambda: f"bearing_friction = {{ most = {of(0.5, 2)}, creep = {of(0.05, 0.5)} }}",
        lambda: f"pin_friction = {{ mu = {of(0.1, 0.4)}, radius = {of(0.02, 0.1)} }}"]
    on_slides = [lambda: f"rail_friction = {{ mu = {of(0.1, 0.4)} }}"]
    on_all = [
        lambda: f"latch = {{ at = {draw.uniform(0.1, 0.5):.3g} }}",
        lambda: f"timed_motor = {{ speed = {draw.uniform(-2, 2):.3g}, max = {of(2, 10, 50)}, start = {of(0, 0.2)}, "
                f"stop = {of(0.7, 1.1)} }}",
        lambda: f"limit_switch = {{ speed = {draw.uniform(0.3, 2):.3g}, max = {of(5, 30)}, end = "
                f"{draw.uniform(0.1, 0.6):.3g} }}"]
    choices = (on_angles if coordinate == "angle" else on_slides) + on_all
    return [f"{coordinate}.{effect()}" for effect in draw.sample(choices, draw.choice([0, 1, 1, 2, 3]))]


def between_points(draw, rods, further):
    """Ropes and springs between points of a rod and of an earlier one or the world; `further`: a third coordinate."""
    lines = []
    for _ in range(draw.choice([0, 1, 1, 2])):
        b = draw.randrange(rods)
        a = draw.choice(["world"] + [f"rod{k}" for k in range(b)])
        high = f"{draw.uniform(-1, 2):.3g}, {draw.uniform(0.5, 1.5):.3g}"
        pa = high if a == "world" else draw.choice(["0.4, 0", "0.1, 0", "-0.3, 0"])
        pb = draw.choice(["0.5, 0", "0.25, 0", "-0.2, 0"])
        ends = [f'bodies = ["{a}", "rod{b}"]', f"pa = [{pa}{further}]", f"pb = [{pb}{further}]"]
        kind = draw.choice(["rope", "rope", "hauled", "bungee", "gas_spring", "spring", "push"])
        if kind == "rope":
            lines += ["[[joint]]", 'type = "max_distance"', *ends]
        elif kind == "hauled":
            long, speed = draw.uniform(2.5, 3.5), draw.choice([0.2, 0.5])
            lines += ["[[joint]]", 'type = "tearing_rope"', *ends, "strength = 1e6",
                      f'l = "{long:.3g} [m] - {speed} [m/s] * time"']
        elif kind == "bungee":
            lines += ["[[joint]]", 'type = "bungee"', *ends, f"k = {draw.choice([20, 200, 2000])}"]
        elif kind == "gas_spring":
            lines += ["[[joint]]", 'type = "gas_spring"', *ends, f"F = {draw.choice([5, 30])}"]
        elif kind == "spring":
            lines += ["[[spring]]", *ends, f"stiffness = {draw.choice([20, 200, 2000])}",
                      f"damping = {draw.choice([0, 1, 20])}"]
        else:
            force = f"{some(draw, 8, 'N')}, {some(draw, 8, 'N')}{further}"
            lines += ["[[joint]]", 'type = "push"', f'bodies = ["rod{b}"]', f"pa = [{pb}{further}]", f"F = [{force}]"]
    return lines


def joint_of(draw, kind, slides):
    """Its type, further lines and coordinates with effects."""
    if kind != "space":
        return ("prismatic", [], ["slide"]) if slides else ("revolute", [], ["angle"])
    name = "slider" if slides else draw.choice(["hinge", "hinge", "hinge", "universal", "spherical", "cylindrical"])
    axis = draw.choice(["0, 0, 1", "0, 0, 1", "0, 1, 0", "0, 0.6, 0.8", "1, 0, 0"])
    frame = [] if name == "spherical" else [f"fa = {{ world = [{axis}] }}"]
    return name, frame, {"hinge": ["angle"], "slider": ["slide"], "cylindrical": ["slide"]}.get(name, [])


def effects_in_loops(draw):
    """Of a joint, each with a chance of its own."""
    lines = []
    if draw.random() < 0.4:
        lines.append(f"breaking = {draw.choice([5, 10, 20, 40])}")
    if draw.random() < 0.5:
        lines.append(f"angle.motor = {{ speed = {draw.choice([-2, -1, 1, 1, 2])}, max = {draw.choice([1, 3, 10, 30])} }}")
    if draw.random() < 0.3:
        lines.append(f"angle.friction = {draw.choice([0.5, 2, 5])}")
    if draw.random() < 0.2:
        lines.append(f"angle.brake = {{ torque = {draw.choice([1, 4, 10])} }}")
    if draw.random() < 0.25:
        lines.append(f"angle.shear_pin = {{ strength = {draw.choice([3, 6, 12, 20])} }}")
    if draw.random() < 0.2:
        lines.append(f"angle.spring = {{ stiffness = {draw.choice([5, 50])}, damping = {draw.choice([0, 1])} }}")
    return lines


def loop(draw, seed):
    cranks, lean = draw.choice([2, 3, 3, 4]), draw.choice([0, 0, 0.4, 0.6])
    high = math.sqrt(1 - lean * lean)
    lines = [f'title = "agree {seed}"', f"gravity = [0, {draw.choice([0, -9.81, -9.81])}]", f"duration = {DURATION}"]
    for k in range(cranks):
        lines += ["[[body]]", f'name = "crank{k}"', f"mass = {draw.choice([0.5, 1, 2])}", "shape = { rod = 1 }",
                  f"position = [{k + lean / 2}, {high / 2}]", f"angle = {math.atan2(high, lean)}"]
    lines += ["[[body]]", 'name = "coupler"', f"mass = {draw.choice([1, 3, 5])}", f"shape = {{ rod = {cranks - 1} }}",
              f"position = [{(cranks - 1) / 2 + lean}, {high}]"]
    for k in range(cranks):
        for name, bodies, at in (("foot", f'["world", "crank{k}"]', f"[{k}, 0]"),
                                 ("head", f'["crank{k}", "coupler"]', f"[{k + lean}, {high}]")):
            lines += ["[[joint]]", f'name = "{name}{k}"', 'type = "revolute"', f"bodies = {bodies}", f"at = {at}",
                      *effects_in_loops(draw)]
    return "\n".join(lines) + "\n"


def between_discs(draw, radii, a, b, apart):
    """The contact of two discs, or if they are neighbours perhaps a rod, a rope or a spring."""
    bodies = [f'bodies = ["disc{a}", "disc{b}"]']
    points = ["pa = [0, 0]", "pb = [0, 0]"]
    kind = draw.choice(["none", "contact"] + (["contact", "rod", "rope", "spring"] if b == a + 1 else []))
    if kind == "contact":
        return ["[[joint]]", 'type = "disc_on_disc"', *bodies, f"radius_a = {radii[a]}", f"radius_b = {radii[b]}",
                f"mu = {draw.choice([0, 0.2, 0.5])}"]
    if kind == "rod":
        return ["[[joint]]", 'type = "distance"', *bodies, *points]
    if kind == "rope":
        return ["[[joint]]", 'type = "max_distance"', *bodies, *points, f"l = {apart + draw.choice([0.01, 0.2])!r}"]
    if kind == "spring":
        return ["[[spring]]", *bodies, *points, f"stiffness = {draw.choice([20, 200])}",
                f"damping = {draw.choice([0, 2])}"]
    return []


def discs(draw, seed):
    """On a slope through the origin, beside each other, some of them above it; all begin with the same velocity."""
    radii = [draw.choice([0.1, 0.2, 0.3]) for _ in range(draw.choice([1, 2, 2, 3, 3, 4]))]
    lean, speed = draw.choice([0, 0, 0.2, 0.5]) * draw.choice([1, -1]), draw.choice([0, 0, 1, -1, 2])
    along, up = (math.cos(lean), math.sin(lean)), (-math.sin(lean), math.cos(lean))
    lines = [f'title = "agree {seed}"', "gravity = [0, -9.81]", f"duration = {DURATION}"]
    places, way = [], 0
    for k, radius in enumerate(radii):
        way += radii[k - 1] + radius + draw.choice([1e-9, 0.05, 0.3]) if k else 0
        high = radius + draw.choice([0, 0, 0.01, 0.3])
        places.append([way * along[i] + high * up[i] for i in range(2)])
        lines += ["[[body]]", f'name = "disc{k}"', f"mass = {draw.choice([0.5, 1, 2, 5])}",
                  f"shape = {{ disc = {radius} }}", f"position = {places[k]}",
                  f"velocity = [{speed * along[0]}, {speed * along[1]}]", f"spin = {draw.choice([0, 0, 5, -5, 20])}",
                  "[[joint]]", 'type = "rough_line"', f'bodies = ["disc{k}", "world"]', "pa = [0, 0]", "pb = [0, 0]",
                  f"n = {list(up)}", f"radius = {radius}", f"mu = {draw.choice([0, 0.1, 0.3, 0.8])}"]
    for b in range(len(radii)):
        for a in range(b):
            lines += between_discs(draw, radii, a, b, math.dist(places[a], places[b]))
    return "\n".join(lines) + "\n"


def scene(kind, seed):
    draw = random.Random(seed if kind == "rods" else f"{kind} {seed}")
    if kind == "loops":
        return loop(draw, seed)
    if kind == "discs":
        return discs(draw, seed)
    further = ", 0" if kind == "space" else ""
    lines = [f'title = "agree {seed}"', f"gravity = [0, {draw.choice([0, -9.81, -9.81])}{further}]",
             f"duration = {DURATION}", *(["dimension = 3"] if kind == "space" else [])]
    shape = "{ box = [1, 0.3, 0.4] }" if kind == "space" else "{ rod = 1 }"
    rods = draw.choice([1, 1, 2, 2, 3])
    for k in range(rods):
        lines += ["[[body]]", f'name = "rod{k}"', f"mass = {draw.choice([0.5, 1, 2, 5])}", f"shape = {shape}",
                  f"position = [{k + 0.5}, 0{further}]"]
    for k in range(rods):
        slides = k == 0 and draw.random() < 0.2
        bodies = '["world", "rod0"]' if k == 0 else f'["rod{k - 1}", "rod{k}"]'
        name, frame, coordinates = joint_of(draw, kind, slides)
        lines += ["[[joint]]", f'name = "joint{k}"', f'type = "{name}"', f"bodies = {bodies}",
                  f"at = [{k}, 0{further}]", *frame]
        for coordinate in coordinates:
            if kind == "rods":
                lines += usual_effects(draw, coordinate)
            else:
                lines += effects_of_specs(draw, coordinate) + usual_effects(draw, coordinate, 0.5)
    if kind != "rods":
        lines += between_points(draw, rods, further)
    return "\n".join(lines) + "\n"
