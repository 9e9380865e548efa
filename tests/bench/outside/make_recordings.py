#!/usr/bin/env python3
"""Recording bundles of worlds that no code of Repose integrated, each with the name of what its scene lacks in a file `truth`.

    make_recordings.py FOLDER SEED
"""
import json
import math
import pathlib
import random
import sys

from worlds import G, ball_mass, ball_on_floor, block_on_floor, cross, flight, norm

POSITION, VELOCITY, SPIN = (f"bodies.body.{what}" for what in ("position", "velocity", "angular_velocity"))
QUADRATIC = 0.47
AIR = 1.2


def scene(shape, density, duration, pair=None, gravity=(0, 0, -G), floor="fixed: true"):
    """What the experimenter knew."""
    text = f"materials: {{thing: {{density: {density}}}, stone: {{density: 2500}}}}\n"
    if pair is not None:
        text += f"pairs:\n  stone-thing: {{{pair}}}\n"
    text += f"shapes:\n  body: {shape}\n  floor: {{type: half_space}}\nbodies:\n  body: {{shape: body, material: thing, position: [0, 0, 1]}}\n"
    if pair is not None:
        text += f"  floor: {{shape: floor, material: stone, {floor}}}\n"
    return text + f"gravity: {list(gravity)}\nsolver: {{time_step: 1.0e-3, tolerance: 1.0e-6}}\nduration: {duration}\n"


class Bundle:
    def __init__(self, folder, truth, seed, nominal, rate, duration, noise, declare=True, calibrate=()):
        self.folder, self.truth, self.nominal = pathlib.Path(folder), truth, nominal
        self.random, self.noise, self.declare, self.calibrate = random.Random(seed), noise, declare, calibrate
        self.times = [i / rate for i in range(round(duration * rate) + 1)]
        self.observable, self.runs = "position", []
        self.folder.mkdir(parents=True, exist_ok=True)

    def noisy(self, value):
        return f"{value + self.random.gauss(0, self.noise):.7g}"

    def write_csv(self, header, rows):
        name = f"run-{len(self.runs) + 1}.csv"
        (self.folder / name).write_text("\n".join([header, *rows]) + "\n")
        return name

    def trajectory(self, settings, free, path, turns=None, scale=1.0, tilt=0.0):
        """Positions times `scale`, in axes turned by `tilt` about y; with turns about z: orientations with 2 mrad of noise."""
        rows = []
        for i, (t, p) in enumerate(zip(self.times, path)):
            x, y, z = (scale * c for c in p)
            x, z = math.cos(tilt) * x + math.sin(tilt) * z, -math.sin(tilt) * x + math.cos(tilt) * z
            row = f"{t:.6f},body," + ",".join(map(self.noisy, (x, y, z)))
            if turns:
                half = [self.random.gauss(0, 1e-3) for _ in range(2)] + [turns[i] / 2 + self.random.gauss(0, 1e-3)]
                q = [math.cos(half[2]), half[0], half[1], math.sin(half[2])]
                row += "," + ",".join(f"{c / norm(q):.7g}" for c in q)
            rows.append(row)
        name = self.write_csv("time,body,x,y,z" + (",qw,qx,qy,qz" if turns else ""), rows)
        self.runs.append((settings, free, f"{{kind: trajectory, body: body, file: {name}}}"))

    def accelerometer(self, settings, values):
        name = self.write_csv("time,value", [f"{t:.6f},{self.noisy(v)}" for t, v in zip(self.times, values)])
        self.observable = "specific_force"
        self.runs.append((settings, [], f"{{kind: series, name: specific_force, body: body, axis: [1, 0, 0], unit: m/s^2, file: {name}}}"))

    def write(self):
        lines = [f"title: {self.folder.name}", "scene: nominal.yaml"]
        if self.calibrate:
            lines.append(f"calibrate: [{', '.join(self.calibrate)}]")
        if self.declare:
            lines.append(f"noise: {{{self.observable}: {self.noise:g}}}")
        lines.append("runs:")
        for i, (settings, free, observable) in enumerate(self.runs):
            lines.append(f"  - id: run-{i + 1}")
            lines.append("    set: {" + ", ".join(f"{key}: {json.dumps(value)}" for key, value in settings.items()) + "}")
            if free:
                lines.append(f"    free: [{', '.join(free)}]")
            lines += ["    observables:", f"      - {observable}"]
        (self.folder / "recording.yaml").write_text("\n".join(lines) + "\n")
        (self.folder / "nominal.yaml").write_text(self.nominal)
        (self.folder / "truth").write_text(self.truth + "\n")


def throws(folder, truth, seed, acceleration, radius=0.02, densities=(200,), spin=0.0, speed=(4, 10), clock=1.0, late=0.0, scale=1.0,
           known_start=False, declare=True):
    """Eight throws. acceleration(t, x, v, w, mass) beside gravity."""
    b = Bundle(folder, truth, seed, scene(f"{{type: sphere, radius: {radius}}}", densities[0], 0.8), 100, 0.8, 1e-3, declare)
    for i in range(8):
        density, azimuth = densities[i % len(densities)], b.random.uniform(0, 2 * math.pi)
        fast, rise = b.random.uniform(*speed), b.random.uniform(0.2, 1.2)
        v = [fast * math.cos(azimuth) * math.cos(rise), fast * math.sin(azimuth) * math.cos(rise), fast * math.sin(rise)]
        w = [spin * b.random.uniform(-1, 1) for _ in range(3)]
        x = [0, 0, 2 + b.random.uniform(0, 1)]
        mass = ball_mass(density, radius)

        def total(t, x, v):
            extra = acceleration(t, x, v, w, mass)
            return [extra[0], extra[1], extra[2] - G]

        path = flight(total, x, v, [max(0.0, (t - late) / clock) for t in b.times])
        settings = {POSITION: x, VELOCITY: v if known_start else [round(c, 2) for c in v]}
        if spin:
            settings[SPIN] = w
        if len(densities) > 1:
            settings["materials.thing.density"] = density
        b.trajectory(settings, [] if known_start else [VELOCITY], path, scale=scale)
    b.write()


def bounces(folder, truth, seed, pair, restitution, acceleration=None, declare=True, calibrate=()):
    radius = 0.02
    b = Bundle(folder, truth, seed, scene(f"{{type: sphere, radius: {radius}}}", 1100, 1.2, pair), 200, 1.2, 3e-4, declare, calibrate)
    mass = ball_mass(1100, radius)
    for _ in range(8):
        x = [b.random.uniform(-0.1, 0.1), 0, b.random.uniform(0.25, 0.9)]

        def total(t, x, v):
            extra = acceleration(t, x, v, [0, 0, 0], mass) if acceleration else [0, 0, 0]
            return [extra[0], extra[1], extra[2] - G]

        b.trajectory({POSITION: [round(c, 4) for c in x]}, [POSITION], flight(total, x, [0, 0, 0], b.times, radius, restitution))
    b.write()


def rolls(folder, truth, seed, pair, friction, rolling=0.0, spinning=0.0, slope=0.0, inertia=0.4, scale=1.0, slides=False, turning=0.0,
          known_start=False, declare=True):
    radius, gravity = 0.02, (G * math.sin(slope), 0, -G * math.cos(slope))
    b = Bundle(folder, truth, seed, scene(f"{{type: sphere, radius: {radius}}}", 1100, 0.6, pair, gravity), 100, 0.6, 3e-4, declare)
    for _ in range(8):
        fast, azimuth = b.random.uniform(0.4, 1.2), b.random.uniform(0, 2 * math.pi)
        v = [0, 0, 0] if turning else [fast * math.cos(azimuth), fast * math.sin(azimuth), 0]
        w = [0, 0, 0] if slides else [-v[1] / radius, v[0] / radius, turning * b.random.uniform(0.5, 1.5)]
        x = [b.random.uniform(-0.2, 0.2), b.random.uniform(-0.2, 0.2), radius]
        path, turns = ball_on_floor(x, v, w, radius, friction, rolling, spinning, b.times, gravity, inertia)
        digits = 12 if known_start else 3
        settings = {POSITION: x, VELOCITY: [round(c, digits) for c in v], SPIN: [round(c, digits) for c in w]}
        free = [] if known_start else [SPIN] if turning else [VELOCITY] if slides else [VELOCITY, SPIN]
        b.trajectory(settings, free, path, turns if turning else None, scale)
    b.write()


def along(coefficient):
    """Friction of a coefficient, which may depend on speed and place, along the slip."""
    def force(slip, x):
        speed = math.hypot(*slip)
        return [coefficient(speed, x) * s / speed for s in slip]
    return force


def across(first, second):
    """Friction of an ellipse of coefficients, of largest dissipation."""
    def force(slip, x):
        size = math.hypot(first * slip[0], second * slip[1])
        return [first**2 * slip[0] / size, second**2 * slip[1] / size]
    return force


def blocks(folder, truth, seed, pair, friction, slope=0.0, belt=0.0, belt_told=0.0, push=None, tilt=0.0, bias=None, speed=(0.6, 1.8), calibrate=()):
    gravity = (G * math.sin(slope), 0, -G * math.cos(slope))
    floor = f"motion: {{velocity: [{belt_told}, 0, 0]}}" if belt else "fixed: true"
    noise, rate = (3e-4, 100) if bias is None else (0.05, 200)
    nominal = scene("{type: box, size: [0.04, 0.04, 0.02]}", 1100, 0.6, pair, gravity, floor)
    b = Bundle(folder, truth, seed, nominal, rate, 0.6, noise, calibrate=calibrate)
    for _ in range(8):
        fast, azimuth = b.random.uniform(*speed), b.random.uniform(0, 2 * math.pi)
        v = [fast * math.cos(azimuth), fast * math.sin(azimuth)]
        if belt:
            v = [0.0, 0.0]
        elif slope:
            v = [abs(v[0]), 0.3 * v[1]]
        elif bias is not None:
            v = [fast, 0.0]
        x = [b.random.uniform(-0.2, 0.2), b.random.uniform(-0.2, 0.2)]
        path, felt = block_on_floor(x, v, 0.01, friction, b.times, gravity, belt, push)
        settings = {POSITION: x + [0.01], VELOCITY: [round(c, 3) for c in v] + [0]}
        if bias is None:
            b.trajectory(settings, [VELOCITY], path, tilt=tilt)
        else:
            settings[VELOCITY] = v + [0]
            felt[0] = felt[1]
            b.accelerometer(settings, [a + bias for a in felt])
    b.write()


def quadratic_drag(coefficient, radius=0.02):
    def acceleration(t, x, v, w, mass):
        k = 0.5 * AIR * coefficient * math.pi * radius**2 * norm(v) / mass
        return [-k * c for c in v]
    return acceleration


def all_bundles(folder, seed):
    def nothing(t, x, v, w, mass):
        return [0, 0, 0]

    volume, lift = ball_mass(1, 0.02), 0.4
    made = []

    def make(maker, name, truth, *rest, **more):
        made.append(name)
        maker(f"{folder}/{name}", truth, seed + len(made), *rest, **more)

    make(throws, "drag", "quadratic_drag", quadratic_drag(QUADRATIC), densities=(100, 300))
    make(throws, "magnus", "magnus", lambda t, x, v, w, m: [lift * AIR * volume / m * c for c in cross(w, v)], densities=(100,), spin=120)
    make(throws, "stokes", "linear_drag", lambda t, x, v, w, m: [-6 * math.pi * 0.05 * 0.004 / m * c for c in v], radius=0.004, densities=(2500,), speed=(1, 4))
    make(throws, "float", "buoyancy", lambda t, x, v, w, m: [0, 0, 60 * volume * G / m], densities=(200, 600, 1500))
    make(throws, "wind", "uniform_force", lambda t, x, v, w, m: [4e-3 / m, 1e-3 / m, 0], densities=(200, 600))
    make(throws, "plumb_line", "gravity_tilt|frame_tilt", lambda t, x, v, w, m: [0.25, 0, G - math.sqrt(G * G - 0.0625)])
    make(throws, "ruler", "length_scale", nothing, scale=1.02)
    make(throws, "clock", "time_scale", nothing, clock=1.02, known_start=True)
    make(throws, "late", "time_offset", nothing, late=-0.012, known_start=True)
    make(throws, "spring", "unknown", lambda t, x, v, w, m: [-3 * x[0], -3 * x[1], 0])
    make(throws, "gust", "unknown", lambda t, x, v, w, m: [3 * math.exp(-((t - 0.4) / 0.06) ** 2), 0, 0])
    make(throws, "throw", "none", nothing, declare=False)
    make(rolls, "roll", "rolling_friction", "friction: 0.5", 0.5, rolling=0.03)
    make(rolls, "slip", "friction", "restitution: 0", 0.15, slides=True)
    make(rolls, "top", "spinning_friction", "friction: 0.5", 0.5, spinning=0.02, turning=30)
    make(rolls, "hollow", "inertia", "friction: 0.6", 0.6, slope=0.15, inertia=0.6, known_start=True)
    make(rolls, "roll_on", "none", "friction: 0.5, rolling_friction: 0.02", 0.5, rolling=0.02, declare=False)
    make(rolls, "roll_and_ruler", "length_scale+rolling_friction", "friction: 0.5", 0.5, rolling=0.03, scale=1.03)
    make(blocks, "block", "friction", "restitution: 0", along(lambda speed, x: 0.2))
    make(blocks, "block_as_stated", "friction", "friction: 0.3", along(lambda speed, x: 0.2))
    make(blocks, "incline", "friction", "restitution: 0", along(lambda speed, x: 0.4), slope=0.3)
    make(blocks, "fast_grips", "rate_dependent_friction", "friction: 0.3", along(lambda speed, x: max(0, 0.3 + 0.05 * math.log(speed))),
         calibrate=("pairs.stone-thing.friction",))
    make(blocks, "grain_of_wood", "anisotropic_friction", "friction: 0.2", across(0.2, 0.32))
    make(blocks, "belt", "moving_wall_speed", "friction: 0.15", along(lambda speed, x: 0.15), belt=0.6, belt_told=0.5)
    make(blocks, "rough_patch", "unknown", "friction: 0.2", along(lambda speed, x: 0.45 if x[0] > 0.1 else 0.2), speed=(1, 2))
    make(blocks, "accelerometer", "sensor_bias", "friction: 0.3", along(lambda speed, x: 0.3), bias=0.15)
    make(blocks, "crooked", "frame_tilt", "friction: 0.3", along(lambda speed, x: 0.3), tilt=0.01)
    make(blocks, "shaken", "periodic_force", "friction: 0.2", along(lambda speed, x: 0.2), push=lambda t: [1.2 * math.sin(8 * math.pi * t + 0.5), 0],
         speed=(1.2, 2))
    make(bounces, "bounce", "restitution", "friction: 0.3", lambda u: 0.7)
    make(bounces, "bounce_as_stated", "restitution", "friction: 0.3, restitution: 0.8", lambda u: 0.7)
    make(bounces, "hard_and_soft", "rate_dependent_restitution", "friction: 0.3, restitution: 0.8", lambda u: min(1, 0.8 * (u / 2) ** -0.15),
         calibrate=("pairs.stone-thing.restitution",))
    make(bounces, "bounce_on", "none", "friction: 0.3, restitution: 0.75", lambda u: 0.75, declare=False)
    make(bounces, "thick_air", "quadratic_drag", "friction: 0.3, restitution: 0.75", lambda u: 0.75, quadratic_drag(5.0))


if __name__ == "__main__":
    if len(sys.argv) != 3 or not sys.argv[2].isdigit():
        sys.exit(__doc__)
    all_bundles(sys.argv[1], int(sys.argv[2]))
