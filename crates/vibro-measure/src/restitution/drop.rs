//! Restitution from a drop: R = (Δt/2)√(g/2h), the flight between first and second impact against the fall before.

use super::{Measured, Method, Shares, Train, Way, above_zero, not_negative};
use crate::Estimate;
use crate::impacts::{Detected, ImpactsOptions, detect};
use crate::residuals::student;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Finding, Result, Trace};

/// Standard acceleration of free fall in m/s² (CGPM 1901).
pub const GRAVITY: f64 = 9.806_65;

/// Drops from one height.
#[derive(Debug, Clone, PartialEq)]
pub struct Drop {
    /// Height of the fall in m.
    pub height: f64,
    /// Its standard uncertainty in m.
    pub height_std: Option<f64>,
    /// Time from the first to the second impact of each drop, in s.
    pub intervals: Vec<f64>,
    /// Standard uncertainty of one of them, in s.
    pub interval_std: Option<f64>,
    /// Acceleration of free fall in m/s².
    pub gravity: f64,
    /// Its standard uncertainty in m/s².
    pub gravity_std: Option<f64>,
    /// Masses of the falling and of the struck body in kg, where the latter is free to move.
    pub masses: Option<(f64, f64)>,
}

impl Default for Drop {
    fn default() -> Drop {
        Drop {
            height: f64::NAN,
            height_std: None,
            intervals: Vec::new(),
            interval_std: None,
            gravity: GRAVITY,
            gravity_std: None,
            masses: None,
        }
    }
}

impl Drop {
    /// R of one interval.
    pub fn restitution(&self, interval: f64) -> f64 {
        0.5 * interval * (self.gravity / (2.0 * self.height)).sqrt()
    }

    fn check(&self) -> Result<()> {
        above_zero("a height", self.height)?;
        above_zero("an acceleration of free fall", self.gravity)?;
        not_negative("an uncertainty of the height", self.height_std)?;
        not_negative("an uncertainty of the interval", self.interval_std)?;
        not_negative("an uncertainty of the acceleration of free fall", self.gravity_std)?;
        if let Some((m1, m2)) = self.masses {
            above_zero("a mass", m1)?;
            above_zero("a mass", m2)?;
        }
        if self.intervals.is_empty() {
            return Err(Error::usage("a height without an interval", "an interval, or records of drops")
                .hint("state the time between first and second impact")
                .setting("interval"));
        }
        for (i, interval) in self.intervals.iter().enumerate() {
            above_zero("an interval", *interval)?;
            let r = self.restitution(*interval);
            if r > 1.0 {
                return Err(Error::refused(format!(
                    "the interval of drop {}, {}, gives R = {r:.3}: after a fall of {} m it is {} at most",
                    i + 1,
                    quantity(*interval, "s", 4),
                    self.height,
                    quantity(interval / r, "s", 4)
                ))
                .hint(
                    "the height in metres, and the interval in seconds from the first impact to the second",
                ));
            }
        }
        Ok(())
    }

    /// `(u_R/R)² = (u_Δt/Δt)² + (u_h/2h)² + (u_g/2g)²`; the interval's part is the larger of what is stated and of the scatter of several
    /// drops. The scatter of n drops has n − 1 degrees of freedom: its standard uncertainty is that of Student's distribution, which up to
    /// n = 3 has none. These have an uncertainty only where what is stated of an interval explains how they scatter (χ², 95 %).
    pub(super) fn answer(&self, findings: &mut Vec<Finding>) -> Result<Way> {
        self.check()?;
        let n = self.intervals.len();
        let mean = self.intervals.iter().sum::<f64>() / n as f64;
        let squares = self.intervals.iter().map(|d| (d - mean).powi(2)).sum::<f64>();
        let scatter = student(n - 1).map(|factor| factor * (squares / (n - 1) as f64 / n as f64).sqrt());
        // Quantiles 0.95 of χ² of one and two degrees of freedom.
        let explains = |s: f64| n == 1 || n > 3 || squares <= [3.841, 5.991][n - 2] * s * s;
        let stated = self.interval_std.filter(|s| explains(*s)).map(|s| s / (n as f64).sqrt());
        let timing = match (scatter, stated) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        };
        let value = self.restitution(mean);
        let share = |u: f64, x: f64| (u / x).powi(2);
        // Every drop shares the height, and each has its own timing: neither stands in for the other.
        let std = timing.zip(self.height_std).map(|(timing, height)| {
            let gravity = self.gravity_std.map_or(0.0, |u| share(u, 2.0 * self.gravity));
            value * (share(timing, mean) + share(height, 2.0 * self.height) + gravity).sqrt()
        });
        findings.extend(match (timing, self.interval_std) {
            (Some(timing), _) if std.is_none() => {
                Some(Finding::caution("height-without-uncertainty").number("timing", value * timing / mean))
            }
            (Some(_), _) => self.gravity_std.is_none().then(|| Finding::note("gravity-without-uncertainty")),
            (None, _) if n == 1 => Some(Finding::caution("interval-without-uncertainty")),
            (None, None) => Some(Finding::caution("too-few-drops").count("n", n)),
            (None, Some(stated)) => {
                Some(Finding::caution("drops-scatter-too-much").count("n", n).number("stated", stated))
            }
        });
        findings.push(match self.masses {
            // A free mass at rest: v₁⁺/v₁⁻ = (m₁ − R m₂)/(m₁ + m₂).
            Some((m1, m2)) => {
                Finding::caution("struck-mass-free").number("free", value + m1 / m2 * (1.0 + value))
            }
            None => Finding::note("struck-mass-at-rest"),
        });
        findings.push(Finding::note("drop-biases"));
        let of = if n == 1 { "one drop".to_owned() } else { format!("the mean of {n} drops") };
        Ok(Way {
            method: Method::Drop,
            restitution: Estimate::new(value, std, "1", n, format!("(Δt/2)√(g/2h) of {of}")),
            shares: Shares::Flights,
        })
    }

    /// Standard deviation of R over drawings of as many drops with replacement; `None` for fewer than five.
    pub(super) fn bootstrap(&self) -> Option<f64> {
        const DRAWINGS: usize = 2000;
        let n = self.intervals.len();
        if n < 5 {
            return None;
        }
        // Knuth's generator for MMIX, whose upper bits are the better ones.
        let mut state = 1979u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            self.intervals.get((state >> 33) as usize % n).copied().unwrap_or(f64::NAN)
        };
        let values: Vec<f64> =
            (0..DRAWINGS).map(|_| self.restitution((0..n).map(|_| draw()).sum::<f64>() / n as f64)).collect();
        let mean = values.iter().sum::<f64>() / DRAWINGS as f64;
        let sum: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        Some((sum / (DRAWINGS - 1) as f64).sqrt())
    }
}

/// Drops and trains of bounces from traces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bounces {
    trains: Vec<Train>,
}

impl Bounces {
    /// Lowest bounce as a part of the median one.
    pub const THRESHOLD: f64 = 0.02;

    /// Adds the impacts of a falling body, and returns them; what precedes the first large one is handling, not an impact.
    ///
    /// # Errors
    /// As [`detect`]; also where fewer than two impacts are left.
    pub fn add(&mut self, trace: &Trace, options: &ImpactsOptions) -> Result<Detected> {
        let mut found = detect(trace, options)?;
        let largest = found.heights.iter().copied().fold(0.0, f64::max);
        // A body strikes first as hard as it ever does; half of that leaves room for coarse samples.
        let first = found.heights.iter().position(|h| *h >= 0.5 * largest).unwrap_or(0);
        if first > 0 {
            found.findings.push(Finding::note("handling-ignored").count("n", first));
            found.times.drain(..first);
            found.heights.drain(..first);
        }
        if found.times.len() < 2 {
            return Err(Error::refused("one impact found: restitution from a drop needs two")
                .hint("a lower threshold, or a shorter pause between impacts")
                .setting("threshold")
                .setting("refractory"));
        }
        self.trains.push(Train {
            intervals: found.times.windows(2).map(|w| w[1] - w[0]).collect(),
            onset_std: found.onset_std,
        });
        Ok(found)
    }

    /// All that follows from these bounces: drops from the height of `drop` with `fell`, and trains where there are more than two impacts.
    pub fn measured(self, mut drop: Drop, fell: bool) -> Measured {
        drop.intervals.extend(self.trains.iter().filter_map(|t| t.intervals.first()));
        // One interval has two onsets; of several traces, the root mean square.
        let onsets: Option<Vec<f64>> = self.trains.iter().map(|t| t.onset_std).collect();
        let onsets = onsets
            .filter(|o| !o.is_empty())
            .map(|o| (2.0 * o.iter().map(|s| s * s).sum::<f64>() / o.len() as f64).sqrt());
        drop.interval_std = drop.interval_std.or(onsets);
        Measured {
            drop: (fell && !drop.intervals.is_empty()).then_some(drop),
            trains: self.trains,
            velocities: None,
        }
    }
}
