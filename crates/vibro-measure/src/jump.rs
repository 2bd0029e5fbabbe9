//! Jumps of a response curve.

use num_complex::Complex64;
use serde::Serialize;
use vibro_record::{Direction, uncertain};

/// A sudden change of amplitude from one step of a sweep to the next.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Jump {
    /// Last excitation frequency before, in Hz.
    pub from: f64,
    /// First excitation frequency after, in Hz.
    pub to: f64,
    /// Frequency of the jump in Hz: the middle of the two.
    pub frequency: f64,
    /// Its standard uncertainty in Hz: a uniform distribution between the two, their distance over √12.
    pub frequency_std: f64,
    /// Amplitude before, in the unit of the curve.
    pub amplitude_before: f64,
    /// Its standard uncertainty.
    pub amplitude_before_std: Option<f64>,
    /// Amplitude after, in the unit of the curve.
    pub amplitude_after: f64,
    /// Its standard uncertainty.
    pub amplitude_after_std: Option<f64>,
    /// `rise` or `drop`.
    pub change: &'static str,
    /// Direction of the sweep.
    pub direction: Direction,
}

// Its frequency lies between two steps, whatever their amplitudes.
uncertain!(Jump: ; scaled: amplitude_before_std, amplitude_after_std);

/// Least factor by which a jump changes the amplitude.
const JUMP: f64 = 1.5;
/// Least ratio of a jump's change, as a logarithm, to that of the steps beside it over the same width.
const JUMP_AGAINST_NEIGHBOURS: f64 = 2.5;

/// A standard uncertainty; `None` where it is not finite.
pub(super) fn known(std: f64) -> Option<f64> {
    Some(std).filter(|s| s.is_finite())
}

/// Differences below this many standard deviations are noise.
pub(super) const SIGMA: f64 = 4.0;

/// A point of a response curve: excitation frequency in Hz, amplitude, and its standard uncertainty.
pub type Point = (f64, f64, f64);

/// Whether two amplitudes differ by more than noise. Unknown uncertainties count as 0.
pub(super) fn differ(a: &Point, b: &Point) -> bool {
    let noise = [a.2, b.2].map(|s| if s.is_finite() { s } else { 0.0 });
    (a.1 - b.1).abs() > SIGMA * noise[0].hypot(noise[1])
}

/// Least change of the phase in rad across a jump that the amplitude alone does not distinguish from the
/// flank of a resonance.
const TURN: f64 = 1.0;

/// Jumps between neighbouring steps, in the order in which the sweep was run. `receptances` are those of the
/// points; empty where they are unknown.
pub(crate) fn jumps(curve: &[Point], receptances: &[Complex64], direction: Direction) -> Vec<Jump> {
    let step = |i: usize| (curve[i + 1].1 / curve[i].1).ln();
    let width = |i: usize| (curve[i + 1].0 - curve[i].0).abs();
    let steps = curve.len().saturating_sub(1);
    // Compares a change with the steepest of two steps on each side, scaled to the same width. Without steps
    // on both sides, or beside a sharp peak, a jump cannot be distinguished from a flank.
    let stands_out = |i: usize, sides: usize, change: &dyn Fn(usize) -> f64| {
        let around = [i.saturating_sub(2)..i, i + 1..(i + 3).min(steps)].into_iter();
        let mut known = around.filter(|side| sides == 2 || side.len() == 2).peekable();
        known.peek().is_some()
            && known.all(|side| {
                let apart = side.filter(|k| width(*k) > 1e-5 * curve[*k].0);
                let usual = apart.map(|k| change(k) * width(i) / width(k)).fold(f64::NAN, f64::max);
                change(i) > JUMP_AGAINST_NEIGHBOURS * usual
            })
    };
    // Near a resonance of a linear system the inverse receptance is a straight line over f², near an
    // antiresonance the receptance itself is. One of the two is smooth, so steps on one side are enough.
    let noise = |i: usize| {
        let of = |k: usize| known(curve[k].2).unwrap_or(0.0) / curve[k].1 * receptances[k].norm();
        of(i).hypot(of(i + 1))
    };
    let turns = |i: usize| {
        receptances.len() == curve.len()
            && (receptances[i + 1] / receptances[i]).arg().abs() > TURN
            && (receptances[i + 1] - receptances[i]).norm() > SIGMA * noise(i)
            && stands_out(i, 1, &|k| (receptances[k + 1] - receptances[k]).norm())
            && stands_out(i, 1, &|k| (receptances[k + 1].inv() - receptances[k].inv()).norm())
    };
    let is_jump = |i: &usize| {
        let leaps = step(*i).abs() > JUMP.ln() && stands_out(*i, 2, &|k| step(k).abs());
        step(*i).is_finite() && (leaps && differ(&curve[*i], &curve[i + 1]) || turns(*i))
    };
    (0..steps).filter(is_jump).map(|i| jump([curve[i], curve[i + 1]], direction)).collect()
}

impl Jump {
    /// Frequencies before and after it in Hz, the lower first.
    pub(super) fn span(&self) -> (f64, f64) {
        (self.from.min(self.to), self.from.max(self.to))
    }
}

/// The jump between two neighbouring steps.
pub(super) fn jump([before, after]: [Point; 2], direction: Direction) -> Jump {
    Jump {
        from: before.0,
        to: after.0,
        frequency: f64::midpoint(before.0, after.0),
        frequency_std: (after.0 - before.0).abs() / f64::sqrt(12.0),
        amplitude_before: before.1,
        amplitude_before_std: known(before.2),
        amplitude_after: after.1,
        amplitude_after_std: known(after.2),
        change: if after.1 > before.1 { "rise" } else { "drop" },
        direction,
    }
}

/// Least deviation of a change from the extrapolated curve, in standard deviations, that is a jump where the
/// other mass jumps.
const SIGMA_OF_BOTH: f64 = 5.0;

/// Jump of a curve, its frequencies rising, where the other mass of the same sweep jumps: the change across
/// it deviates from the extrapolation of the steps on both sides. `None` where it does not, or where a side
/// has no step.
pub(super) fn echo(curve: &[Point], other: &Jump) -> Option<Jump> {
    let high = curve.partition_point(|p| p.0 < other.frequency);
    let [a, b, c, d]: [_; 4] = curve.get(high.checked_sub(2)?..=high + 1)?.try_into().ok()?;
    // Change from `near` to `across` less what the step from `far` to `near` predicts, if it is beyond noise.
    let excess = |far: Point, near: Point, across: Point| {
        let stretch = (across.0 - near.0) / (near.0 - far.0);
        let excess = across.1 - near.1 - stretch * (near.1 - far.1);
        let std = across.2.hypot((1.0 + stretch) * near.2).hypot(stretch * far.2);
        (excess.abs() > SIGMA_OF_BOTH * std).then_some(excess)
    };
    // At a jump, the excesses from the two sides have opposite signs.
    let outside = excess(a, b, c)? * excess(d, c, b)? < 0.0;
    let (before, after) = if other.direction == Direction::Up { (b, c) } else { (c, b) };
    outside.then(|| jump([before, after], other.direction))
}
