//! Places and labels of the ticks of an axis.

use vibro_record::units::notation::{engineering, fixed, power_of_ten};

/// A labelled tick at `at` in the axis' own scale (log₁₀ of the value on a logarithmic axis).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub at: f64,
    pub label: String,
}

/// Ticks of an axis in ascending order, none outside its limits.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Ticks {
    pub major: Vec<Tick>,
    pub minor: Vec<f64>,
}

/// A distance between major ticks, `mantissa`·10^`exponent`, divided into `parts` by minor ticks.
#[derive(Debug, Clone, Copy)]
struct TickStep {
    mantissa: i32,
    exponent: i32,
    parts: i32,
}

/// Steps of 1, 2 and 5 times a power of ten, each with its number of parts.
const DECIMAL: [(i32, i32); 3] = [(1, 5), (2, 4), (5, 5)];
/// Steps of angles in degrees, for axes of 20° to 3600°, each with its number of parts.
const DEGREES: [(i32, i32); 9] =
    [(5, 5), (10, 5), (15, 3), (30, 3), (45, 3), (90, 3), (180, 2), (360, 4), (720, 2)];

impl TickStep {
    /// The value of `count` steps. Division by a positive power of ten rounds once, so that 3·10⁻¹ is the
    /// double nearest to 0.3.
    fn times(self, count: f64) -> f64 {
        let whole = count * f64::from(self.mantissa);
        let power = 10f64.powi(self.exponent.abs());
        if self.exponent < 0 { whole / power } else { whole * power }
    }

    /// Multiples of the step from `lo` to `hi`, as counts. A multiple that a limit misses only by
    /// rounding is included.
    fn within(self, lo: f64, hi: f64) -> Vec<f64> {
        let first = (lo / self.times(1.0) - SLACK).ceil();
        let last = (hi / self.times(1.0) + SLACK).floor();
        let count = if last < first { 0 } else { (last - first) as usize + 1 };
        // With more ticks than these the step is too fine to be used.
        (0..count.min(200)).map(|i| first + i as f64).collect()
    }

    /// The step of the minor ticks.
    fn minor(self) -> TickStep {
        // Every division by `parts` is exact one decade lower: 10/5, 20/4, 50/5, 150/3, …
        TickStep { mantissa: self.mantissa * 10 / self.parts, exponent: self.exponent - 1, parts: 1 }
    }
}

/// Allowance for the rounding of a limit, in steps or decades.
const SLACK: f64 = 1e-9;

/// Ticks of a linear axis at multiples of 1, 2 or 5 times a power of ten (of 15°, 30°, 45°, … where
/// `degrees`): two to `most`. Where no step gives that, the next finer step has up to five. Labels are the
/// values divided by 10^`power`.
pub(super) fn linear(lo: f64, hi: f64, most: usize, power: i32, degrees: bool) -> Ticks {
    let span = hi - lo;
    if !(span > 0.0 && span.is_finite()) {
        return Ticks::default();
    }
    let most = most.clamp(2, 10);
    let steps = |exponent: i32, mantissas: &[(i32, i32)]| -> Vec<TickStep> {
        mantissas.iter().map(|&(mantissa, parts)| TickStep { mantissa, exponent, parts }).collect()
    };
    let decade = (span / most as f64).log10().floor() as i32;
    let candidates = if degrees && span > 20.0 && span < 3600.0 {
        steps(0, &DEGREES)
    } else {
        (decade - 1..=decade + 3).flat_map(|exponent| steps(exponent, &DECIMAL)).collect()
    };
    let count = |i: usize| candidates[i].within(lo, hi).len();
    let finest = (0..candidates.len()).find(|&i| count(i) <= most).unwrap_or(candidates.len() - 1);
    // The finest step with at most `most` ticks may leave a single tick. Then the next finer step is used,
    // which may exceed `most`.
    let step = candidates[if count(finest) < 2 { finest.saturating_sub(1) } else { finest }];
    let decimals = usize::try_from(power - step.exponent).unwrap_or(0);
    let shown = TickStep { exponent: step.exponent - power, ..step };
    let (major, minor_step) = (step.within(lo, hi), step.minor());
    let label = |k: f64| Tick { at: step.times(k).clamp(lo, hi), label: fixed(shown.times(k), decimals) };
    let between =
        minor_step.within(lo, hi).into_iter().filter(|k| k.rem_euclid(f64::from(step.parts)) != 0.0);
    Ticks {
        minor: between.map(|k| minor_step.times(k).clamp(lo, hi)).collect(),
        major: major.into_iter().map(label).collect(),
    }
}

/// Ticks of a logarithmic axis from `lo` to `hi` (log₁₀ of its limits). The labels are:
/// - powers of ten, if at least two are on the axis;
/// - else multiples of powers of ten by 1, 2 and 5, if there are 2 to `most` of them;
/// - else round values, as on a linear axis.
pub(super) fn logarithmic(lo: f64, hi: f64, most: usize) -> Ticks {
    if !(hi > lo && (hi - lo).is_finite()) {
        return Ticks::default();
    }
    let most = most.clamp(2, 10);
    let (powers, with_2_and_5) = (multiples(lo, hi, &[1]), multiples(lo, hi, &[1, 2, 5]));
    let (major, between) = if let [first, .., last] = powers[..] {
        // The powers whose exponents are multiples of the stride.
        let every = |stride: i32| powers.iter().filter(|(e, _)| e % stride == 0).copied().collect::<Vec<_>>();
        let stride = (1..=600).find(|s| every(*s).len() <= most).unwrap_or(1);
        let digits: &[i32] = match stride {
            1 if powers.len() <= 7 => &[2, 3, 4, 5, 6, 7, 8, 9],
            1..=9 => &[1],
            _ => &[],
        };
        // A stride may skip all but one decade: then the first and the last are labelled.
        let major = every(stride);
        (if major.len() < 2 { vec![first, last] } else { major }, multiples(lo, hi, digits))
    } else if (2..=most).contains(&with_2_and_5.len()) {
        (with_2_and_5, multiples(lo, hi, &[2, 3, 4, 5, 6, 7, 8, 9]))
    } else {
        return of_values(lo, hi, most);
    };
    // Plain decimals instead of powers of ten where they are short.
    let plain = lo > -3.5 && hi < 4.5;
    let label = |&(decade, digit): &(i32, i32)| match digit {
        _ if plain => {
            let value = TickStep { mantissa: digit, exponent: decade, parts: 1 }.times(1.0);
            fixed(value, usize::try_from(-decade).unwrap_or(0))
        }
        1 => power_of_ten(decade),
        _ => format!("{digit}×{}", power_of_ten(decade)),
    };
    let minor = between.iter().filter(|at| !major.contains(at)).map(|at| place(*at).clamp(lo, hi)).collect();
    let major = major.iter().map(|at| Tick { at: place(*at).clamp(lo, hi), label: label(at) }).collect();
    Ticks { major, minor }
}

/// Ticks at round values on less than half a decade, placed at their logarithms.
fn of_values(lo: f64, hi: f64, most: usize) -> Ticks {
    let value = |u: f64| 10f64.powf(u.clamp(-300.0, 300.0));
    let power = engineering(value(hi));
    let mut ticks = linear(value(lo), value(hi), most, power, false);
    for tick in &mut ticks.major {
        if power != 0 {
            tick.label = format!("{}×{}", tick.label, power_of_ten(power));
        }
        tick.at = tick.at.log10().clamp(lo, hi);
    }
    ticks.minor.iter_mut().for_each(|u| *u = u.log10().clamp(lo, hi));
    ticks
}

/// Decade and digit of every multiple of a power of ten by one of `digits`, from `lo` to `hi`.
fn multiples(lo: f64, hi: f64, digits: &[i32]) -> Vec<(i32, i32)> {
    ((lo - SLACK).floor() as i32..=hi.ceil() as i32)
        .flat_map(|e| digits.iter().map(move |&m| (e, m)))
        .filter(|at| (lo - SLACK..=hi + SLACK).contains(&place(*at)))
        .collect()
}

/// Place of a digit in a decade, as log₁₀.
fn place((decade, digit): (i32, i32)) -> f64 {
    f64::from(decade) + f64::from(digit).log10()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(ticks: &Ticks) -> Vec<&str> {
        ticks.major.iter().map(|t| t.label.as_str()).collect()
    }

    /// Conditions that the ticks of every axis meet.
    fn sound(ticks: &Ticks, lo: f64, hi: f64, most: usize) {
        let at: Vec<f64> = ticks.major.iter().map(|t| t.at).collect();
        assert!((2..=most.max(5)).contains(&at.len()), "{at:?} between {lo} and {hi}");
        assert!(at.iter().chain(&ticks.minor).all(|u| (lo..=hi).contains(u)), "{ticks:?}");
        assert!(at.windows(2).all(|w| w[0] < w[1]), "{ticks:?}");
        let mut distinct = labels(ticks);
        distinct.dedup();
        assert_eq!(distinct.len(), at.len(), "{ticks:?}");
        assert!(ticks.minor.windows(2).all(|w| w[0] <= w[1]) && ticks.minor.len() <= 100, "{ticks:?}");
    }

    proptest! {
        #[test]
        fn linear_ticks_are_few_within_and_ascending(
            mantissa in -10.0..10.0f64, scale in -280..300i32, size in -9.0..0.0f64, most in 2usize..=10,
        ) {
            let lo = mantissa * 10f64.powi(scale);
            let hi = lo + 10f64.powf(size) * lo.abs().max(10f64.powi(scale));
            let ticks = linear(lo, hi, most, 0, false);
            sound(&ticks, lo, hi, most);
        }

        #[test]
        fn linear_labels_say_the_value(lo in -1e4..1e4f64, span in 1e-3..1e5f64, power in -6..6i32) {
            for tick in linear(lo, lo + span, 7, power, false).major {
                let read: f64 = tick.label.replace('−', "-").parse().unwrap();
                let value = read * 10f64.powi(power);
                // The label is exact in decimal; the value differs by rounding alone, unless it was clamped
                // to a limit, which lies within 1e-9 of a step.
                prop_assert!((value - tick.at).abs() <= 1e-9 * span + 1e-12 * value.abs(), "{tick:?}");
            }
        }

        #[test]
        fn degrees_step_by_parts_of_the_circle(lo in -720.0..720.0f64, span in 20.1..3000.0f64, most in 3usize..=10) {
            let ticks = linear(lo, lo + span, most, 0, true);
            sound(&ticks, lo, lo + span, most);
            let step = ticks.major[1].at - ticks.major[0].at;
            prop_assert!(DEGREES.iter().any(|d| (f64::from(d.0) - step).abs() < 1e-6));
        }

        #[test]
        fn logarithmic_ticks_are_few_within_and_ascending(
            lo in -290.0..280.0f64, size in -3.0..2.7f64, most in 2usize..=10,
        ) {
            let hi = (lo + 10f64.powf(size)).min(299.0);
            let ticks = logarithmic(lo, hi, most);
            sound(&ticks, lo, hi, most);
        }
    }

    #[test]
    fn well_known_axes() {
        assert_eq!(labels(&linear(0.0, 1.0, 6, 0, false)), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(&linear(-0.003, 0.003, 7, -3, false)), ["−3", "−2", "−1", "0", "1", "2", "3"]);
        assert_eq!(labels(&linear(3.0, 14.0, 6, 0, false)), ["4", "6", "8", "10", "12", "14"]);
        assert_eq!(labels(&linear(-180.0, 180.0, 5, 0, true)), ["−180", "−90", "0", "90", "180"]);
        assert_eq!(labels(&logarithmic(-2.0, 2.0, 8)), ["0.01", "0.1", "1", "10", "100"]);
        assert_eq!(labels(&logarithmic(-7.0, -3.0, 8)), ["10⁻⁷", "10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³"]);
        assert_eq!(labels(&logarithmic(3f64.log10(), 80f64.log10(), 8)), ["5", "10", "20", "50"]);
        assert_eq!(labels(&logarithmic(3f64.log10(), 4.5f64.log10(), 5)), ["3.0", "3.5", "4.0", "4.5"]);
    }

    #[test]
    fn minor_ticks_divide_the_step() {
        let ticks = linear(0.0, 1.0, 6, 0, false);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert_eq!(ticks.minor.len(), 15);
        assert!(close(ticks.minor[0], 0.05) && close(ticks.minor[14], 0.95));
        assert_eq!(logarithmic(0.0, 2.0, 5).minor.len(), 16);
    }

    #[test]
    fn impossible_limits_have_no_ticks() {
        for (lo, hi) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY), (-f64::MAX, f64::MAX)]
        {
            assert_eq!(linear(lo, hi, 5, 0, false), Ticks::default());
            assert_eq!(logarithmic(lo, hi, 5), Ticks::default());
        }
    }
}
