//! Hammer drills: a laser on the striker or the bit, and a pulse once a turn of the crank.
//!
//! The velocity is what the laser shows times its sensitivity over cos α, α the angle between beam and motion. Edges of the
//! reference cut the record into turns; phases are parts of a turn after the edge, which for a pulse at the upper end of
//! the piston's stroke is the phase after top dead centre. The record is gone over three times block by block, so that
//! memory grows with the number of turns (some hundred bytes each) but not with the number of samples.
//!
//! ```
//! use vibro_measure::drill::{Beam, DrillOptions, Edge, From, Slices, drill};
//! let rate = 20_000.0;
//! let turn = |i: u32| f64::from(i) / 400.0; // 50 turns a second
//! // A volt is 2 m/s; speeds up to 6 m/s, then an impact that leaves −1 m/s. The pulse comes at the beginning of a turn.
//! let volts: Vec<f64> = (0..20_000).map(|i| 0.5 * (-1.0 + 7.0 * (turn(i) + 0.4).fract())).collect();
//! let pulse: Vec<f64> = (0..20_000).map(|i| if turn(i).fract() < 0.1 { 5.0 } else { 0.0 }).collect();
//! let options = DrillOptions::new(2.0, Beam::new(0.0, From::Axis)?, 1, Edge::Rising);
//! let found = drill(&mut Slices { rate, channels: vec![&volts, &pulse] }, &options, None)?;
//! assert!((found.speed.value - 50.0).abs() < 1e-3);
//! assert!((found.impacts[0].before - 6.0).abs() < 0.05 && (found.impacts[0].phase - 0.6).abs() < 0.003);
//! # Ok::<(), vibro_record::Error>(())
//! ```

mod average;
mod beam;
mod channels;
mod crossing;
mod cycle;
mod edges;
mod faults;
mod floor;
mod groups;
mod impact;
mod jumps;
mod misfit;
mod motion;
mod options;
mod passing;
mod rebound;
mod residue;
mod result;
mod running;
mod side;
mod smoothing;
mod summary;
mod survey;
mod suspect;
mod turns;

use average::Average;
pub use beam::{Beam, From};
pub use channels::{Channels, Slices};
pub use cycle::Cycle;
pub use edges::Edge;
pub(crate) use edges::{Edges, Found};
pub use faults::FaultCount;
pub use floor::NoiseFloor;
pub use groups::Group;
pub use impact::Impact;
use jumps::Jumps;
pub use motion::Bandwidth;
use motion::{Motion, displacement};
pub use options::DrillOptions;
pub use result::{BeamResult, Corner, Displacement, Drill, Phases, Pulses};
pub(crate) use running::Running;
pub use smoothing::Smoothing;
pub(crate) use survey::Survey;
pub(crate) use turns::Numbered;
pub use turns::{Turn, Turns};

use super::exposure::{Handle, exposure};
use passing::Pass;
use vibro_record::{Error, Result};
use vibro_signal::welch::Stream;

/// Samples of the end and the middle of a part of the record that are kept to be drawn.
const EXCERPT: usize = 1 << 16;

/// Measures the turns and impacts of a drill; `still` is a record of the same velocity channel without motion, in m/s.
///
/// # Errors
/// If the parameters cannot be; if the velocity is constant or missing; if velocity and reference are the same or look swapped; if the
/// reference has not two levels nor even edges, or no whole turn between its edges; if a channel cannot be read.
pub fn drill(channels: &mut dyn Channels, options: &DrillOptions, still: Option<&Stream>) -> Result<Drill> {
    drill_each(channels, options, still, &mut |_| Ok(()))
}

/// As [`drill`], and hands out each turn of the average, resampled, as it comes.
///
/// # Errors
/// As [`drill`], and if `each` fails.
pub fn drill_each(
    channels: &mut dyn Channels,
    options: &DrillOptions,
    still: Option<&Stream>,
    each: &mut dyn FnMut(&Cycle<'_>) -> Result<()>,
) -> Result<Drill> {
    options.check()?;
    let rate = channels.rate();
    if !(rate.is_finite() && rate > 0.0) {
        return Err(Error::usage(format!("a sampling rate of {rate} Hz"), "a finite number above 0"));
    }
    let factor = options.sensitivity * options.beam.factor();
    let (mut velocity, mut reference) = (Survey::default(), Survey::default());
    let mut handles: Vec<Handle> = Vec::new();
    let (mut same, mut frames) = (true, 0);
    let mut scaled: Vec<f64> = Vec::new();
    channels.play(&mut |block| {
        let [v, r, axes @ ..] = block else {
            return Err(Error::usage(format!("{} channels", block.len()), "a velocity and a reference"));
        };
        same = same && v.iter().zip(*r).all(|(a, b)| a == b || (a.is_nan() && b.is_nan()));
        scale(v, factor, &mut scaled);
        frames += scaled.len();
        velocity.push(&scaled);
        reference.push(r);
        while handles.len() < axes.len() {
            handles.push(Handle::new(rate)?);
        }
        handles.iter_mut().zip(axes).for_each(|(handle, axis)| handle.push(axis));
        Ok(())
    })?;
    let levels = check(&velocity, &reference, same, options)?;
    let mut edges = Edges::new(levels.0, levels.1, options.edge);
    channels.play(&mut |block| {
        edges.push(block.get(1).copied().unwrap_or_default());
        Ok(())
    })?;
    let mut found = edges.finish();
    suspect::reference(&velocity, &reference, &found.edges)?;
    if options.delay != 0.0 {
        // Turns are counted in the clock of the velocity.
        found.edges.iter_mut().for_each(|edge| *edge += options.delay * rate);
        found.edges.retain(|edge| *edge >= 0.0 && *edge <= frames.saturating_sub(1) as f64);
    }
    let turns = Turns::new(&found.edges, options.pulses_per_turn)?;
    let mut pass = Pass::new(options, rate, &turns.turns, &velocity, still.is_some())?;
    let mut excerpt = Excerpt::new(&turns.turns, options.delay * rate);
    channels.play(&mut |block| {
        scale(block.first().copied().unwrap_or_default(), factor, &mut scaled);
        excerpt.push(&scaled, block.get(1).copied().unwrap_or_default());
        pass.push(&scaled, each)
    })?;
    let pass = pass.finish(each)?;
    let exposure = if handles.is_empty() { None } else { Some(exposure(&handles, options.hours)?) };
    let edge = found.std(reference.noise());
    Ok(summary::summary(summary::Measured {
        options,
        rate,
        velocity: &velocity,
        reference: &reference,
        found: &found,
        edge,
        turns: &turns,
        pass,
        still,
        exposure,
        excerpt: (excerpt.from, excerpt.velocity, excerpt.reference),
    }))
}

/// The averaged spectrum of a record without motion, from the blocks of its velocity channel alone.
///
/// # Errors
/// If it cannot be read.
pub fn still(channels: &mut dyn Channels, options: &DrillOptions) -> Result<Stream> {
    let factor = options.sensitivity * options.beam.factor();
    let (mut spectrum, mut scaled) = (floor::averages(), Vec::new());
    channels.play(&mut |block| {
        scale(block.first().copied().unwrap_or_default(), factor, &mut scaled);
        scaled.retain(|v| v.is_finite());
        spectrum.push(&scaled);
        Ok(())
    })?;
    Ok(spectrum)
}

fn scale(values: &[f64], factor: f64, scaled: &mut Vec<f64>) {
    scaled.clear();
    scaled.extend(values.iter().map(|v| factor * v));
}

/// Levels of the reference, once both channels are what they must be.
fn check(velocity: &Survey, reference: &Survey, same: bool, options: &DrillOptions) -> Result<(f64, f64)> {
    let Some((low, high)) = velocity.range() else {
        return Err(Error::refused("the velocity channel holds no value"));
    };
    if same {
        return Err(Error::refused("velocity and reference are the same channel")
            .hint("name two channels with --velocity and --reference; `vibro info` lists them"));
    }
    if low == high {
        return Err(Error::refused(format!("the velocity is constant, {low} m/s: the laser saw nothing")));
    }
    let Some((low, high)) = reference.levels() else {
        let what = reference.range().map_or("without a value".to_owned(), |(v, _)| format!("constant, {v}"));
        return Err(Error::refused(format!("no edge: the reference channel is {what}")));
    };
    match options.level {
        None => Ok((low, high)),
        // The level stands in the middle; the nearer of both levels gives the height.
        Some(level) if level > low && level < high => {
            let half = (level - low).min(high - level);
            Ok((level - half, level + half))
        }
        Some(level) => Err(Error::refused(format!(
            "the reference lies between {low:.4} and {high:.4}: it does not cross the level {level}"
        ))),
    }
}

/// A few turns of the middle of a record, to be drawn in the clock of the velocity.
struct Excerpt {
    at: usize,
    from: usize,
    to: usize,
    /// Samples by which the reference is earlier than the velocity.
    delay: isize,
    velocity: Vec<f64>,
    reference: Vec<f64>,
}

/// Turns that are drawn.
const DRAWN: usize = 3;

impl Excerpt {
    fn new(turns: &[Turn], delay: f64) -> Excerpt {
        let first = turns.len().saturating_sub(DRAWN) / 2;
        let shown = turns.get(first..(first + DRAWN).min(turns.len())).unwrap_or(&[]);
        let from = shown.first().map_or(0, |t| t.start as usize);
        let to = shown.last().map_or(0, |t| t.end as usize + 1).min(from + EXCERPT);
        let delay = delay.round() as isize;
        // What would lie before or behind the record is not there.
        let velocity = Vec::new();
        Excerpt { at: 0, from, to, delay, velocity, reference: vec![f64::NAN; to - from] }
    }

    fn push(&mut self, velocity: &[f64], reference: &[f64]) {
        let (from, to) = (self.from.saturating_sub(self.at), self.to.saturating_sub(self.at));
        self.velocity.extend(&velocity[from.min(velocity.len())..to.min(velocity.len())]);
        // Sample i of the reference belongs to sample i + delay of the velocity.
        let first = self.from.saturating_add_signed(self.delay.saturating_neg()).max(self.at);
        for (i, v) in (self.at..).zip(reference).skip(first - self.at) {
            let place = i.checked_add_signed(self.delay).and_then(|k| k.checked_sub(self.from));
            match place.map(|k| self.reference.get_mut(k)) {
                Some(Some(to)) => *to = *v,
                Some(None) => break,
                None => {}
            }
        }
        self.at += velocity.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_velocity_that_comes_late_keeps_its_phase_where_the_delay_is_stated() {
        let turn = |i: i32| f64::from(i) / 400.0;
        let volts = |late: i32| -> Vec<f64> {
            (0..20_000).map(|i| 0.5 * (-1.0 + 7.0 * (turn(i - late) + 0.4).rem_euclid(1.0))).collect()
        };
        let pulse: Vec<f64> = (0..20_000).map(|i| if turn(i).fract() < 0.1 { 5.0 } else { 0.0 }).collect();
        let found = |late: i32, delay: f64| {
            let values = volts(late);
            let beam = Beam::new(0.0, From::Axis).unwrap();
            let options = DrillOptions { delay, ..DrillOptions::new(2.0, beam, 1, Edge::Rising) };
            let mut channels = Slices { rate: 20_000.0, channels: vec![&values, &pulse] };
            let found = drill(&mut channels, &options, None).unwrap();
            // The edge that begins the turns drawn, at half the height of the pulse, lies on their first samples.
            assert!(found.excerpt_reference.len() == found.excerpt.len() && found.excerpt.len() > 1200);
            let edge = found.excerpt_reference.iter().position(|v| *v > 2.5);
            assert!(edge.is_some_and(|i| i <= 1), "{edge:?} with a delay of {delay} s");
            found.impacts[5].phase
        };
        // Five of 400 samples a turn.
        let (right, late) = (found(0, 0.0), found(5, 0.0));
        assert!((late - right - 0.0125).abs() < 1e-9, "{right} {late}");
        assert!((found(5, 5.0 / 20_000.0) - right).abs() < 1e-9);
    }
}
