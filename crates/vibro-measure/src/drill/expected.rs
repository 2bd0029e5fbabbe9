//! Expected uncertainty of the blows of a planned drill record.

use super::faults::State;
use super::parabola::Parabola;
use super::{Beam, DrillOptions, Edge, Slices, drill};
use crate::Estimate;
use crate::expected::{DrawnNoise, Expected, Heard, Recorder};
use vibro_math::Noise;
use vibro_record::units::Unit;
use vibro_record::{Error, Result};

/// Blows as they are guessed before the test.
#[derive(Debug, Clone, PartialEq)]
pub struct GuessedBlows {
    /// Blows in a second.
    pub rate: f64,
    /// Velocity before the blow in m/s.
    pub before: f64,
    /// Velocity after it in m/s, negative for a rebound.
    pub after: f64,
    /// Relative standard deviation of the velocities from blow to blow, which grow and fall together.
    pub scatter: f64,
    /// Standard deviation in m/s of the velocity after a blow of given strength.
    pub after_scatter: f64,
    /// Mass in kg, for the energies.
    pub mass: Option<f64>,
    /// The struck mass in kg, at rest before the blow.
    pub struck_mass: Option<f64>,
    /// Sensitivity of the laser in m/s for one unit of the record.
    pub sensitivity: f64,
    /// The beam of the laser.
    pub beam: Beam,
    /// Standard uncertainty of the beam's angle in degrees.
    pub beam_std: f64,
    /// Longest contact in s; `None`: the default of a drill.
    pub contact: Option<f64>,
    /// Length of the fits beside it in s; `None`: the default of a drill.
    pub fit: Option<f64>,
}

impl GuessedBlows {
    fn options(&self) -> DrillOptions {
        let mut options = DrillOptions::new(self.sensitivity, self.beam, 1, Edge::Rising);
        options.contact = self.contact.unwrap_or(options.contact);
        options.fit = self.fit.unwrap_or(options.fit);
        (options.mass, options.struck_mass) = (self.mass, self.struck_mass);
        options
    }
}

/// Coefficients of the samples of a parabola in its value at the middle of the contact, the nearest sample
/// first.
fn weights(options: &DrillOptions, rate: f64) -> Option<Vec<f64>> {
    let (contact, fit) = options.lengths(rate);
    let gap = ((0.5 * contact).ceil() as usize).max(1);
    let length = (fit.round() as usize).max(super::parabola::FEWEST);
    let states = vec![State::Good; length];
    let one = |k: usize| {
        let mut values = vec![0.0; length];
        values[k] = 1.0;
        // The middle of the contact lies anywhere between two samples.
        Some(Parabola::through(&values, &states, -(gap as f64) - 0.5, 0..=length as isize - 1)?.value)
    };
    (0..length).map(one).collect()
}

/// What a record of the blows will tell: the means over all blows, by the parabolas of [`super::drill`].
///
/// # Errors
/// If the record holds fewer than two blows, or a fit has too few samples.
pub fn expected(guess: &GuessedBlows, recorder: &Recorder) -> Result<Expected> {
    let options = guess.options();
    let n = (guess.rate * recorder.duration).floor();
    if n < 2.0 {
        let why = format!("{} s hold fewer than two blows", recorder.duration);
        return Err(Error::refused(why).hint("record longer").setting("duration"));
    }
    Recorder::check_work(options.lengths(recorder.rate).1)?;
    let few = || Error::refused("too few samples for a parabola").hint("sample faster, or a longer fit");
    let weights = weights(&options, recorder.rate).ok_or_else(few)?;
    // Both sides have mirrored weights, and samples so far apart that their noise is independent.
    let unit = guess.sensitivity * guess.beam.factor;
    recorder.holds(guess.before.abs().max(guess.after.abs()) / unit)?;
    let product = |(i, a): (usize, &f64), (j, b): (usize, &f64)| a * b * recorder.covariance(i.abs_diff(j));
    let pairs =
        weights.iter().enumerate().map(|a| weights.iter().enumerate().map(|b| product(a, b)).sum::<f64>());
    let noise = unit * unit * pairs.sum::<f64>();
    let beam = guess.beam.per_degree * guess.beam_std;
    let GuessedBlows { before, after, scatter, after_scatter, .. } = *guess;
    let count = n as usize;
    // How an answer moves with the noise of one velocity, the strength of a blow, the velocity after it, and
    // the beam.
    let estimate = |value: f64, [of_noise, of_strength, of_after, of_beam]: [f64; 4], unit, method: &str| {
        let own = (of_strength * scatter).hypot(of_after * after_scatter);
        let std = (of_noise * of_noise * noise + own * own) / n;
        Estimate::new(value, Some(std.sqrt().hypot(of_beam * beam)), unit, count, method)
    };
    let mean = "parabolas beside the contact, mean over the blows";
    let mut found = Expected::default();
    found.put("before", &estimate(before, [1.0, before, 0.0, before], "m/s", mean));
    found.put("after", &estimate(after, [1.0, after, 1.0, after], "m/s", mean));
    let ratio = guess.mass.zip(guess.struck_mass).map_or(0.0, |(mass, struck)| mass / struck);
    let value = (ratio * (before - after) - after) / before;
    // The approach moves R by (ratio − R)/v, the rebound by −(1 + ratio)/v; a blow that is faster as a whole
    // leaves R.
    let of_noise = (ratio - value).hypot(1.0 + ratio) / before;
    let method = "ratio of the sums over the blows";
    let of_after = (1.0 + ratio) / before;
    found.put("restitution", &estimate(value, [of_noise, 0.0, of_after, 0.0], "1", method));
    if let Some(mass) = guess.mass {
        // The mean square of a strength that scatters by s is 1 + s², its variance 4s² + 2s⁴.
        let (square, of_strength) = (1.0 + scatter * scatter, (4.0 + 2.0 * scatter * scatter).sqrt());
        let energy = 0.5 * mass * before * before;
        let mean = "½ m v² before, mean over the blows";
        let moved = [mass * before, of_strength * energy, 0.0, 2.0 * energy];
        found.put("energy", &estimate(energy * square, moved, "J", mean));
        let given = 0.5 * mass * (before * before - after * after);
        let mean = "½ m (v² before − v² after), mean over the blows";
        let moved = [mass * before.hypot(after), of_strength * given, mass * after, 2.0 * given];
        let value = given * square - 0.5 * mass * after_scatter * after_scatter;
        found.put("energy_given", &estimate(value, moved, "J", mean));
    }
    Ok(found)
}

/// Turns of the crank at the first sample of a drawn record, and from there to its pulse; part of a turn that
/// the pulse lasts.
const BEGIN: f64 = 0.4;
const TO_PULSE: f64 = 0.3;
const PULSE: f64 = 0.1;

/// Draws records of the blows beside pulses of the crank, and measures them by [`super::drill`]. Between two
/// blows the velocity is a parabola without a mean. The beam of each record is off by an angle of its own.
///
/// # Errors
/// As that.
pub fn rehearse(guess: &GuessedBlows, recorder: &Recorder) -> impl Fn(&mut Noise) -> Result<Heard> + use<> {
    let (guess, n, rate) = (guess.clone(), recorder.samples(), recorder.rate);
    let drawn = DrawnNoise::of(recorder, n);
    let turn = move |i: usize| guess.rate * i as f64 / rate + BEGIN;
    let high = |i: usize| (turn(i) + TO_PULSE).fract() < PULSE;
    let pulses: Vec<f64> = (0..n).map(|i| if high(i) { 5.0 } else { 0.0 }).collect();
    let unit = guess.sensitivity * guess.beam.factor;
    move |noise| {
        let unit = unit * (1.0 + guess.beam.per_degree * guess.beam_std * noise.normal());
        // Velocities before and after each blow.
        let mut blow = |_| {
            let strength = 1.0 + guess.scatter * noise.normal();
            (guess.before * strength, guess.after * strength + guess.after_scatter * noise.normal())
        };
        let blows: Vec<(f64, f64)> = (0..turn(n) as usize + 2).map(&mut blow).collect();
        let value = |i: usize| {
            let (k, s) = (turn(i) as usize, turn(i).fract());
            let (from, to) = (blows[k].1, blows[k + 1].0);
            let bend = 3.0 * (from + to);
            (from + s * (to - from - bend + s * bend)) / unit
        };
        let volts = Unit::parse("V").ok_or_else(|| Error::refused("the unit of a record"))?;
        let record = drawn.record((0..n).map(value).collect(), volts, noise);
        let channels = vec![&record.values[..], &pulses[..]];
        let found = drill(&Slices { rate, channels }, &guess.options(), None)?;
        let all = [
            ("before", &found.before),
            ("after", &found.after),
            ("restitution", &found.restitution),
            ("energy", &found.energy),
            ("energy_given", &found.energy_given),
        ];
        let known = all.into_iter().filter_map(|(name, estimate)| Some((name.to_owned(), estimate.clone()?)));
        Ok((known.collect(), found.findings))
    }
}
