//! Expected uncertainty of planned drops and trains of bounces.

use super::drop::Drop;
use super::fit::{Flight, FlightNoise, known};
use super::flights::MANY;
use super::{LONGEST, Measured, STEP, Train, restitution};
use crate::Estimate;
use crate::expected::{Expected, Heard};
use vibro_math::Noise;
use vibro_record::{Error, Result};

/// Drops as they are guessed before the test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GuessedDrops {
    /// Height of the fall in m, and its standard uncertainty in m; `None`: not measured.
    pub height: Option<[f64; 2]>,
    /// Coefficient of restitution.
    pub restitution: f64,
    /// First flight in s, where there is no height.
    pub first_flight: Option<f64>,
    /// Impacts of a drop that are heard.
    pub impacts: usize,
    /// Standard uncertainty of the time of an impact, in s.
    pub onset_std: f64,
    /// Relative standard deviation of R from bounce to bounce.
    pub scatter: f64,
    /// Standard uncertainty of the contact time in s; `None` if none will be stated.
    pub contact_time_std: Option<f64>,
    /// Number of drops.
    pub drops: usize,
}

impl GuessedDrops {
    /// The fall of the drops; `None` without a height.
    fn fall(&self) -> Option<Drop> {
        let [height, height_std] = self.height?;
        Some(Drop { height, height_std: Some(height_std), ..Drop::default() })
    }

    /// Flights between the impacts, in s.
    ///
    /// # Errors
    /// If a number is impossible, or neither height nor first flight is given.
    pub fn flights(&self) -> Result<Vec<f64>> {
        let r = self.restitution;
        if !(r > 0.0 && r < 1.0) {
            let found = format!("a restitution of {r}");
            return Err(Error::usage(found, "a number above 0 and below 1").setting("restitution"));
        }
        if self.impacts < 2 {
            let found = format!("{} impacts", self.impacts);
            return Err(Error::usage(found, "two impacts or more").setting("impacts"));
        }
        let full = self.fall().and_then(|fall| fall.full_flight()).map(|full| r * full);
        let first = full.or(self.first_flight).ok_or_else(|| {
            Error::usage("neither a height nor a first flight", "one of them").setting("height")
        })?;
        Ok((0..self.impacts - 1).map(|k| first * r.powi(k as i32)).collect())
    }
}

/// What the drops will tell of R: by the fall, and by the ratios of flights where there are two or more.
///
/// The scatter of R and the noise of the onsets are taken as the guess has them. The estimator has to find
/// them, so it is a little less certain where flights are few.
///
/// # Errors
/// If the guess is impossible, or gives no answer.
pub fn expected(guess: &GuessedDrops) -> Result<Expected> {
    let (flights, n) = (guess.flights()?, guess.drops.max(1));
    let contact = guess.contact_time_std.unwrap_or(LONGEST / 3f64.sqrt());
    let (scatter, onset) = (guess.scatter.powi(2), guess.onset_std.powi(2));
    let noise = FlightNoise::new(scatter, onset);
    let mut found = Expected::default();
    if let Some(fall) = guess.fall() {
        let drops = Drop { intervals: vec![flights[0]; n], ..fall };
        let mut answer = drops.answer(Some(noise), &mut Vec::new())?.restitution;
        // A contact makes the interval longer by its time.
        let moved = contact / flights[0] * answer.value;
        answer.std = answer.std.map(|std| std.hypot(moved));
        found.put("restitution_by_drop", &answer);
    }
    if flights.len() > 1 {
        let train = |longer: f64| -> Vec<Flight> {
            let log = |(place, flight): (usize, &f64)| Flight { place, log: (flight - longer).ln() };
            flights.iter().enumerate().map(log).collect()
        };
        // Few trains are fitted together; of many, the mean counts.
        let together = if n < MANY { n } else { 1 };
        let fall = guess.height.is_some();
        let fitted = |longer: f64| known(&vec![train(longer); together], fall, [scatter, onset]);
        let both = fitted(0.0).zip(fitted(STEP));
        let ((log_r, variance), (moved, _)) =
            both.ok_or_else(|| Error::refused("flights from which no ratio follows"))?;
        let variance = variance * together as f64 / n as f64;
        let bias = contact * (moved - log_r) / STEP;
        let value = log_r.exp();
        let method = format!("generalised least squares of {} flight times", n * flights.len());
        let std = value * variance.sqrt().hypot(bias);
        found.put(
            "restitution_by_flight_times",
            &Estimate::new(value, Some(std), "1", n * flights.len(), method),
        );
    }
    if found.answers.is_empty() {
        let few = Error::refused("one flight without a height has no ratio");
        return Err(few.hint("three impacts or more, or the height of the fall").setting("impacts"));
    }
    Ok(found)
}

/// Draws series of drops, and measures them by [`super::restitution`]. Without a stated contact time each
/// series has one between 0 and the longest.
///
/// # Errors
/// As that, and if the guess is impossible.
pub fn rehearse(guess: &GuessedDrops) -> impl Fn(&mut Noise) -> Result<Heard> + use<> {
    let guess = *guess;
    move |noise| {
        let full = guess.flights()?[0] / guess.restitution;
        let contact = guess.contact_time_std.map_or_else(|| noise.between(0.0, LONGEST), |_| 0.0);
        let mut train = || {
            let (mut flight, mut time, mut times) = (full, 0.0, vec![guess.onset_std * noise.normal()]);
            for _ in 1..guess.impacts {
                flight *= guess.restitution * (guess.scatter * noise.normal()).exp();
                time += flight + contact;
                times.push(time + guess.onset_std * noise.normal());
            }
            let intervals = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
            Train { intervals, onset_std: Some(guess.onset_std), ..Train::default() }
        };
        let trains: Vec<Train> = (0..guess.drops.max(1)).map(|_| train()).collect();
        let drop = guess.fall().map(|fall| {
            let [height, std] = guess.height.unwrap_or_default();
            Drop { height: height + std * noise.normal(), ..fall }.beginning(&trains)
        });
        let contact_time = guess.contact_time_std.map(|_| 0.0);
        let contact_time_std = guess.contact_time_std.filter(|std| *std > 0.0);
        let measured = Measured { drop, trains, contact_time, contact_time_std, ..Measured::default() };
        let found = restitution(&measured)?;
        let named = |method: &str| format!("restitution_by_{}", method.replace(' ', "_"));
        let answers = found.by.iter().map(|way| (named(way.method), way.restitution.clone())).collect();
        Ok((answers, found.findings))
    }
}
