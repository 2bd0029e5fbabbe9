"""Scenes of `vibro precision` in other programs: writes the lines that `vibro precision --add FILE` takes.

    benches/peers/precision.sh precision

installs the other programs, measures them and vibro in one run, and draws both. This file alone:

    python -m venv peers && peers/bin/pip install -r benches/peers/requirements.txt
    peers/bin/python benches/peers/peers.py peers.json

With --quick the scene of 100 s is left out. Runs what is installed of SciPy (solve_ivp), SUNDIALS (CVODE, by scikit-sundae) and heyoka; each line names the version.
Errors on scene B are those of the five impacts that are known to 40 digits.

In scene C every program has the same rule for rest, that of the Runge-Kutta lines of `vibro precision`: where the masses meet more slowly than the tolerance resolves and their
springs press them together, they move on as one until the force between them is gone.
"""

import json
import math
import sys
import time
from importlib.metadata import PackageNotFoundError, version
from statistics import median

M1, M2, K1, K2, C1, C2 = 0.125, 0.094, 135.0, 128.0, 0.1, 0.1
R = 0.7
EXCHANGE = M1 * M2 / (M1 + M2) * (1 + R)

# Number and time in s of impacts, by arithmetic with 40 digits.
GOLDEN = [
    (1, 0.03074428224667634),
    (2, 0.1441627764719474),
    (3, 0.23727047578315957),
    (22, 1.970065574977416),
    (1098, 99.93250053753815),
]
# End of the chatter, release, end of the second chatter.
CHATTER = [0.15272108935336045, 0.22024741826566051, 0.5745213738160907]


class Scene:
    def __init__(self, name, force, nu, gap, start, until):
        self.name, self.force, self.gap, self.start, self.until = name, force, gap, start, until
        self.omega = nu * math.sqrt(K1 / M1)

    def rate(self, t, y):
        drive = self.force * math.sin(self.omega * t)
        return [y[1], (drive - C1 * y[1] - K1 * y[0]) / M1, y[3], (-C2 * y[3] - K2 * y[2]) / M2]

    def gap_of(self, y):
        return self.gap + y[2] - y[0]

    def collide(self, y):
        impulse = EXCHANGE * (y[1] - y[3])
        return [y[0], y[1] - impulse / M1, y[2], y[3] + impulse / M2]

    def hold(self, t, y):
        """Force that keeps the masses together."""
        rate = self.rate(t, y)
        return M1 * M2 / (M1 + M2) * (rate[1] - rate[3])

    def together(self, t, y):
        rate, hold = self.rate(t, y), self.hold(t, y)
        return [rate[0], rate[1] - hold / M1, rate[2], rate[3] + hold / M2]

    def merged(self, y):
        v = (M1 * y[1] + M2 * y[3]) / (M1 + M2)
        return [y[0], v, y[0] - self.gap, v]

    def slowest(self, tolerance):
        """Approach speed below which masses that press each other rest: a bounce as high as the tolerance of 1 mm, or as rounding."""
        return max(math.sqrt(0.02 * tolerance), 1e-7)

    def first(self, t, y):
        """A tenth of a short flight: one within the first step, from a gap of zero to one below zero, is not seen by a sign test."""
        pressed, w = self.hold(t, y) * (M1 + M2) / (M1 * M2), y[3] - y[1]
        if self.gap_of(y) > 1e-12 or pressed <= 0 or w <= 0:
            return None
        return min(0.2 * w / pressed, self.until - t)

    def released(self, t, y):
        """A ten-thousandth of a cycle behind the release, until the gap, which opens like the cube of time, is more than rounding: one
        step of Runge and Kutta's fourth order."""
        h = 1e-4 * 2 * math.pi / self.omega
        y = [y[2] + self.gap, y[1], y[2], y[3]]
        to = lambda k, h: [a + h * b for a, b in zip(y, k)]
        a = self.rate(t, y)
        b = self.rate(t + h / 2, to(a, h / 2))
        c = self.rate(t + h / 2, to(b, h / 2))
        d = self.rate(t + h, to(c, h))
        return t + h, [y[i] + h / 6 * (a[i] + 2 * (b[i] + c[i]) + d[i]) for i in range(4)]


class Followed:
    """Impacts and rests of a motion, and what follows from each."""

    def __init__(self, scene, tolerance):
        self.scene, self.slowest = scene, scene.slowest(tolerance)
        self.impacts, self.rests, self.resting = [], [], False

    def meet(self, t, y):
        """The state behind an impact, or at rest."""
        if len(self.impacts) >= MOST:
            raise Stalled(f"{MOST} impacts at {t:.6f} s of {self.scene.until} s")
        approach = y[1] - y[3]
        self.impacts.append(t)
        y = self.scene.collide(y)
        if approach < self.slowest and self.scene.hold(t, y) > 0:
            self.rests.append([t, math.inf])
            self.resting = True
            return self.scene.merged(y)
        return y

    def release(self, t, y):
        self.rests[-1][1] = t
        self.resting = False
        return self.scene.released(t, y)


SCENES = [
    Scene("scene B, 2 s", 0.5, 2.1, 1e-3, [0.0] * 4, 2.0),
    Scene("scene B, 100 s", 0.5, 2.1, 1e-3, [0.0] * 4, 100.0),
    Scene("scene C", 0.35, 0.45, -5e-4, [-2e-3, 0.0, 0.0, 0.0], 0.6),
]
MOST = 2000  # impacts before a motion counts as stalled


class Stalled(Exception):
    pass


def judge(scene, found):
    """Error in s, and why there is none."""
    impacts = found.impacts
    if scene.name == "scene C":
        if len(found.rests) < 2:
            return None, f"{len(impacts)} impacts, and {len(found.rests)} times at rest against each other instead of 2"
        told = [found.rests[0][0], found.rests[0][1], found.rests[1][0]]
        return max(max(abs(t - g) for t, g in zip(told, CHATTER)), 1e-17), None
    golden = [g for g in GOLDEN if g[1] < scene.until]
    last = golden[-1][1] + math.pi / scene.omega
    count = sum(t < last for t in impacts)
    if count != golden[-1][0]:
        return None, f"{count} impacts up to {last:.2f} s instead of {golden[-1][0]}"
    return max(max(abs(impacts[n - 1] - t) for n, t in golden), 2.0**-53 * scene.until), None


def scipy_motion(scene, method, rtol):
    from scipy.integrate import solve_ivp

    def gap(t, y):
        return scene.gap_of(y)

    gap.terminal, gap.direction = True, -1

    def hold(t, y):
        return scene.hold(t, y)

    hold.terminal, hold.direction = True, -1
    t, y, told = 0.0, scene.start, Followed(scene, rtol)
    while t < scene.until:
        rate, event = (scene.together, hold) if told.resting else (scene.rate, gap)
        # The force at rest bends with the excitation: its sign is tested eight times a cycle at least.
        longest = 2 * math.pi / scene.omega / 8 if told.resting else math.inf
        found = solve_ivp(
            rate, (t, scene.until), y, method=method, rtol=rtol, atol=[1e-3 * rtol, 0.05 * rtol] * 2,
            events=event, max_step=longest, first_step=None if told.resting else scene.first(t, y),
        )
        t, y = found.t[-1], list(found.y[:, -1])
        if found.status == 1 and told.resting:
            t, y = told.release(t, y)
        elif found.status == 1:
            y = told.meet(t, y)
        elif found.status < 0:
            raise Stalled(found.message)
    return told


def sundials_motion(scene, rtol):
    import numpy as np
    from sksundae.cvode import CVODE

    def solver(rate, height, longest):
        def rhs(t, y, yp):
            yp[:] = rate(t, y)

        def root(t, y, out):
            out[0] = height(t, y)

        root.terminal, root.direction = [True], [-1]
        # The motion is not stiff: Adams' method, as SUNDIALS advises there.
        return CVODE(
            rhs, method="Adams", rtol=rtol, atol=np.array([1e-3 * rtol, 0.05 * rtol] * 2), eventsfn=root, num_events=1,
            max_num_steps=100_000, max_step=longest,
        )

    apart = solver(scene.rate, lambda t, y: scene.gap_of(y), 0)
    rest = solver(scene.together, scene.hold, 2 * math.pi / scene.omega / 8)
    t, y, told = 0.0, scene.start, Followed(scene, rtol)
    while t < scene.until:
        found = (rest if told.resting else apart).solve([t, scene.until], np.array(y))
        if not found.success:
            raise Stalled(found.message)
        t, y = float(found.t[-1]), [float(v) for v in found.y[-1]]
        if found.t_events is None or len(found.t_events) == 0:
            break
        if told.resting:
            t, y = told.release(t, y)
        elif y[1] > y[3]:
            y = told.meet(t, y)
    return told


def sundials_version():
    """Of the library that scikit-sundae brings."""
    try:
        from sksundae import SUNDIALS_VERSION
    except ImportError:
        return f"by scikit-sundae {version('scikit-sundae')}"
    return SUNDIALS_VERSION


def heyoka_integrators(scene, tol):
    """Integrators of both modes, compiled once: their time is that of a motion."""
    import heyoka as hy

    x1, v1, x2, v2 = hy.make_vars("x1", "v1", "x2", "v2")
    drive = scene.force * hy.sin(scene.omega * hy.time)
    a1, a2 = (drive - C1 * v1 - K1 * x1) / M1, (-C2 * v2 - K2 * x2) / M2
    hold = M1 * M2 / (M1 + M2) * (a1 - a2)

    def integrator(first, second, height):
        system = [(x1, v1), (v1, first), (x2, v2), (v2, second)]
        # Without a callback the integration stops at the event. What it leaves out behind one by itself, ten tolerances over the approach speed, is longer than
        # the last flights of a chatter.
        event = hy.t_event(height, direction=hy.event_direction.negative, cooldown=1e-9)
        return hy.taylor_adaptive(system, list(scene.start), t_events=[event], tol=tol)

    return integrator(a1, a2, scene.gap + x2 - x1), integrator(a1 - hold / M1, a2 + hold / M2, hold)


def heyoka_motion(scene, tol, integrators):
    import heyoka as hy

    apart, rest = integrators
    t, y, told = 0.0, scene.start, Followed(scene, tol)
    while t < scene.until:
        ta = rest if told.resting else apart
        if ta.time != t:
            ta.time = t
            ta.reset_cooldowns()
        ta.state[:] = y
        outcome = ta.propagate_until(scene.until)[0]
        t, y = float(ta.time), [float(v) for v in ta.state]
        if outcome == hy.taylor_outcome.time_limit:
            break
        if outcome in (hy.taylor_outcome.err_nf_state, hy.taylor_outcome.step_limit):
            raise Stalled(str(outcome))
        if told.resting:
            t, y = told.release(t, y)
        elif y[1] > y[3]:
            y = told.meet(t, y)
    return told


def measured(scene, method, setting, run, seconds=2.0):
    times, why, error = [], None, None
    try:
        while not times or (sum(times) < seconds and len(times) < 16):
            begun = time.perf_counter()
            found = run()
            times.append(time.perf_counter() - begun)
        # The first run warms the caches, as in `vibro precision`; it counts where it is the only one.
        times = times[1:] or times
        error, why = judge(scene, found)
    except Exception as fault:  # what another program raises is part of the answer
        times, why = times or [time.perf_counter() - begun], f"{type(fault).__name__}: {fault}"
    line = {
        "scene": scene.name, "method": method, "setting": setting,
        "error": error, "time_ns": 1e9 * median(times), "why": why,
    }
    print(scene.name, method, setting, error, f"{median(times):.3g} s", why or "", file=sys.stderr)
    return line


def main():
    quick = "--quick" in sys.argv
    files = [a for a in sys.argv[1:] if not a.startswith("--")]
    out = files[0] if files else "peers.json"
    def heyoka(s, r):
        integrators = heyoka_integrators(s, r)
        return lambda: heyoka_motion(s, r, integrators)

    peers = [
        ("SciPy", "scipy", "RK45", [1e-3, 1e-6, 1e-9], lambda s, r: lambda: scipy_motion(s, "RK45", r)),
        ("SciPy", "scipy", "DOP853", [1e-6, 1e-9, 1e-12], lambda s, r: lambda: scipy_motion(s, "DOP853", r)),
        ("SciPy", "scipy", "LSODA", [1e-6, 1e-9, 1e-12], lambda s, r: lambda: scipy_motion(s, "LSODA", r)),
        ("SUNDIALS", "scikit-sundae", "CVODE", [1e-6, 1e-9, 1e-12], lambda s, r: lambda: sundials_motion(s, r)),
        ("heyoka", "heyoka", "Taylor", [1e-9, 1e-15], heyoka),
    ]
    lines = []
    for program, package, method, tolerances, make in peers:
        try:
            name = f"{program} {sundials_version() if program == 'SUNDIALS' else version(package)} {method}"
        except PackageNotFoundError:
            print(f"{package} is not installed", file=sys.stderr)
            continue
        for scene in SCENES:
            if quick and scene.until > 10:
                continue
            for r in tolerances:
                lines.append(measured(scene, name, "tolerance " + f"{r:.0e}".replace("e-0", "e-"), make(scene, r)))
    with open(out, "w") as file:
        json.dump(lines, file, indent=1)


if __name__ == "__main__":
    main()
