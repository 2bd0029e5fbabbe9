//! Restitution from a drop: R = (Δt/2)√(g/2h), the flight between first and second impact against the fall
//! before.

use super::fit::FlightNoise;
use super::{GROSS, MethodAnswer, Train, above_zero, not_negative, repeated, together};
use crate::Estimate;
use crate::mean::{average, scatter};
use vibro_math::Noise;
use vibro_record::units::notation::quantity;
use vibro_record::{Doubt, Error, Finding, Result};

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
    /// Relative standard uncertainty of the clock of the intervals, which all drops share.
    pub clock: f64,
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
            clock: 0.0,
        }
    }
}

impl Drop {
    /// R of one interval in s.
    pub fn restitution(&self, interval: f64) -> f64 {
        0.5 * interval * (self.gravity / (2.0 * self.height)).sqrt()
    }

    /// The flight in s after the fall if R were 1; `None` without a height.
    pub fn full_flight(&self) -> Option<f64> {
        let flight = (8.0 * self.height / self.gravity).sqrt();
        Some(flight).filter(|flight| flight.is_finite() && *flight > 0.0)
    }

    /// Adds the first flights of trains that begin with the fall. An interval has two onsets, so its
    /// uncertainty is √2 times theirs, the root mean square over the trains.
    pub fn beginning(mut self, trains: &[Train]) -> Drop {
        self.intervals.extend(trains.iter().filter_map(|t| t.intervals.first()));
        let onset_std = together(trains.iter().map(|t| t.onset_std));
        self.clock = trains.iter().fold(self.clock, |most, train| most.max(train.clock));
        self.interval_std = self.interval_std.or(onset_std.map(|s| 2f64.sqrt() * s));
        self
    }

    /// Whether the first flights of all trains are among these intervals.
    pub(super) fn begins(&self, trains: &[Train]) -> bool {
        trains.iter().all(|t| t.intervals.first().is_some_and(|first| self.intervals.contains(first)))
    }

    /// Doubt where the ratio of the second flight to the first is not the R of the drop, by more than
    /// [`GROSS`].
    pub(super) fn unlike(&self, trains: &[Train]) -> Option<Doubt> {
        let unlike = |train: &Train| {
            let [first, second, ..] = train.intervals[..] else { return None };
            let (by_fall, by_flights) = (self.restitution(first), second / first);
            let apart = (by_fall - by_flights).abs() > GROSS * by_fall.max(by_flights);
            apart.then(|| {
                let found = Finding::doubt("methods-far-apart").name("first", "drop");
                let found = found.number("first_value", by_fall).name("second", "flight times");
                found.number("second_value", by_flights)
            })
        };
        trains.iter().find_map(unlike)
    }

    fn check(&self) -> Result<()> {
        above_zero("a height", self.height)?;
        above_zero("an acceleration of free fall", self.gravity)?;
        not_negative("an uncertainty of the height", self.height_std)?;
        not_negative("an uncertainty of the interval", self.interval_std)?;
        not_negative("an uncertainty of the acceleration of free fall", self.gravity_std)?;
        if self.intervals.is_empty() {
            return Err(Error::usage("a height without an interval", "an interval, or records of drops")
                .hint("state the time between first and second impact")
                .setting("interval"));
        }
        for (i, interval) in self.intervals.iter().enumerate() {
            above_zero("an interval", *interval)?;
            self.possible(*interval, &format!("the interval of drop {}", i + 1))?;
        }
        Ok(())
    }

    /// Refuses an `interval` in s for which R is above 1; `named` is its name in the message.
    ///
    /// # Errors
    /// If it is longer than the fall allows.
    pub fn possible(&self, interval: f64, named: &str) -> Result<()> {
        let (r, height) = (self.restitution(interval), self.height);
        if r.is_nan() || r <= 1.0 {
            return Ok(());
        }
        let [interval, most] = [interval, interval / r].map(|time| quantity(time, "s", 4));
        let why =
            format!("{named}, {interval}, gives R = {r:.3}: after a fall of {height} m it is {most} at most");
        let hint = "the height in metres, and the interval in seconds from the first impact to the second";
        Err(Error::refused(why).hint(hint))
    }

    /// R with `(u_R/R)² = (u_Δt/Δt)² + (u_h/2h)² + (u_g/2g)²`. Drops share the height, and each has its own
    /// timing: the uncertainty needs both. The timing of one drop is no better than the `noise` of flights
    /// in trains, since R scatters from bounce to bounce.
    pub(super) fn answer(
        &self,
        noise: Option<FlightNoise>,
        findings: &mut Vec<Finding>,
    ) -> Result<MethodAnswer> {
        self.check()?;
        let n = self.intervals.len();
        let shown = noise.map(|noise| noise.of(average(&self.intervals)));
        let (mean, timing) =
            repeated(&self.intervals, [self.interval_std, shown].into_iter().flatten().reduce(f64::max));
        let value = self.restitution(mean);
        let share = |u: f64, x: f64| (u / x).powi(2);
        let std = timing.zip(self.height_std).map(|(timing, height)| {
            let gravity = self.gravity_std.map_or(0.0, |u| share(u, 2.0 * self.gravity));
            value * (share(timing, mean) + share(height, 2.0 * self.height) + gravity).sqrt()
        });
        if std.is_none() {
            let without = Finding::caution("drop-without-uncertainty").count("n", n);
            let without = match timing {
                Some(timing) => without.number("timing", value * timing / mean),
                None => without.count("drops", n),
            };
            let known = self.height_std.is_some();
            findings.push(if known { without } else { without.number("height", self.height) });
        }
        let of = if n == 1 { "one drop".to_owned() } else { format!("the mean of {n} drops") };
        let restitution = Estimate::new(value, std, "1", n, format!("(Δt/2)√(g/2h) of {of}"));
        // A ratio of flights does not depend on the clock; one flight against a height does.
        let restitution = restitution.with_relative(self.clock);
        Ok(MethodAnswer { method: "drop", restitution })
    }

    /// Standard deviation of R over 2000 resamples of the drops with replacement; `None` for fewer than
    /// five.
    pub(super) fn bootstrap(&self) -> Option<f64> {
        const DRAWINGS: usize = 2000;
        let n = self.intervals.len();
        let mut noise = Noise::new(1979);
        let mut draw =
            || self.intervals.get((noise.uniform() * n as f64) as usize).copied().unwrap_or(f64::NAN);
        let mut mean = || (0..n).map(|_| draw()).sum::<f64>() / n as f64;
        (n >= 5).then(|| scatter(&(0..DRAWINGS).map(|_| self.restitution(mean())).collect::<Vec<f64>>()))
    }
}
