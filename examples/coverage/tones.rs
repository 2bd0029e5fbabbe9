//! Random sums of sines in coloured noise, to check how often the stated uncertainties of frequency,
//! amplitude and phase of each sine cover the truth.

use super::disturbance::{Mix, clip, peak};
use super::record::{Answer, Kind, Record, pairs};
use super::trace;
use std::f64::consts::{PI, TAU};
use vibroimpact::measure::tones;

/// The kinds of records drawn here.
pub const KINDS: &[Kind] = &[Kind {
    name: "tones",
    ranges: "1 to 5 sines of 3 lines to 0.45 of the sampling rate, 1.5 lines apart at least, amplitudes 0.03 to 1, 1000 to 8000 samples; \
             white noise 0.0003 to 0.1 of the peak, 1/f noise 0.3 to 10 times that, hum to 2 %, 12 bits; a fifth clipped at 0.6 to 0.99 of the peak",
    every: 1,
    draw,
}];

/// Draws the sum of one to five sines at least 1.5 lines apart, disturbed and in some records clipped.
/// Compares each true sine with the nearest one found within a line.
fn draw(mix: &mut Mix) -> Record {
    let (rate, n) = (1000.0, mix.log(1000.0, 8000.0) as usize);
    let line = rate / n as f64;
    let count = mix.random.between(1.0, 6.0) as usize;
    mix.note("sines", count as f64);
    let mut frequencies: Vec<f64> = Vec::new();
    while frequencies.len() < count {
        let f = mix.log(3.0 * line, 0.45 * rate);
        if frequencies.iter().all(|g| (f - g).abs() > 1.5 * line) {
            frequencies.push(f);
        }
    }
    // Amplitude and phase of each sine.
    let sines: Vec<[f64; 2]> =
        frequencies.iter().map(|_| [mix.log(0.03, 1.0), mix.random.between(-PI, PI)]).collect();
    let mut values: Vec<f64> = (0..n)
        .map(|i| {
            let t = i as f64 / rate;
            frequencies.iter().zip(&sines).map(|(f, [a, phase])| a * (TAU * f * t + phase).cos()).sum()
        })
        .collect();
    let distances = frequencies.iter().flat_map(|f| frequencies.iter().map(move |g| (f - g).abs() / line));
    let smallest = distances.filter(|distance| *distance > 0.0).fold(1e3, f64::min);
    mix.note("least distance in lines", smallest);
    let peak = peak(&values);
    mix.spoil(&mut values, rate, peak, (3e-4, 0.1));
    let level = mix.some(0.2, "clipped at", 0.6, 0.99);
    if level > 0.0 {
        clip(&mut values, level * peak);
    }
    let found = tones::tones(&trace("m/s", rate, values), count).map_or(Vec::new(), |t| t.tones);
    let paired =
        pairs(&frequencies, &vec![line; count], &found.iter().map(|t| t.frequency.value).collect::<Vec<_>>());
    let mut record = Record::default();
    for (i, [amplitude, phase]) in sines.into_iter().enumerate() {
        let tone = paired[i].map(|k| &found[k]);
        record.answers.push(Answer::new("frequency", frequencies[i], tone.map(|t| &t.frequency)));
        record.answers.push(Answer::new("amplitude", amplitude, tone.map(|t| &t.amplitude)));
        // A phase is known except for whole turns, so the truth is moved by whole turns next to the answer.
        let turns = tone.map_or(0.0, |t| ((t.phase.value - phase) / TAU).round());
        record.answers.push(Answer::new("phase", phase + TAU * turns, tone.map(|t| &t.phase)));
    }
    record.invented =
        (0..found.len()).filter(|k| !paired.contains(&Some(*k)) && found[*k].frequency.std.is_some()).count();
    record
}
