//! Hammer drills: a laser on the striker or the bit, and a pulse once a turn of the crank.
//!
//! The velocity is what the laser shows times its sensitivity over cos α, α the angle between beam and motion. Edges of the
//! reference cut the record into turns; phases are parts of a turn after the edge, which for a pulse at the upper end of
//! the piston's stroke is the phase after top dead centre. The record is read three times block by block, so that
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
mod edges;
mod excerpt;
mod faults;
mod findings;
mod fit_noise;
mod floor;
mod groups;
mod impact;
mod jumps;
mod lack_of_fit;
mod motion;
mod options;
mod parabola;
mod pass;
mod reference;
mod restitution;
mod result;
mod running;
mod smoothing;
mod summary;
mod survey;
mod turns;

pub use average::Cycle;
pub use beam::{Beam, From};
pub use channels::{Channels, Slices};
pub use edges::Edge;
pub(crate) use edges::{Edges, Found};
use excerpt::Excerpt;
pub use faults::FaultCount;
pub use floor::NoiseFloor;
pub use groups::Group;
pub use impact::Impact;
pub use motion::Bandwidth;
pub use options::DrillOptions;
pub use result::{BeamResult, Displacement, Drill, Phases, Pulses};
use running::Running;
pub use smoothing::{Corner, CornerReason, Smoothing, SmoothingKind};
pub(crate) use survey::Survey;
pub(crate) use turns::{Numbered, Turns};

use super::exposure::Handle;
use pass::Pass;
use summary::Measured;
use vibro_record::{Error, Result};
use vibro_signal::welch::Stream;

/// Measures the turns and impacts of a drill; `still` is a record of the same velocity channel without motion, in m/s.
///
/// # Errors
/// If the parameters cannot be; if the velocity is constant or missing; if velocity and reference are the same or look swapped; if the
/// reference has not two levels nor even edges, or no whole turn between its edges; if a channel cannot be read; if a handle allows no
/// exposure.
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
        return Err(
            Error::usage(format!("a sampling rate of {rate} Hz"), "a finite number above 0").setting("rate")
        );
    }
    let surveyed = Surveyed::of(channels, options)?;
    let (low, high) = reference::levels(&surveyed, options)?;
    let mut edges = Edges::new(low, high, options.edge);
    channels.play(&mut |block| {
        edges.push(block.get(1).copied().unwrap_or_default());
        Ok(())
    })?;
    let mut edges = edges.finish();
    reference::check_pulses(&surveyed.velocity, &surveyed.reference, &edges.edges)?;
    let delay = options.delay * rate;
    if delay != 0.0 {
        // Turns are counted in the clock of the velocity.
        let last = surveyed.velocity.samples().saturating_sub(1) as f64;
        edges.edges.iter_mut().for_each(|edge| *edge += delay);
        edges.edges.retain(|edge| (0.0..=last).contains(edge));
    }
    let turns = Turns::new(&edges.edges, options.pulses_per_turn)?;
    let mut pass = Pass::new(options, rate, &turns.whole, &surveyed.velocity, still.is_some())?;
    let mut excerpts = [0.0, delay].map(|delay| Excerpt::new(&turns.whole, delay));
    let mut scaled = Vec::new();
    channels.play(&mut |block| {
        let [velocity, reference, ..] = block else { return Ok(()) };
        scale(velocity, options, &mut scaled);
        excerpts[0].push(&scaled);
        excerpts[1].push(reference);
        pass.push(&scaled, each)
    })?;
    let pass = pass.finish(each)?;
    let (surveyed, edges, turns) = (&surveyed, &edges, &turns);
    summary::summary(Measured { options, rate, surveyed, edges, turns, pass, still, excerpts })
}

/// The averaged spectrum of a record without motion, from the blocks of its velocity channel alone.
///
/// # Errors
/// If it cannot be read.
pub fn still(channels: &mut dyn Channels, options: &DrillOptions) -> Result<Stream> {
    let (mut spectrum, mut scaled) = (floor::averages(), Vec::new());
    channels.play(&mut |block| {
        scale(block.first().copied().unwrap_or_default(), options, &mut scaled);
        scaled.retain(|v| v.is_finite());
        spectrum.push(&scaled);
        Ok(())
    })?;
    Ok(spectrum)
}

/// Velocities of the motion in m/s from the values of their channel.
fn scale(values: &[f64], options: &DrillOptions, scaled: &mut Vec<f64>) {
    let factor = options.sensitivity * options.beam.factor();
    scaled.clear();
    scaled.extend(values.iter().map(|v| factor * v));
}

/// What the first pass shows: what the channels look like, and the vibration of the handle.
struct Surveyed {
    velocity: Survey,
    reference: Survey,
    handles: Vec<Handle>,
    /// Whether both channels hold the same values.
    same: bool,
}

impl Surveyed {
    fn of(channels: &mut dyn Channels, options: &DrillOptions) -> Result<Surveyed> {
        let rate = channels.rate();
        let (velocity, reference) = (Survey::default(), Survey::default());
        let mut all = Surveyed { velocity, reference, handles: Vec::new(), same: true };
        let mut scaled = Vec::new();
        channels.play(&mut |block| {
            let [v, r, axes @ ..] = block else {
                return Err(Error::usage(format!("{} channels", block.len()), "a velocity and a reference"));
            };
            all.same = all.same && v.iter().zip(*r).all(|(a, b)| a == b || (a.is_nan() && b.is_nan()));
            scale(v, options, &mut scaled);
            all.velocity.push(&scaled);
            all.reference.push(r);
            while all.handles.len() < axes.len() {
                all.handles.push(Handle::new(rate)?);
            }
            all.handles.iter_mut().zip(axes).for_each(|(handle, axis)| handle.push(axis));
            Ok(())
        })?;
        Ok(all)
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
