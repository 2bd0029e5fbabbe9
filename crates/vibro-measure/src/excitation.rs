//! The excitation frequency of each step of a sweep, from its force spectrum, as the thesis' script sineswpf
//! finds it.

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
    /// Standard uncertainty of the frequency in Hz; `None` if it is not known, for example near another line
    /// that shifts this one.
    pub std: Option<f64>,
    /// Force amplitude in N; `None` where the frequency was given.
    pub force: Option<f64>,
    /// Its standard uncertainty in N.
    pub force_std: Option<f64>,
}

/// Least height of the largest line over the noise around it, to be the excitation.
const ABOVE_FLOOR: f64 = 8.0;

/// Excitation of every step, in the order of the sweep.
///
/// The largest line of the force spectrum, interpolated between lines. 0 Hz, the lines beside it and lines
/// below `fmin` (Hz) are skipped, so an offset of the force does no harm.
///
/// # Errors
/// If a force spectrum is zero, has no line above its noise, or has its largest line at the end of the base
/// band.
pub fn excitations(sweep: &Sweep, fmin: f64) -> Result<Vec<Excitation>> {
    each(sweep, fmin)?.into_iter().collect()
}

/// As [`excitations`], each step with its own error.
///
/// # Errors
/// If the lines are not evenly spaced or end below `fmin`.
pub(crate) fn each(sweep: &Sweep, fmin: f64) -> Result<Vec<Result<Excitation>>> {
    let df =
        sweep.line_width().ok_or_else(|| Error::refused("the lines of the sweep are not evenly spaced"))?;
    let (start, last) = (sweep.axis.start(), sweep.axis.at(sweep.axis.len().saturating_sub(1)));
    if fmin >= last {
        let found = format!("a cut-off of {fmin} Hz, above the last line at {last} Hz");
        return Err(Error::usage(found, "a cut-off below the last line").setting("fmin"));
    }
    let first = ((fmin - start) / df).ceil().max(0.0) as usize;
    let one = |point: &SweepPoint| {
        let file = point.name();
        if let Some(frequency) = point.given {
            // The hand-over file rounds to four decimals: a uniform error of ±5e-5 Hz.
            let std = Some(5e-5 / f64::sqrt(3.0));
            return Ok(Excitation { file, frequency, std, force: None, force_std: None });
        }
        let peak = largest(&point.force.magnitudes(), point.response.window, first).map_err(|why| {
            let place = Place::file(point.force_path.clone().unwrap_or_default());
            Error::input(place, why, "one line above the noise: the excitation")
                .hint("check the force channel and that the shaker ran; else take the point out of the list")
        })?;
        Ok(Excitation {
            file,
            frequency: start + peak.position * df,
            std: peak.position_std.map(|s| s * df),
            force: Some(peak.amplitude),
            force_std: peak.amplitude_std,
        })
    };
    Ok(sweep.points.iter().map(one).collect())
}

/// The largest local maximum from line `first` on, interpolated. Lines that an offset spreads beside line 0
/// are skipped.
fn largest(force: &[f64], window: Option<Window>, first: usize) -> std::result::Result<SubLine, String> {
    // The main lobe of an offset is as wide as the window has terms; an unknown window counts as the widest.
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
    // The lines of an offset end with its main lobe. A higher line here belongs to a sine nearer to 0 Hz,
    // unless a cut-off excludes that sine.
    if !cut && force[first] > force[k] {
        return Err(format!(
            "the lines below line {first}, where a sine cannot be told from an offset, are higher than any above"
        ));
    }
    if k + 2 >= n {
        let which = if k + 1 == n { "last one" } else { "last but one" };
        let may = "the excitation may lie above the base band, or its image moves it";
        return Err(format!("the largest line of the force is the {which}: {may}"));
    }
    let floor = noise::around(force, k, noise::REACH, window);
    if floor.is_some_and(|floor| force[k] < ABOVE_FLOOR * floor) {
        let highest = quantity(force[k], "N", 3);
        return Err(format!("no line of the force stands out of its noise (largest {highest})"));
    }
    let found = interpolate(force, k, window, floor)
        .ok_or_else(|| "the lines beside the largest are missing".to_owned())?;
    Ok(bent(found, force, k, window.zip(floor)))
}

/// Largest deviation from the line shape of a sine that noise explains, in standard deviations of its real
/// or imaginary part.
const BY_NOISE: f64 = 3.5;
/// Largest deviation from the shape of a sine, over its amplitude, whose effect can be stated as an
/// uncertainty.
const SMALL: f64 = 0.02;

/// Widens the uncertainty of a line around `k` that deviates from the shape of one steady sine by more than
/// noise, for example because it drifts or another sine is near. A deviation of x times the height shifts
/// the position by about x lines and the amplitude by about x. Where it is large, no uncertainty is stated.
pub(crate) fn bent(line: SubLine, magnitudes: &[f64], k: usize, seen: Option<(Window, f64)>) -> SubLine {
    let off = seen.and_then(|(window, floor)| {
        deviation(magnitudes, k, 2, window).filter(|off| *off > BY_NOISE * floor)
    });
    let Some(off) = off else { return line };
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
        // A cut-off above that sine selects the other line.
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
                // An offset falls on a line, so no window has side lobes on the others: only rounding of the
                // shape remains.
                assert!((found.position - 110.4).abs() < 1e-9, "{window:?} {offset}: {}", found.position);
            }
        }
    }

    /// A noise floor with ripple, a sine, and another of half its height `apart` lines away, in phase.
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

    #[test]
    fn what_is_no_excitation_is_refused() {
        assert!(largest(&[0.0; 401], Some(Window::Hann), 0).unwrap_err().contains("zero"));
        let noise: Vec<f64> = (0..401).map(|k| 1.0 + f64::from((k * 37) % 11) * 0.1).collect();
        assert!(largest(&noise, Some(Window::Hann), 0).unwrap_err().contains("noise"));
        assert!(largest(&sine(400.0, 0.0), Some(Window::Hann), 0).unwrap_err().contains("base band"));
        assert!(largest(&[1.0; 3], Some(Window::Hann), 0).unwrap_err().contains("too few"));
    }
}
