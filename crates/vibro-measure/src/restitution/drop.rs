//! Restitution from a drop: R = (Δt/2)√(g/2h), the flight between first and second impact against the fall before.

use super::{Measured, Shares, Train, Way, above_zero, not_negative};
use crate::Estimate;
use crate::impacts::{Impacts, ImpactsOptions, with_train};
use crate::residuals::student;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Result, Trace};

/// Standard acceleration of free fall in m/s² (CGPM 1901).
pub const GRAVITY: f64 = 9.806_65;

/// Drops from more than this, in m, are not made with a ruler: the height may be in other units.
const HIGH: f64 = 10.0;

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
        let fall = (2.0 * self.height / self.gravity).sqrt();
        for (i, interval) in self.intervals.iter().enumerate() {
            above_zero("an interval", *interval)?;
            if self.restitution(*interval) > 1.0 {
                return Err(Error::refused(format!(
                    "the interval of drop {}, {}, gives R = {:.3}: after a fall of {} m, which takes {fall:.4} s, the second impact comes after {:.4} s at most",
                    i + 1,
                    quantity(*interval, "s", 4),
                    self.restitution(*interval),
                    self.height,
                    2.0 * fall
                ))
                .hint("is the height in metres and the interval in seconds, and is the first impact the first?"));
            }
        }
        Ok(())
    }

    /// `(u_R/R)² = (u_Δt/Δt)² + (u_h/2h)² + (u_g/2g)²`; the interval's part is the scatter of several drops where that is larger than what is stated.
    /// The scatter of n drops has n − 1 degrees of freedom: its standard uncertainty is that of Student's distribution, which up to n = 3 has
    /// none. These have an uncertainty only where what is stated of an interval explains how they scatter (χ², 95 %). There is none without
    /// that of the height.
    pub(super) fn answer(&self, warnings: &mut Vec<String>) -> Result<Way> {
        self.check()?;
        let n = self.intervals.len();
        if n == 0 {
            return Err(Error::usage("a height without an interval", "--interval S, or records of drops"));
        }
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
        let known = timing.zip(self.height_std).map(|(timing, height)| {
            let gravity = self.gravity_std.map_or(0.0, |u| share(u, 2.0 * self.gravity));
            value * (share(timing, mean) + share(height, 2.0 * self.height) + gravity).sqrt()
        });
        if known.is_none() {
            warnings.push(self.no_uncertainty(timing.is_some()));
        } else if self.gravity_std.is_none() {
            warnings.push(
                "The uncertainty leaves out that of the acceleration of free fall g, which is not known."
                    .to_owned(),
            );
        }
        let how = match (known, timing) {
            (Some(_), _) if scatter.is_some() && timing == scatter => format!(
                "; uncertainty from their scatter (Student, {} degrees of freedom) and by propagation",
                n - 1
            ),
            (Some(_), _) => "; uncertainty by propagation".to_owned(),
            (None, Some(timing)) => {
                format!(" (the timing alone would give {})", quantity(value * timing / mean, "1", 2))
            }
            (None, None) => String::new(),
        };
        let of = if n == 1 { "one drop".to_owned() } else { format!("the mean of {n} drops") };
        let method = format!("(Δt/2)√(g/2h) of {of}{how}");
        self.notes(value, warnings)?;
        Ok(Way {
            method: "drop",
            restitution: Estimate::new(value, known, "1", n, method),
            shares: Shares::Flights,
        })
    }

    /// Why there is no uncertainty, where that of the timing is known or not.
    fn no_uncertainty(&self, timed: bool) -> String {
        let n = self.intervals.len();
        if timed {
            let of = if n == 1 { "The drop has" } else { "The drops share their height: they have" };
            return format!("{of} no standard uncertainty without that of the height: --height-std.");
        }
        let free = if n == 2 { "one degree" } else { "two degrees" };
        let height = if self.height_std.is_none() { ", and that of the height: --height-std" } else { "" };
        match self.interval_std {
            _ if n == 1 => format!(
                "One drop has no standard uncertainty without that of its interval: --interval-std{height}."
            ),
            Some(stated) => format!(
                "{n} drops scatter by more than the {} stated of an interval explains, and their scatter has {free} of freedom, too few for a standard uncertainty: four drops have one{height}.",
                quantity(stated, "s", 2)
            ),
            None => format!(
                "The scatter of {n} drops has {free} of freedom, too few for a standard uncertainty: four drops have one, or state that of an interval{height}."
            ),
        }
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

    /// What biases a drop, with its size where that follows from what is known.
    fn notes(&self, value: f64, warnings: &mut Vec<String>) -> Result<()> {
        if self.height > HIGH {
            warnings.push(format!(
                "A fall of {} takes {}: is the height in metres?",
                quantity(self.height, "m", 4),
                quantity((2.0 * self.height / self.gravity).sqrt(), "s", 3)
            ));
        }
        match self.masses {
            // Free mass at rest: v₁⁺/v₁⁻ = (m₁ − R m₂)/(m₁ + m₂).
            Some((m1, m2)) => {
                above_zero("a mass", m1)?;
                above_zero("a mass", m2)?;
                warnings.push(format!(
                    "A drop shows the rebound speed alone. If the struck mass moves freely during the impact, R is {:.4}, by a factor {:.4} larger.",
                    value + m1 / m2 * (1.0 + value),
                    1.0 + m1 / m2 * (1.0 + 1.0 / value)
                ));
            }
            None => warnings.push(
                "The struck mass is taken to stay at rest; if it moves, R is too low: by (m₁/m₂)(1 + R) if it is free.".to_owned(),
            ),
        }
        warnings.push(
            "Drag of the air and friction in the tube make R too low; a tilt by α from the vertical makes it too high, by 1/√cos α with the height along the tube and by 1/cos α with the vertical height (0.06 % and 0.1 % at 2.5°).".to_owned(),
        );
        Ok(())
    }
}

/// Drops and trains of bounces as traces show them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bounces {
    trains: Vec<Train>,
}

impl Bounces {
    /// Bounces lower than this part of the median one are not looked for.
    pub const THRESHOLD: f64 = 0.02;

    /// Adds the impacts of a falling body, and gives them; what precedes the first large one is handling, not an impact.
    ///
    /// # Errors
    /// As [`impacts`](crate::impacts::impacts); also where fewer than two impacts are left.
    pub fn add(&mut self, trace: &Trace, options: &ImpactsOptions) -> Result<Impacts> {
        // What a steady train would mean does not concern bounces.
        let (mut found, _) = with_train(trace, options)?;
        let largest = found.heights.iter().copied().fold(0.0, f64::max);
        // A body strikes first as hard as it ever does; half of that leaves room for coarse samples.
        let first = found.heights.iter().position(|h| *h >= 0.5 * largest).unwrap_or(0);
        if first > 0 {
            found.warnings.push(format!(
                "{first} burst{} before the first large one {} left out: handling, not an impact.",
                if first == 1 { "" } else { "s" },
                if first == 1 { "was" } else { "were" }
            ));
            found.times.drain(..first);
            found.heights.drain(..first);
            found.n = found.times.len();
        }
        let (Some(last), true) = (found.times.last(), found.n > 1) else {
            return Err(Error::refused("one impact was found: restitution from a drop needs two")
                .hint("--threshold lower, or --refractory shorter, where there are more"));
        };
        let end = trace.axis.start() + trace.values.len() as f64 * trace.axis.step().unwrap_or(f64::NAN);
        self.trains.push(Train {
            intervals: found.times.windows(2).map(|w| w[1] - w[0]).collect(),
            onset_std: found.onset_std,
            after: Some(end - last),
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
