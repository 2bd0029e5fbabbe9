//! Common to the figures of the closed form: the rig, the frequency ratio, and curves through orbits.

use vibroimpact::figure::{AxisSpec, Ink, Plot, Series, Stroke};
use vibroimpact::model::{Excitation, Impulses, Orbit, Rig, orbits, orbits_of};

/// The thesis' rig with this restitution.
pub fn rig(restitution: f64) -> Rig {
    Rig { restitution, ..Rig::thesis() }
}

/// Frequency in Hz of a frequency ratio ν = ω/Ω₁.
pub fn hertz(nu: f64) -> f64 {
    nu * Rig::thesis().natural_frequencies()[0]
}

/// Equidistant values, both ends included.
pub fn grid(from: f64, to: f64, n: usize) -> Vec<f64> {
    (0..n).map(|i| from + (to - from) * i as f64 / (n - 1) as f64).collect()
}

/// Orbits with one impact a cycle under a sine force (N).
pub fn under_sine(rig: &Rig, force: f64, nu: f64) -> Vec<Orbit> {
    orbits(rig, force, hertz(nu)).map_or_else(|_| Vec::new(), |found| found.orbits)
}

/// Orbits with one impact a cycle under impulses (N s).
pub fn under_impulses(rig: &Rig, impulse: f64, nu: f64) -> Vec<Orbit> {
    let train = Excitation::Impulse(Impulses { impulse, frequency: hertz(nu) });
    orbits_of(rig, &train, 1).map_or_else(|_| Vec::new(), |found| found.orbits)
}

/// The orbit that the energy rule of the thesis accepts: the root with an impulse J (N s) above 0.
pub fn accepted(orbits: &[Orbit]) -> Option<&Orbit> {
    orbits.iter().find(|o| o.validity.energy_rule)
}

/// Whether a motion can be observed: it exists, the masses do not pass through each other, and it is
/// stable.
pub fn real(orbit: &Orbit) -> bool {
    let v = &orbit.validity;
    v.exists && v.admissible && v.stable == Some(true)
}

/// Place and size of the largest value between `low` and `high`: the best of 2001 equidistant
/// values, then a ternary search around it.
pub fn peak(low: f64, high: f64, value: impl Fn(f64) -> Option<f64>) -> (f64, f64) {
    let value = |x: f64| value(x).unwrap_or(f64::NEG_INFINITY);
    let step = (high - low) / 2000.0;
    let all = (0..=2000).map(|i| low + step * f64::from(i));
    let best = all.max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap_or(low);
    let (mut a, mut b) = (best - step, best + step);
    for _ in 0..60 {
        let third = (b - a) / 3.0;
        if value(a + third) < value(b - third) { a += third } else { b -= third }
    }
    let at = f64::midpoint(a, b);
    (at, value(at))
}

/// The value between `low` and `high` at which `test` first differs from its result at `low`.
pub fn border(low: f64, high: f64, test: impl Fn(f64) -> bool) -> f64 {
    let at_low = test(low);
    vibroimpact::math::border(low, high, |x| test(x) == at_low)
}

/// The axis of ν.
pub fn ratio(from: f64, to: f64) -> AxisSpec {
    AxisSpec::new("Frequency ratio ν", "").limits(from, to)
}

/// Polylines joined from segments: a segment that starts at the end of a line extends it, any other begins
/// a new line.
#[derive(Default)]
struct Lines(Vec<Vec<(f64, f64)>>);

impl Lines {
    fn join(&mut self, from: (f64, f64), to: (f64, f64)) {
        match self.0.iter_mut().rev().find(|line| line.last() == Some(&from)) {
            Some(line) => line.push(to),
            None => self.0.push(vec![from, to]),
        }
    }
}

/// Adds a value of all orbits that exist (J > 0) over ν, each followed from one ν to the next. Orbits that
/// can be observed ([`real`]) are solid in the colour `nth`, the others thin and grey.
pub fn add_orbits(
    plot: Plot,
    name: &str,
    nth: usize,
    nu: &[f64],
    find: impl Fn(f64) -> Vec<Orbit>,
    value: impl Fn(&Orbit) -> f64,
) -> Plot {
    let found: Vec<Vec<Orbit>> = nu.iter().map(|nu| find(*nu)).collect();
    let mut lines = [Lines::default(), Lines::default()];
    for (nu, pair) in nu.windows(2).zip(found.windows(2)) {
        for orbit in pair[0].iter().filter(|o| o.validity.exists) {
            // The orbit must be continued in both directions, so that a vanishing orbit is not joined to
            // another.
            let same = |next: &&Orbit| next.validity.exists && next.continued(&pair[0]) == Some(orbit);
            if let Some(next) = orbit.continued(&pair[1]).filter(same) {
                lines[usize::from(real(next))].join((nu[0], value(orbit)), (nu[1], value(next)));
            }
        }
    }
    let [other, seen] = lines;
    let series = |name: &str, lines: Lines| {
        let (x, y): (Vec<f64>, Vec<f64>) = lines.0.join(&(f64::NAN, f64::NAN)).into_iter().unzip();
        Series::line(name, x, y)
    };
    plot.with(series("", other).ink(Ink::Grey).stroke(Stroke::Thin))
        .with(series(name, seen).ink(Ink::Nth(nth)).stroke(Stroke::Solid))
}
