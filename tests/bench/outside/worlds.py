"""Worlds of one body, integrated without any code of Repose: closed forms and Runge-Kutta, no contact solver. SI units."""
import math

G = 9.81


def norm(v):
    return math.sqrt(sum(a * a for a in v))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def ball_mass(density, radius):
    return density * 4 / 3 * math.pi * radius**3


def runge_kutta(slope, y, t, h):
    k1 = slope(t, y)
    k2 = slope(t + h / 2, [a + h / 2 * b for a, b in zip(y, k1)])
    k3 = slope(t + h / 2, [a + h / 2 * b for a, b in zip(y, k2)])
    k4 = slope(t + h, [a + h * b for a, b in zip(y, k3)])
    return [a + h / 6 * (b + 2 * c + 2 * d + e) for a, b, c, d, e in zip(y, k1, k2, k3, k4)]


def flight(acceleration, x, v, times, floor=None, restitution=None, step=1e-3):
    """Positions at `times`. acceleration(t, x, v). Above `floor` (height of the centre at touch) with restitution(approach speed); an impact
    is found by bisection, its time exact to 1e-15 of a step."""
    def slope(t, y):
        return y[3:] + acceleration(t, y[:3], y[3:])

    y, t, path = list(x) + list(v), 0.0, []
    for sample in times:
        while t < sample - 1e-12:
            h = min(step, sample - t)
            ahead = runge_kutta(slope, y, t, h)
            if floor is not None and ahead[2] < floor and ahead[5] < 0:
                low, high = 0.0, h
                for _ in range(50):
                    middle = (low + high) / 2
                    if runge_kutta(slope, y, t, middle)[2] < floor:
                        high = middle
                    else:
                        low = middle
                y = runge_kutta(slope, y, t, low)
                y[5] = -y[5] * restitution(-y[5])
                t += low
                continue
            y, t = ahead, t + h
        path.append(y[:3])
    return path


def ball_on_floor(x, v, w, radius, friction, rolling, spinning, times, gravity=(0, 0, -G), inertia=0.4, step=1e-4):
    """Positions of the centre and turns about z. Coulomb slip until the touching point stands still, then rolling; resisting moments of arms
    rolling * radius and spinning * radius; moment of inertia = inertia m R^2."""
    normal, path, turns = -gravity[2], [], []
    x, v, w, t, turn, sliding = list(x), list(v), list(w), 0.0, 0.0, True
    for sample in times:
        while t < sample - 1e-12:
            h = min(step, sample - t)
            slip = [v[0] - radius * w[1], v[1] + radius * w[0]]
            spin = math.hypot(w[0], w[1])
            moment = [-rolling * radius * normal * w[k] / spin if spin > 1e-9 else 0.0 for k in (0, 1)]
            if sliding and math.hypot(*slip) > 0:
                push = [-friction * normal * s / math.hypot(*slip) for s in slip]
            else:  # what keeps the touching point at rest
                push = [(-inertia * gravity[0] + moment[1] / radius) / (1 + inertia), (-inertia * gravity[1] - moment[0] / radius) / (1 + inertia)]
            v_next = [v[k] + h * (gravity[k] + push[k]) for k in (0, 1)]
            w_next = [w[0] + h * (radius * push[1] + moment[0]) / (inertia * radius**2),
                      w[1] + h * (-radius * push[0] + moment[1]) / (inertia * radius**2),
                      math.copysign(max(0.0, abs(w[2]) - h * spinning * normal / (inertia * radius)), w[2])]
            slip_next = [v_next[0] - radius * w_next[1], v_next[1] + radius * w_next[0]]
            if slip_next[0] * slip[0] + slip_next[1] * slip[1] <= 0:
                sliding = False
            level = gravity[0] == 0 and gravity[1] == 0
            if not sliding and level and v_next[0] * v[0] + v_next[1] * v[1] < 0:
                v_next, w_next = [0.0, 0.0], [0.0, 0.0, w_next[2]]
            x = [x[k] + h * (v[k] + v_next[k]) / 2 for k in (0, 1)] + [x[2]]
            turn += h * (w[2] + w_next[2]) / 2
            v, w, t = v_next, w_next, t + h
        path.append(list(x))
        turns.append(turn)
    return path, turns


def block_on_floor(x, v, height, friction_force, times, gravity=(0, 0, -G), belt=0.0, push=None, step=1e-4):
    """Positions of the centre at `height`, and accelerations along x without gravity. friction_force(slip, x): two components per weight,
    along the slip. The floor moves along x with `belt`; push(t): further acceleration, two components. What stops stays, but for a push."""
    path, felt, t = [], [], 0.0
    x, v, acceleration, stands = list(x), list(v), [0.0, 0.0], False
    for sample in times:
        while t < sample - 1e-12:
            h = min(step, sample - t)
            slip = [v[0] - belt, v[1]]
            drive = [a + b for a, b in zip(gravity, push(t))] if push else gravity
            if stands and not push:
                acceleration = [0.0, 0.0]
            else:
                friction = friction_force(slip, x) if math.hypot(*slip) > 1e-9 else [0.0, 0.0]
                acceleration = [d + gravity[2] * f for d, f in zip(drive, friction)]
            v_next = [a + h * b for a, b in zip(v, acceleration)]
            if not stands and (v_next[0] - belt) * slip[0] + v_next[1] * slip[1] <= 0:
                v_next, acceleration, stands = [belt, 0.0], [0.0, 0.0], True
            x = [a + h * (b + c) / 2 for a, b, c in zip(x, v, v_next)]
            v, t = v_next, t + h
        path.append([x[0], x[1], height])
        felt.append(acceleration[0] - gravity[0])
    return path, felt
