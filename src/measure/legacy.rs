//! What the thesis' scripts sineswpf, sinesw and sinesw3 gave, mistakes included, so that old results can be checked.
//!
//! They are wrong in known ways: the largest line may be 0 Hz, frequencies and amplitudes are read on the line, and the
//! first and last search windows are open on one side. Use [`super::excitation`], [`super::waterfall`] and
//! [`super::response`] for answers.

use crate::error::{Error, Place, Result};
use crate::record::Sweep;
use std::fmt::Write as _;
use std::path::Path;

/// sineswpf: the frequency of the largest line of each force spectrum, 0 Hz included; hand-over frequencies as given.
///
/// # Errors
/// Where two lines are equally large the script stops, and so does this.
pub fn excitation(sweep: &Sweep) -> Result<Vec<f64>> {
    sweep
        .points
        .iter()
        .map(|point| {
            if let Some(given) = point.given {
                return Ok(given);
            }
            let place = || Place::file(point.force_path.clone().unwrap_or_default());
            let largest = point.force.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let mut at = (0..point.force.len()).filter(|k| point.force[*k] == largest);
            match (at.next(), at.next()) {
                (Some(k), None) => Ok(sweep.axis.at(k)),
                (Some(a), Some(b)) => Err(Error::input(
                    place(),
                    format!("lines {a} and {b} of the force are equally large: sineswpf stops here"),
                    "one largest line",
                )
                .hint("leave out --legacy: the frequency between the two lines is found then")),
                _ => Err(Error::input(place(), "no force spectrum", "one a point")),
            }
        })
        .collect()
}

/// Frequencies as the hand-over file keeps them: four decimals.
pub fn rounded(excitation: &[f64]) -> Vec<f64> {
    excitation.iter().map(|f| format!("{f:7.4}").trim().parse().unwrap_or(*f)).collect()
}

/// Length of a name in a hand-over file of the script.
const NAME: usize = 11;

/// The hand-over file: number of points, lines, base band, frequencies, then all names without a separator, as the script
/// wrote them; names that are not 11 characters long stand one a line.
pub fn hand_over<P: AsRef<Path>>(lines: usize, base_band: f64, excitation: &[f64], names: &[P]) -> String {
    let mut text = String::new();
    for number in [excitation.len() as f64, lines as f64, base_band].iter().chain(excitation) {
        let _ = writeln!(text, "{number:7.4}");
    }
    let names: Vec<String> = names.iter().map(|n| n.as_ref().to_string_lossy().into_owned()).collect();
    if names.iter().all(|n| n.chars().count() == NAME) {
        text.extend(names);
    } else {
        text += &names.join("\n");
        text.push('\n');
    }
    text
}

/// sinesw: all stored magnitudes, one row a point; nothing is integrated or cut off.
pub fn waterfall(sweep: &Sweep) -> Vec<Vec<f64>> {
    sweep.points.iter().map(|p| p.response.values.magnitudes()).collect()
}

/// sinesw3: for each point the hand-over frequency and the largest stored line between the midpoints to its neighbours,
/// the first window open downwards and the last upwards.
///
/// # Errors
/// As [`excitation`].
pub fn response(sweep: &Sweep) -> Result<Vec<(f64, f64)>> {
    let x = rounded(&excitation(sweep)?);
    Ok((0..x.len())
        .map(|i| {
            let low = if i == 0 { f64::NEG_INFINITY } else { f64::midpoint(x[i - 1], x[i]) };
            let high = x.get(i + 1).map_or(f64::INFINITY, |next| f64::midpoint(x[i], *next));
            let spectrum = &sweep.points[i].response.values;
            let largest = (0..spectrum.len())
                .filter(|k| (low..=high).contains(&sweep.axis.at(*k)))
                .map(|k| spectrum.magnitude(k))
                .fold(f64::NAN, f64::max);
            (x[i], largest)
        })
        .collect())
}
