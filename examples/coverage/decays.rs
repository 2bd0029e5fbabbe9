//! Random free decays after a release or a blow, to check how often the stated uncertainties of the fitted
//! modes cover the truth.

use super::disturbance::{Mix, clip, peak};
use super::record::{Answer, Kind, Record, pairs};
use super::trace;
use std::f64::consts::TAU;
use vibroimpact::measure::decay::{DecayOptions, decay};

/// The kinds of records drawn here.
pub const KINDS: &[Kind] = &[
    Kind { name: "decay of one mode", ranges: RANGES, every: 1, draw: |mix| draw(mix, 1) },
    Kind { name: "decay of two modes", ranges: RANGES, every: 1, draw: |mix| draw(mix, 2) },
];

/// Ranges of both kinds, as text for the page.
const RANGES: &str = "ζ 0.002 to 0.1, 8 to 80 samples a period, a record of 2 to 12 time constants, rest or a held position before; second mode \
    1.15 to 4 times as high, 0.1 to 1 times as large; white noise 0.0001 to 0.03 of the peak, 1/f noise 0.3 to 10 times that, hum to 2 %, \
    12 bits; a fifth clipped at 0.4 to 0.95 of the peak";

/// Undamped natural frequency in Hz, damping ratio, amplitude at the release, phase in rad.
struct Mode(f64, f64, f64, f64);

impl Mode {
    /// Motion at `t` seconds after the release.
    fn at(&self, t: f64) -> f64 {
        let Mode(f, zeta, _, phase) = self;
        self.envelope(t) * (TAU * f * (1.0 - zeta * zeta).sqrt() * t + phase).cos()
    }

    /// Amplitude of the motion at `t` seconds after the release.
    fn envelope(&self, t: f64) -> f64 {
        let Mode(f, zeta, amplitude, _) = self;
        amplitude * (-zeta * TAU * f * t).exp()
    }
}

/// Draws the decay of one or two modes, after rest or a held position, disturbed and in some records clipped.
/// Compares the modes that are fitted to it with the true ones.
fn draw(mix: &mut Mix, count: usize) -> Record {
    let first = mix.log(8.0, 400.0);
    let mut modes: Vec<Mode> = Vec::new();
    for k in 0..count {
        let (ratio, amplitude) = if k == 0 { (1.0, 1.0) } else { (mix.log(1.15, 4.0), mix.log(0.1, 1.0)) };
        let zeta = mix.log(0.002, 0.1);
        mix.note(["ζ", "second ζ"][k], zeta);
        mix.note(["frequency", "second frequency"][k], first * ratio);
        // A released mass starts at its largest displacement, a struck one at zero.
        modes.push(Mode(first * ratio, zeta, amplitude, if mix.chance(0.5) { 0.0 } else { -TAU / 4.0 }));
    }
    let highest = first.max(modes[count - 1].0);
    let rate = highest * mix.log(8.0, 80.0);
    let longest_time_constant = modes.iter().map(|m| 1.0 / (m.1 * TAU * m.0)).fold(0.0, f64::max);
    let duration = (longest_time_constant * mix.log(2.0, 12.0)).max(12.0 / first);
    let n = ((duration * rate) as usize).clamp(400, 20_000);
    let release = mix.random.between(0.0, 0.2) * n as f64 / rate;
    let held = if mix.chance(0.5) { modes.iter().map(|m| m.at(0.0)).sum() } else { 0.0 };
    let mut values: Vec<f64> = (0..n)
        .map(|i| i as f64 / rate - release)
        .map(|t| if t < 0.0 { held } else { modes.iter().map(|m| m.at(t)).sum() })
        .collect();
    let peak = peak(&values);
    mix.spoil(&mut values, rate, peak, (1e-4, 0.03));
    let level = mix.some(0.2, "clipped at", 0.4, 0.95);
    if level > 0.0 {
        clip(&mut values, level * peak);
    }
    let Ok(found) = decay(&trace("mm", rate, values), &DecayOptions::default()) else {
        return mode_answers(&modes, |_| None);
    };
    // Largest distance in Hz between a true mode and the fitted mode paired with it: two half-power
    // bandwidths or two lines of the record.
    let limits: Vec<f64> = modes.iter().map(|m| (4.0 * m.1 * m.0).max(2.0 * rate / n as f64)).collect();
    let truths: Vec<f64> = modes.iter().map(|m| m.0).collect();
    let paired = pairs(&truths, &limits, &found.modes.iter().map(|m| m.frequency.value).collect::<Vec<_>>());
    let mut record = mode_answers(&modes, |i| paired[i].map(|k| (&found.modes[k], found.start - release)));
    let is_invented = |k: &usize| !paired.contains(&Some(*k)) && found.modes[*k].frequency.std.is_some();
    record.invented = (0..found.modes.len()).filter(is_invented).count();
    record
}

/// The answers for each true mode: frequency, damping ratio, and amplitude at the start of the fit.
/// `fitted(i)` is the fitted mode and the time in s from the release to that start; `None` if the mode was
/// not found.
fn mode_answers<'a>(
    modes: &[Mode],
    fitted: impl Fn(usize) -> Option<(&'a vibroimpact::measure::decay::DecayMode, f64)>,
) -> Record {
    let mut record = Record::default();
    for (i, mode) in modes.iter().enumerate() {
        let pair = fitted(i);
        record.answers.push(Answer::new("frequency", mode.0, pair.map(|(m, _)| &m.frequency)));
        record.answers.push(Answer::new("damping ratio", mode.1, pair.map(|(m, _)| &m.zeta)));
        let amplitude = mode.envelope(pair.map_or(0.0, |(_, t)| t));
        record.answers.push(Answer::new("amplitude", amplitude, pair.map(|(m, _)| &m.amplitude)));
    }
    record
}
