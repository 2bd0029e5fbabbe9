"""Scenes of `vibro precision` in other programs: writes the lines that `vibro precision --add FILE` takes.

    python benches/peers/peers.py peers.json
    vibro precision --family models --add peers.json --out precision

With --quick the scene of 100 s is left out. Runs what is installed of SciPy (solve_ivp), SUNDIALS (scikits.odes, CVODE) and heyoka; each line names the version.
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


SCENES = [
    Scene("scene B, 2 s", 0.5, 2.1, 1e-3, [0.0] * 4, 2.0),
    Scene("scene B, 100 s", 0.5, 2.1, 1e-3, [0.0] * 4, 100.0),
    Scene("scene C", 0.35, 0.45, -5e-4, [-2e-3, 0.0, 0.0, 0.0], 0.6),
]
MOST = 2000  # impacts before a motion counts as stalled


class Stalled(Exception):
    pass


def judge(scene, impacts):
    """Error in s, and why there is none."""
    if scene.name == "scene C":
        return None, "it has no rule for masses that come to rest against each other"
    golden = [g for g in GOLDEN if g[1] < scene.until]
    last = golden[-1][1] + math.pi / scene.omega
    count = sum(t < last for t in impacts)
    if count != golden[-1][0]:
        return None, f"{count} impacts up to {last:.2f} s instead of {golden[-1][0]}"
    return max(max(abs(impacts[n - 1] - t) for n, t in golden), 1.1e-16 * scene.until), None


def scipy_impacts(scene, method, rtol):
    from scipy.integrate import solve_ivp

    def event(t, y):
        return scene.gap_of(y)

    event.terminal, event.direction = True, -1
    t, y, impacts = 0.0, scene.start, []
    while t < scene.until:
        found = solve_ivp(
            scene.rate, (t, scene.until), y, method=method, rtol=rtol, atol=[1e-3 * rtol, 0.05 * rtol] * 2, events=event
        )
        t, y = found.t[-1], list(found.y[:, -1])
        if found.status == 1:
            impacts.append(t)
            y = scene.collide(y)
            if len(impacts) > MOST:
                raise Stalled(f"{MOST} impacts at {t:.6f} s of {scene.until} s")
        elif found.status < 0:
            raise Stalled(found.message)
    return impacts


def sundials_impacts(scene, rtol):
    import numpy as np
    from scikits.odes.sundials import cvode

    def rate(t, y, out):
        out[:] = scene.rate(t, y)

    def root(t, y, out):
        out[0] = scene.gap_of(y)

    t, y, impacts = 0.0, np.array(scene.start), []
    while t < scene.until:
        solver = cvode.CVODE(
            rate, rtol=rtol, atol=1e-3 * rtol, old_api=False, rootfn=root, nr_rootfns=1, max_steps=100000
        )
        found = solver.solve([t, scene.until], y)
        if len(found.roots.t) == 0:
            break
        t, y = float(found.roots.t[-1]), np.array(found.roots.y[-1])
        if y[1] > y[3]:
            impacts.append(t)
            y = np.array(scene.collide(list(y)))
        if len(impacts) > MOST:
            raise Stalled(f"{MOST} impacts at {t:.6f} s of {scene.until} s")
    return impacts


def heyoka_impacts(scene, tol):
    import heyoka as hy

    x1, v1, x2, v2 = hy.make_vars("x1", "v1", "x2", "v2")
    drive = scene.force * hy.sin(scene.omega * hy.time)
    system = [
        (x1, v1),
        (v1, (drive - C1 * v1 - K1 * x1) / M1),
        (x2, v2),
        (v2, (-C2 * v2 - K2 * x2) / M2),
    ]
    impacts = []

    def hit(ta, sign):
        impacts.append(ta.time)
        ta.state[:] = scene.collide(list(ta.state))
        return len(impacts) < MOST

    event = hy.t_event(scene.gap + x2 - x1, callback=hit, direction=hy.event_direction.negative)
    ta = hy.taylor_adaptive(system, list(scene.start), t_events=[event], tol=tol)
    ta.propagate_until(scene.until)
    if len(impacts) >= MOST:
        raise Stalled(f"{MOST} impacts at {ta.time:.6f} s of {scene.until} s")
    return impacts


def measured(scene, method, setting, run, seconds=2.0):
    times, why, error = [], None, None
    try:
        while not times or (sum(times) < seconds and len(times) < 5):
            begun = time.perf_counter()
            impacts = run()
            times.append(time.perf_counter() - begun)
        error, why = judge(scene, impacts)
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
    peers = [
        ("scipy", "RK45", [1e-3, 1e-6, 1e-9], lambda r: (lambda s: scipy_impacts(s, "RK45", r))),
        ("scipy", "DOP853", [1e-6, 1e-9, 1e-12], lambda r: (lambda s: scipy_impacts(s, "DOP853", r))),
        ("scipy", "LSODA", [1e-6, 1e-9], lambda r: (lambda s: scipy_impacts(s, "LSODA", r))),
        ("scikits.odes", "CVODE", [1e-6, 1e-9], lambda r: (lambda s: sundials_impacts(s, r))),
        ("heyoka", "Taylor", [1e-9, 1e-15], lambda r: (lambda s: heyoka_impacts(s, r))),
    ]
    lines = []
    for package, method, tolerances, make in peers:
        try:
            name = f"{package} {version(package)} {method}"
        except PackageNotFoundError:
            print(f"{package} is not installed", file=sys.stderr)
            continue
        for scene in SCENES:
            if quick and scene.until > 10:
                continue
            # A hundred seconds of motion take some of these programs a minute.
            for r in tolerances[: 2 if scene.until > 10 else None]:
                run = make(r)
                lines.append(measured(scene, name, f"tolerance {r:.0e}", lambda: run(scene)))
    with open(out, "w") as file:
        json.dump(lines, file, indent=1)


if __name__ == "__main__":
    main()
