//! The excitation frequency of each step of a sweep, from its force spectrum (the job of the thesis' sineswpf).

use super::folded::folded;
use super::line::{SubLine, deviation, interpolate};
use super::noise;
use serde::Serialize;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Place, Result, Sweep, SweepPoint, Window};

/// Excitation of one step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Excitation {
    /// Force file, or response file where the frequency was given.
    pub file: String,
    /// Frequency in Hz.
    pub frequency: f64,
    /// Its standard uncertainty in Hz; `None` where it is not known, as where another line near by bends this one, or where its own harmonics
    /// may fold upon it unseen.
    pub std: Option<f64>,
    /// Force amplitude in N; `None` where the frequency was given.
    pub force: Option<f64>,
    /// Its standard uncertainty in N.
    pub force_std: Option<f64>,
}

/// How far the largest line must stand above the median of its neighbourhood to be taken for the excitation.
const ABOVE_FLOOR: f64 = 8.0;

/// Excitation of every step, in the order of the sweep.
///
/// The largest line of the force spectrum, interpolated below the line distance; 0 Hz, the line beside it and lines
/// below `fmin` (Hz) are skipped, so an offset of the force does no harm.
///
/// # Errors
/// If a force spectrum is zero, holds no line above its noise, or has its largest line at the end of the base band.
pub fn excitations(sweep: &Sweep, fmin: f64) -> Result<Vec<Excitation>> {
    let df =
        sweep.line_width().ok_or_else(|| Error::refused("the lines of the sweep are not evenly spaced"))?;
    let last = sweep.axis.at(sweep.axis.len().saturating_sub(1));
    if fmin >= last {
        return Err(Error::usage(
            format!("a cut-off of {fmin} Hz, above the last line at {last} Hz"),
            "a cut-off below the last line",
        )
        .setting("fmin"));
    }
    sweep.points.iter().map(|point| one(point, sweep.axis.start(), df, fmin, last)).collect()
}

fn one(point: &SweepPoint, start: f64, df: f64, fmin: f64, last: f64) -> Result<Excitation> {
    if let Some(frequency) = point.given {
        if frequency > last {
            return Err(Error::input(
                Place::file(&point.response_path),
                format!("an excitation frequency of {frequency} Hz is given for it"),
                format!("one below the last line, {last} Hz"),
            ));
        }
        // The hand-over file rounds to four decimals: a uniform error of ±5e-5 Hz.
        let std = Some(5e-5 / f64::sqrt(3.0));
        return Ok(Excitation { file: point.name(), frequency, std, force: None, force_std: None });
    }
    let path = point.force_path.clone().unwrap_or_default();
    let peak = largest(&point.force, point.response.window, ((fmin - start) / df).ceil().max(0.0) as usize)
        .map_err(|why| {
        Error::input(Place::file(path), why, "one line above the noise: the excitation")
            .hint("check the force channel and that the shaker ran; else take the point out of the list")
    })?;
    Ok(Excitation {
        file: point.name(),
        frequency: start + peak.position * df,
        std: peak.position_std.map(|s| s * df),
        force: Some(peak.amplitude),
        force_std: peak.amplitude_std,
    })
}

/// The largest local maximum from `first` on, interpolated; what an offset spreads beside line 0 is passed over.
fn largest(force: &[f64], window: Option<Window>, first: usize) -> std::result::Result<SubLine, String> {
    // The main lobe of an offset is as wide as the window has terms; of an unknown window the widest is feared.
    let lobe = window.unwrap_or(Window::FlatTop).coefficients().len() + 1;
    let (cut, first) = (first > lobe, first.max(lobe));
    let n = force.len();
    if n < first.saturating_add(3) {
        return Err(format!("the force spectrum has {n} lines, too few above line {first}"));
    }
    let rises = |k: &usize| force[*k] >= force[k - 1] && (k + 1 == n || force[*k] >= force[k + 1]);
    let peak = (first..n).filter(rises).max_by(|a, b| force[*a].total_cmp(&force[*b]));
    let Some(k) = peak else { return Err("no line of the force stands above its neighbours".into()) };
    if force[k] == 0.0 {
        return Err("the force spectrum is zero".into());
    }
    // The lines of an offset end with its lobe, where nobody has cut off what is larger.
    if !cut && force[first] > force[k] {
        return Err(format!(
            "the lines below line {first}, where a sine cannot be parted from an offset, are higher than any above"
        ));
    }
    if k + 2 >= n {
        let which = if k + 1 == n { "last one" } else { "last but one" };
        return Err(format!(
            "the largest line of the force is the {which}: the excitation may lie above the base band, or its image moves it"
        ));
    }
    let floor = noise::around(force, k, window);
    if let Some(floor) = floor
        && force[k] < ABOVE_FLOOR * floor
    {
        return Err(format!(
            "no line of the force stands out of its noise (largest {})",
            quantity(force[k], "N", 3)
        ));
    }
    let found = interpolate(force, k, window, floor)
        .ok_or_else(|| "the lines beside the largest are missing".to_owned())?;
    let (Some(window), Some(floor)) = (window, floor) else { return Ok(found) };
    let off = deviation(force, k, 2, window).filter(|off| *off > BY_NOISE * floor).unwrap_or(0.0);
    let hidden = folded(force, found.position, window, floor);
    Ok(if off + hidden > 0.0 { bent(found, off + hidden) } else { found })
}

/// Lines may differ from the shape of a sine by so many standard deviations of a component of the noise.
const BY_NOISE: f64 = 5.0;
/// Beyond this part of the amplitude, what stands beside a sine is no small error.
const SMALL: f64 = 0.02;

/// A line that has not the shape of one sine, by more than noise, or upon which harmonics fold: what is off tilts the three lines and lifts
/// them by its part of their height, about; where that is much, how far they are off is not known.
fn bent(line: SubLine, off: f64) -> SubLine {
    let known =
        |std: Option<f64>, by: f64| std.filter(|_| off <= SMALL * line.amplitude).map(|s| s.hypot(by));
    SubLine {
        position_std: known(line.position_std, off / line.amplitude),
        amplitude_std: known(line.amplitude_std, off),
        ..line
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_signal::window::line_shape;

    fn sine(position: f64, offset: f64) -> Vec<f64> {
        (0..401)
            .map(|k| {
                let k = f64::from(k);
                line_shape(Window::Hann, k - position).abs() + offset * line_shape(Window::Hann, k).abs()
            })
            .collect()
    }

    #[test]
    fn a_line_on_the_flank_of_a_sine_too_near_to_zero_is_not_the_excitation() {
        let mut force: Vec<f64> =
            (0..401).map(|k| line_shape(Window::Hann, f64::from(k) - 0.5).abs()).collect();
        force[6] = 1.5 * force[5];
        assert!(force[6] < force[3]);
        assert!(largest(&force, Some(Window::Hann), 0).unwrap_err().contains("below line 3"));
        // Whoever has cut that off wants the other.
        assert!(largest(&force, Some(Window::Hann), 5).is_ok());
    }

    #[test]
    fn a_line_before_the_last_may_be_moved_by_its_image() {
        for (position, last) in [(399.0, "last but one"), (399.9, "last one")] {
            let image = |k: f64| line_shape(Window::Hann, k - (800.0 - position)).abs();
            let force: Vec<f64> = (0..401)
                .map(f64::from)
                .map(|k| line_shape(Window::Hann, k - position).abs() + 0.3 * image(k))
                .collect();
            let said = largest(&force, Some(Window::Hann), 0).unwrap_err();
            assert!(said.contains(last) && said.contains("above the base band"), "{position}: {said}");
        }
        assert!(largest(&sine(398.3, 0.0), Some(Window::Hann), 0).is_ok());
    }

    #[test]
    fn an_offset_larger_than_the_sine_does_no_harm() {
        for window in Window::ALL {
            for offset in [2.0, 20.0, 150.0] {
                let lines: Vec<f64> = (0..401)
                    .map(|k| {
                        let k = f64::from(k);
                        line_shape(window, k - 110.4).abs() + offset * line_shape(window, k).abs()
                    })
                    .collect();
                let found = largest(&lines, Some(window), 0).unwrap();
                // An offset falls on a line, where no window has side lobes: only rounding of the shape is left.
                assert!((found.position - 110.4).abs() < 1e-9, "{window:?} {offset}: {}", found.position);
            }
        }
    }

    /// Lines of the ripple of a floor, a sine, and another of half its height `apart` lines beside it, in phase.
    fn pair(apart: f64) -> Vec<f64> {
        (0..401)
            .map(|k| {
                let k = f64::from(k);
                let sines =
                    line_shape(Window::Hann, k - 110.4) + 0.5 * line_shape(Window::Hann, k - 110.4 - apart);
                sines.abs() + 1e-5 * (2.0 + (k * k * 0.7).sin())
            })
            .collect()
    }

    #[test]
    fn what_stands_beside_the_excitation_is_in_its_uncertainty_or_leaves_none() {
        for apart in [1.0, 2.0, 3.0] {
            let found = largest(&pair(apart), Some(Window::Hann), 0).unwrap();
            assert_eq!((found.position_std, found.amplitude_std), (None, None), "{apart}: {found:?}");
        }
        let found = largest(&pair(6.0), Some(Window::Hann), 0).unwrap();
        assert!((found.position - 110.4).abs() < 3.0 * found.position_std.unwrap(), "{found:?}");
        assert!(found.position_std.unwrap() < 0.02, "{found:?}");
        let alone = largest(&pair(200.0), Some(Window::Hann), 0).unwrap();
        assert!(alone.position_std.unwrap() < 1e-4, "{alone:?}");
    }

    /// Harmonics of a clipped sine fold anywhere, and onto the sine itself in some records of many.
    #[test]
    fn a_clipped_sine_is_off_by_no_more_than_its_uncertainty_allows() {
        use std::f64::consts::TAU;
        use vibro_math::Noise;
        use vibro_record::units::Unit;
        use vibro_record::{Axis, Meta, Scaling, Trace};
        use vibro_signal::spectrum;
        let n = 1024;
        for level in [0.5, 0.8, 10.0] {
            let (mut stated, mut worst, mut without) = (0, (0.0, 0), Vec::new());
            for seed in 0..400 {
                let mut noise = Noise::new(11_000 + seed);
                let (place, phase) = (noise.between(10.0, 502.0), noise.between(0.0, TAU));
                let sine = |i: i32| (TAU * place * f64::from(i) / f64::from(n) + phase).cos();
                let values =
                    (0..n).map(|i| (sine(i) + 0.007_071 * noise.normal()).clamp(-level, level)).collect();
                let meta = Meta::new("force", Unit::parse("N").unwrap());
                let trace = Trace { meta, axis: Axis::time(0.0, 1e-3, 1024), values };
                let lines = spectrum::plain(&trace, Window::Hann, Scaling::Peak, false).unwrap();
                let found = largest(&lines.values.magnitudes(), Some(Window::Hann), 0).unwrap();
                let Some(std) = found.position_std else {
                    without.push(place);
                    continue;
                };
                stated += 1;
                let off = (found.position - place).abs() / std;
                if off > worst.0 {
                    worst = (off, seed);
                }
                // Of normal errors 6e-5 lie beyond four standard uncertainties; the fixed seeds meet none.
                assert!(
                    off < 4.0,
                    "clipped at {level}, seed {seed}, {place:.3}: {off:.2} standard uncertainties"
                );
            }
            println!(
                "clipped at {level}: seeds 0 to 399, {stated} state an uncertainty, the worst {worst:?}, without one {without:.1?}"
            );
            // Withheld where what may fold is more than 2 %, or cannot be seen: that of what is not clipped, too, within two lines of a third or a
            // quarter of the rate.
            assert!(
                stated > 350 && (level < 1.0 || stated > 385),
                "{level}: {stated}, without one {without:.1?}"
            );
        }
    }

    #[test]
    fn what_is_no_excitation_is_refused() {
        assert!(largest(&[0.0; 401], Some(Window::Hann), 0).unwrap_err().contains("zero"));
        let noise: Vec<f64> = (0..401).map(|k| 1.0 + f64::from((k * 37) % 11) * 0.1).collect();
        assert!(largest(&noise, Some(Window::Hann), 0).unwrap_err().contains("noise"));
        assert!(largest(&sine(400.0, 0.0), Some(Window::Hann), 0).unwrap_err().contains("base band"));
        assert!(largest(&[1.0; 3], Some(Window::Hann), 0).unwrap_err().contains("too few"));
    }
}
