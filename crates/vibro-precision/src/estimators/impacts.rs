//! Impacts of a contact trace: their frequency, and their times.

use super::trial::{Case, Change, Ensemble, EstimationMethod, EstimatorAnswer, each, questions, trace};
use super::{EstimatorScene, bounds, rivals, scene};
use crate::BorderQuestion;
use std::f64::consts::TAU;
use vibro_math::Noise;
use vibro_measure::impacts::{ImpactsOptions, impacts};
use vibro_measure::legacy::contact_times;
use vibro_record::Trace;

/// Sampling rate of the contact trace in Hz.
const RATE: f64 = 2000.0;

/// A contact that closes within a few samples and opens within twenty; `x` is the time from the onset in
/// samples.
fn pulse(x: f64) -> f64 {
    let rise = 0.5 * (1.0 + (x / 2.0).tanh());
    rise * (-(x.max(0.0) / 20.0).powi(2)).exp()
}

/// Samples after the onset beyond which a pulse and its ringing are negligible.
const PULSE_LENGTH: f64 = 120.0;

/// Parameters of a train of impacts.
#[derive(Clone, Default)]
struct SyntheticTrain {
    /// Number of impacts.
    count: usize,
    /// Indices of missing impacts.
    missing: Vec<usize>,
    /// Standard deviation of the noise.
    noise: f64,
    /// Standard deviation of the logarithm of the heights.
    heights: f64,
    /// Standard deviation of the onsets, as a share of the interval.
    jitter: f64,
    /// Height of the first impact; the others have a mean of 1.
    first: f64,
    /// Amplitude of a ringing with 12 samples a cycle, as a share of the height of its impact.
    ringing: f64,
}

/// A regular train of 60 impacts in noise of 1 %.
fn plain() -> SyntheticTrain {
    SyntheticTrain { count: 60, noise: 0.01, first: 1.0, ..SyntheticTrain::default() }
}

impl SyntheticTrain {
    /// The trace, the onsets of its impacts in samples, and the interval in samples.
    fn synthesised(&self, noise: &mut Noise) -> (Trace, Vec<f64>, f64) {
        let interval = noise.between(240.0, 290.0);
        let start = noise.between(200.0, 300.0);
        let n = (start + interval * self.count as f64) as usize;
        let mut values: Vec<f64> = (0..n).map(|_| self.noise * noise.normal()).collect();
        let mut onsets = Vec::new();
        for k in (0..self.count).filter(|k| !self.missing.contains(k)) {
            let time = start + interval * (k as f64 + self.jitter * noise.normal());
            let height = (self.heights * noise.normal()).exp() * if k == 0 { self.first } else { 1.0 };
            onsets.push(time);
            let part = (time - 20.0).max(0.0) as usize..n.min((time + PULSE_LENGTH).max(0.0) as usize);
            for (i, v) in part.clone().zip(&mut values[part]) {
                let x = i as f64 - time;
                let ring = self.ringing * (TAU * x / 12.0).sin() * (-x / 25.0).exp();
                *v += height * (pulse(x) + if x > 0.0 { ring } else { 0.0 });
            }
        }
        (trace("contact", "V", 1.0 / RATE, values), onsets, interval)
    }

    /// Draws records of the train, whose impact frequency is to be estimated.
    fn rate(self) -> impl Fn(&mut Noise) -> Case<Trace> {
        move |noise| {
            let (data, _, interval) = self.synthesised(noise);
            let truth = RATE / interval;
            Case { data, truth, unit: truth, tolerance: 0.01 * truth }
        }
    }
}

/// Cramér–Rao bound of the onset of one pulse of unknown height, in samples.
fn onset_bound(noise: f64) -> f64 {
    let model = |p: &[f64]| (-40..160).map(|i| p[1] * pulse(f64::from(i) - p[0])).collect();
    bounds(&[0.37, 1.0], &[1e-4, 1e-4], noise, model)[0]
}

/// Methods for the impact frequency.
const RATES: [EstimationMethod<Trace>; 3] = [
    EstimationMethod::Rival("timeav", |t| contact_times(t).map_or(f64::NAN, |f| f.frequency)),
    EstimationMethod::Rival("threshold", |t| RATE * rivals::mean_rate(&rivals::threshold(&t.values))),
    EstimationMethod::Own("onset fit", |t| {
        let found = impacts(t, &ImpactsOptions::default())?;
        Ok(EstimatorAnswer::found(&found.frequency, &found.findings))
    }),
];

/// Impacts of a record in which one interval is to be estimated.
const COUNT: usize = 20;

/// The interval between the two middle impacts; NaN where the number of impacts is wrong.
fn middle(times: &[f64]) -> f64 {
    if times.len() == COUNT { times[COUNT / 2] - times[COUNT / 2 - 1] } else { f64::NAN }
}

/// Methods for one interval between impacts.
const TIMES: [EstimationMethod<Trace>; 3] = [
    EstimationMethod::Rival("threshold, sample", |t| middle(&rivals::threshold(&t.values)) / RATE),
    EstimationMethod::Rival("threshold, between", |t| {
        middle(&rivals::passages(&t.values, rivals::half(&t.values))) / RATE
    }),
    EstimationMethod::Own("fit of the average", |t| {
        let found = impacts(t, &ImpactsOptions::default())?;
        let std = found.onset_std.map(|s| s * f64::sqrt(2.0));
        Ok(EstimatorAnswer { value: middle(&found.times), std, doubt: None })
    }),
];

/// The scenes of impacts.
pub fn scenes() -> Vec<EstimatorScene> {
    let settings = [
        ("even", plain()),
        ("2 of 60 missing", SyntheticTrain { missing: vec![20, 41], ..plain() }),
        ("ringing of 60 %", SyntheticTrain { ringing: 0.6, ..plain() }),
        ("first 5 times the rest", SyntheticTrain { first: 5.0, ..plain() }),
        ("heights vary", SyntheticTrain { heights: 0.4, ..plain() }),
        ("noise of 10 %", SyntheticTrain { noise: 0.1, ..plain() }),
    ]
    .map(|(name, train)| Ensemble::new(name, 30_000, train.rate()));
    let noises = [0.1, 0.03, 0.01, 0.003, 0.001].map(|sigma| {
        let bound = f64::sqrt(2.0) * onset_bound(sigma) / RATE;
        Ensemble::new(format!("noise of {} %", 100.0 * sigma), 31_000, move |noise: &mut Noise| {
            let (data, at, _) =
                SyntheticTrain { count: COUNT, noise: sigma, jitter: 0.01, ..plain() }.synthesised(noise);
            Case { data, truth: middle(&at) / RATE, unit: bound, tolerance: 1.0 / RATE }
        })
    });
    let (n, truth) = (60.0_f64, "the times at which pulses were written into the record");
    let rates = [
        "impact-rate",
        "The impact frequency of a contact trace of 60 impacts at 2000 samples a second in noise of 1 %: even, with impacts missing, ringing, one impact far higher, uneven heights, and noise of 10 %. The bound is that of the even train.",
        "impact frequency: relative error (rms)",
        truth,
    ];
    let times = [
        "impact-times",
        "The interval between two neighbouring impacts of a train of 20, in noise of 0.1 to 10 % of their height.",
        "interval: error (rms) over its Cramér–Rao bound",
        truth,
    ];
    let bound = onset_bound(0.01) * (12.0 / (n * (n * n - 1.0))).sqrt() / 265.0;
    vec![scene(rates, bound, &RATES, settings), scene(times, 1.0, &TIMES, noises)]
}

/// `count` of 60 impacts at random; the first and the last are kept.
fn scattered(count: usize) -> Vec<usize> {
    let mut noise = Noise::new(7);
    let mut all: Vec<usize> = (1..59).collect();
    (0..count).map(|_| all.swap_remove(noise.between(0.0, all.len() as f64) as usize)).collect()
}

/// Questions to methods for impacts at their borders.
pub(crate) fn borders(quick: bool) -> Vec<BorderQuestion> {
    let kind = |name: &str, train: SyntheticTrain| Ensemble::new(name, 32_000, train.rate());
    let ringing = [0.3, 0.6, 0.9]
        .map(|r| kind(&format!("ringing of {} %", 100.0 * r), SyntheticTrain { ringing: r, ..plain() }));
    let counts = [
        kind("2 of 60 missing", SyntheticTrain { missing: vec![20, 41], ..plain() }),
        kind("20 of 60 missing", SyntheticTrain { missing: scattered(20), ..plain() }),
        kind("40 of 60 missing", SyntheticTrain { missing: scattered(40), ..plain() }),
        kind("two impacts", SyntheticTrain { count: 2, ..plain() }),
        kind("one impact", SyntheticTrain { count: 1, ..plain() }),
        kind("no impact", SyntheticTrain { count: 0, ..plain() }),
    ];
    let heights = [
        kind("first 5 times the rest", SyntheticTrain { first: 5.0, ..plain() }),
        kind("first 50 times the rest", SyntheticTrain { first: 50.0, ..plain() }),
        kind("heights vary by 1 : 3", SyntheticTrain { heights: 0.4, ..plain() }),
        kind("heights vary by 1 : 20", SyntheticTrain { heights: 1.0, ..plain() }),
    ];
    let noise = [0.1, 0.3, 1.0, 3.0].map(|n| {
        kind(&format!("noise of {} % of the height", 100.0 * n), SyntheticTrain { noise: n, ..plain() })
    });
    let uneven = [0.02, 0.1, 0.3].map(|jitter| {
        kind(&format!("onsets scatter by {} %", 100.0 * jitter), SyntheticTrain { jitter, ..plain() })
    });
    let changes: [Change<Trace>; 8] = [
        ("three spikes in front", |t| [20, 50, 110].into_iter().for_each(|i| t.values[i] = 0.9)),
        ("pulses point downwards", |t| each(t, |_, v| -v)),
        ("clipped at half height", |t| each(t, |_, v| v.min(0.5))),
        ("level of 100 heights", |t| each(t, |_, v| v + 100.0)),
        ("drift of 3 heights", |t| each(t, |part, v| v + 3.0 * part)),
        ("mains hum of half the height", |t| {
            let cycles = 50.0 * t.values.len() as f64 / RATE;
            each(t, |part, v| v + 0.5 * (TAU * cycles * part).sin());
        }),
        ("one sample missing", |t| t.values[300] = f64::NAN),
        ("all equal", |t| t.values.fill(0.25)),
    ];
    let faults = changes.map(|(name, change)| Ensemble::new(name, 32_000, plain().rate()).changed(change));
    let mut all = questions("impact rate: ringing", &RATES, ringing, quick);
    all.extend(questions("impact rate: missing", &RATES, counts, quick));
    all.extend(questions("impact rate: heights", &RATES, heights, quick));
    all.extend(questions("impact rate: noise", &RATES, noise, quick));
    all.extend(questions("impact rate: uneven", &RATES, uneven, quick));
    all.extend(questions("impact rate: faults", &RATES, faults, quick));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In noise of 10 % no impact is missed. Where noise hides impacts no uncertainty may be stated, whatever
    /// the intervals suggest.
    #[test]
    fn impacts_in_noise_are_all_found_or_no_uncertainty_is_stated() {
        in_noise(4);
    }

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn impacts_in_noise_are_all_found_or_no_uncertainty_is_stated_in_all_draws() {
        in_noise(100);
    }

    fn in_noise(cases: u64) {
        for sigma in [0.1, 0.12, 0.15, 0.2] {
            let make = SyntheticTrain { noise: sigma, ..plain() }.rate();
            let (mut right, mut withheld, mut refused) = (0, 0, 0);
            for seed in 30_000..30_000 + cases {
                let case = make(&mut Noise::new(seed));
                let Ok(found) = impacts(&case.data, &ImpactsOptions::default()) else {
                    refused += 1;
                    continue;
                };
                let Some(std) = found.frequency.std else {
                    withheld += 1;
                    continue;
                };
                let off = (found.frequency.value - case.truth).abs() / std;
                // Of normal errors 6e-5 lie beyond four standard uncertainties; with the fixed seeds none
                // does.
                assert!(
                    off < 4.0,
                    "noise of {sigma}, seed {seed}: {off:.1} standard uncertainties, {:?}",
                    found.findings
                );
                right += 1;
            }
            println!(
                "noise of {sigma}, {cases} seeds from 30000: {right} right, {withheld} without an uncertainty, {refused} refused"
            );
            assert!(sigma > 0.1 || right == cases, "{right}");
            assert!(sigma < 0.15 || 10 * right < cases, "{right}");
        }
    }
}
