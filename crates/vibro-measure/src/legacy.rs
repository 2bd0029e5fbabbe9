//! Results of the thesis' scripts sineswpf, sinesw, sinesw3 and timeav, mistakes included, to check old
//! results.
//!
//! They are wrong in known ways: the largest line may be 0 Hz, frequencies and amplitudes are read on the
//! line, and the first and last search windows are open on one side; timeav takes the mean interval of all
//! peaks higher than a quarter of one early peak. Use [`super::excitation`], [`super::waterfall`],
//! [`super::response`] and [`super::impacts`] instead.

use std::fmt::Write as _;
use std::path::Path;
use vibro_record::{Error, Place, Result, Sweep, SweepPoint, Trace};

/// sineswpf: the frequency of the largest line of each force spectrum, 0 Hz included; hand-over frequencies
/// as given.
///
/// # Errors
/// Where two lines are equally large: there the script stops, too.
pub fn excitation(sweep: &Sweep) -> Result<Vec<f64>> {
    let one = |point: &SweepPoint| {
        if let Some(given) = point.given {
            return Ok(given);
        }
        let place = Place::file(point.force_path.clone().unwrap_or_default());
        let force = point.force.magnitudes();
        let largest = force.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut at = (0..force.len()).filter(|k| force[*k] == largest);
        match (at.next(), at.next()) {
            (Some(k), None) => Ok(sweep.axis.at(k)),
            (Some(a), Some(b)) => {
                let found = format!("lines {a} and {b} of the force are equally large: sineswpf stops here");
                let hint = "without `legacy` the frequency between the two lines is found";
                Err(Error::input(place, found, "one largest line").hint(hint))
            }
            _ => Err(Error::input(place, "no force spectrum", "one a point")),
        }
    };
    sweep.points.iter().map(one).collect()
}

/// Frequencies as the hand-over file keeps them: four decimals.
pub fn rounded(excitation: &[f64]) -> Vec<f64> {
    excitation.iter().map(|f| format!("{f:7.4}").trim().parse().unwrap_or(*f)).collect()
}

/// Length of a name in a hand-over file of the script, in characters.
const NAME: usize = 11;

/// The hand-over file: number of points, lines, base band, frequencies, then all names without a separator,
/// as the script wrote them; names that are not 11 characters long are written one a line.
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

/// sinesw3: for each point the hand-over frequency and the largest stored line between the midpoints to its
/// neighbours, the first window open downwards and the last upwards.
///
/// # Errors
/// As [`excitation`].
pub fn response(sweep: &Sweep) -> Result<Vec<(f64, f64)>> {
    let x = rounded(&excitation(sweep)?);
    let largest = |i: usize| {
        let low = if i == 0 { f64::NEG_INFINITY } else { f64::midpoint(x[i - 1], x[i]) };
        let high = x.get(i + 1).map_or(f64::INFINITY, |next| f64::midpoint(x[i], *next));
        let spectrum = &sweep.points[i].response.values;
        let near = (0..spectrum.len()).filter(|k| (low..=high).contains(&sweep.axis.at(*k)));
        near.map(|k| spectrum.magnitude(k)).fold(f64::NAN, f64::max)
    };
    Ok((0..x.len()).map(|i| (x[i], largest(i))).collect())
}

/// Output of timeav for a contact trace.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactTimes {
    /// Local maxima that rise from above 0.
    pub maxima: usize,
    /// Times in s of the maxima above a quarter of the first big one; the first sample counts as one sampling
    /// interval, not 0.
    pub times: Vec<f64>,
    /// (last − first)/(k − 1) in s; NaN of one peak, as 0/0.
    pub interval: f64,
    /// Its inverse in Hz.
    pub frequency: f64,
}

/// timeav: local maxima that rise from above 0 and are higher than a quarter of the first big one.
///
/// The script's own test of "big" is not kept with its outputs; the larger of the first two maxima reproduces
/// all of them.
///
/// # Errors
/// Where the file has a header, the trace no sampling rate or no maximum: the script stopped there.
pub fn contact_times(trace: &Trace) -> Result<ContactTimes> {
    if let Some((key, value)) = trace.meta.notes.first() {
        let why = format!(
            "timeav stops at a file with a header (\"{}\"): it finds no number in the first line",
            format!("{key} {value}").trim()
        );
        return Err(Error::refused(why).hint("without `legacy` header lines are skipped"));
    }
    let rate = trace.sampling_rate()?;
    let s = &trace.values;
    let rises = |i: &usize| s[i - 1] > 0.0 && s[*i] > s[i - 1] && s[*i] > s[i + 1];
    let maxima: Vec<(usize, f64)> = (1..s.len().saturating_sub(1)).filter(rises).map(|i| (i, s[i])).collect();
    let big = maxima.iter().take(2).map(|m| m.1).fold(f64::NEG_INFINITY, f64::max);
    // Octave counts from 1, and the script took the count for the time.
    let times: Vec<f64> =
        maxima.iter().filter(|m| m.1 > 0.25 * big).map(|m| (m.0 + 1) as f64 / rate).collect();
    let (Some(first), Some(last)) = (times.first(), times.last()) else {
        return Err(Error::refused("timeav stops at a trace without a maximum that rises from above 0"));
    };
    let interval = (last - first) / (times.len() - 1) as f64;
    Ok(ContactTimes { maxima: maxima.len(), interval, frequency: 1.0 / interval, times })
}
