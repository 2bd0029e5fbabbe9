use super::*;
use vibro_math::Noise;
use vibro_record::units::Unit;
use vibro_record::{Axis, Grid, Meta};

fn has(found: &Impacts, code: &str) -> bool {
    found.findings.iter().any(|f| f.code == code)
}

fn trace(values: Vec<f64>, rate: f64) -> Trace {
    Trace {
        meta: Meta::new("contact", Unit::parse("V").unwrap()),
        axis: Axis::time(0.0, 1.0 / rate, values.len()),
        values,
    }
}

/// Decaying pulses at `times`, with a flank of about three samples.
fn pulses(times: &[f64], n: usize, rate: f64, sigma: f64) -> Trace {
    let mut noise = Noise::new(11);
    let values = (0..n)
        .map(|i| {
            let t = i as f64 / rate;
            let pulse = |x: f64| if x > 0.0 { (1.0 - (-x / 1e-3).exp()) * (-x / 4e-3).exp() } else { 0.0 };
            sigma * noise.normal() + times.iter().map(|at| pulse(t - at)).sum::<f64>()
        })
        .collect();
    trace(values, rate)
}

#[test]
fn a_regular_train_with_one_missed_and_one_doubled() {
    let mut times: Vec<f64> = (0..40).map(|k| 0.05 + 0.1 * f64::from(k)).collect();
    times.remove(20);
    times.insert(30, 0.05 + 0.1 * 31.0 - 0.07);
    times.sort_by(f64::total_cmp);
    let found = impacts(&pulses(&times, 4200, 1000.0, 0.005), &ImpactsOptions::default()).unwrap();
    assert_eq!((found.n, found.missed, found.doubled, found.regular), (40, 1, 1, true), "{found:?}");
    // σ_t = 5e-3/(slope of 150/s) = 3e-5 s, so a line through 40 points has u = 3e-5·√(12/40³) = 4e-7 s; four
    // of these.
    assert!((found.interval.value - 0.1).abs() < 2e-6, "{found:?}");
}

#[test]
fn impacts_of_every_second_cycle_keep_their_phase() {
    let f = 15.0;
    let times: Vec<f64> = (0..30).map(|k| (2.0 * f64::from(k) + 1.25) / f).collect();
    let rate = 2000.0;
    let mut options = ImpactsOptions { excitation: Some(f), ..ImpactsOptions::default() };
    let trace = pulses(&times, 8500, rate, 0.002);
    let stated = impacts(&trace, &options).unwrap();
    assert_eq!(stated.per_cycle, Some(PerCycle { impacts: 1, cycles: 2 }));
    options.reference =
        Some((0..8500).map(|i| (std::f64::consts::TAU * f * f64::from(i) / rate).sin()).collect());
    options.excitation = None;
    let measured = impacts(&trace, &options).unwrap();
    assert_eq!(measured.per_cycle, stated.per_cycle);
    assert!((measured.excitation.unwrap() - f).abs() < 1e-4);
    for found in [stated, measured] {
        // Half height is passed within 1 ms = 0.015 cycles of the onset. The first edge decides which of two
        // cycles counts as the first.
        assert!((found.phases[0].mean.fract() - 0.25).abs() < 0.016, "{:?}", found.phases);
        assert!(found.regular);
    }
}

#[test]
fn pulses_that_point_downwards_are_turned() {
    let times: Vec<f64> = (0..10).map(|k| 0.05 + 0.1 * f64::from(k)).collect();
    let mut trace = pulses(&times, 1100, 1000.0, 0.005);
    trace.values.iter_mut().for_each(|v| *v = 2.0 - *v);
    let found = impacts(&trace, &ImpactsOptions::default()).unwrap();
    assert_eq!(found.n, 10);
    assert!(has(&found, "pulses-inverted"), "{:?}", found.findings);
}

/// The sounds among which a threshold chooses are those of the trace, whatever the options choose.
#[test]
fn what_is_heard_is_what_a_threshold_is_set_by() {
    let times: Vec<f64> = (0..10).map(|k| 0.05 + 0.1 * f64::from(k)).collect();
    let mut trace = pulses(&times, 1100, 1000.0, 0.005);
    let upright = heard(&trace, &ImpactsOptions::default(), false).unwrap();
    let strict = ImpactsOptions { threshold: Some(0.9), refractory: Some(0.15), ..ImpactsOptions::default() };
    assert_eq!(heard(&trace, &strict, false).unwrap(), upright);
    assert_eq!((upright.sounds.len(), upright.sides), (10, [true, false]));
    for (sound, time) in upright.sounds.iter().zip(&times) {
        // A sound begins where it leaves the noise: within two samples of its onset.
        assert!((sound.from - time).abs() < 2e-3 && sound.to > sound.from, "{sound:?} {time}");
        assert!(
            sound.height > upright.reach && (sound.height / upright.median - 1.0).abs() < 0.2,
            "{sound:?}"
        );
    }
    trace.values.iter_mut().for_each(|v| *v = 2.0 - *v);
    let turned = heard(&trace, &ImpactsOptions::default(), false).unwrap();
    assert_eq!((turned.sounds.len(), turned.sides), (10, [false, true]));
    assert!((turned.rest - 2.0).abs() < 0.01, "{turned:?}");
    let falls = heard(&trace, &ImpactsOptions::default(), true).unwrap();
    assert_eq!((falls.sounds.len(), falls.sides), (10, [true, true]));
}

#[test]
fn what_holds_no_impacts_is_refused() {
    let refused = |trace: &Trace| impacts(trace, &ImpactsOptions::default()).unwrap_err();
    assert!(refused(&trace(vec![1.0; 100], 100.0)).to_string().contains("equal"));
    let mut one = pulses(&[0.3], 1000, 1000.0, 0.005);
    assert!(refused(&one).to_string().contains("1 impact found"));
    one.values[7] = f64::NAN;
    assert!(refused(&one).to_string().contains("missing"));
    let mut noise = Noise::new(5);
    let quiet = trace((0..5000).map(|_| noise.normal()).collect(), 1000.0);
    assert!(refused(&quiet).to_string().contains("0 impacts found"), "{}", refused(&quiet));
    let mut unknown = pulses(&[0.1, 0.2], 400, 1000.0, 0.005);
    unknown.axis = Axis::index(400);
    let error = refused(&unknown);
    assert!(error.to_string().contains("base_band") && error.exit_code() == 2, "{error}");
    let one_edge = ImpactsOptions {
        reference: Some((0..400).map(|i| f64::from(i / 200)).collect()),
        ..ImpactsOptions::default()
    };
    let error = impacts(&pulses(&[0.1, 0.2], 400, 1000.0, 0.005), &one_edge).unwrap_err();
    assert!(error.to_string().contains("rising edges of the reference channel: 1"), "{error}");
}

/// Pulses of 4 V and 1 ms, sin² each, over a sine of 50 Hz, at 10 kHz for 2 s.
fn over_hum(times: &[f64], hum: f64) -> Trace {
    let mut noise = Noise::new(21);
    let values = (0..20_000)
        .map(|i| {
            let t = f64::from(i) / 1e4;
            let pulse = |x: f64| {
                if (0.0..1e-3).contains(&x) { (std::f64::consts::PI * x / 1e-3).sin().powi(2) } else { 0.0 }
            };
            0.05 * noise.normal()
                + hum * (std::f64::consts::TAU * 50.0 * t).sin()
                + 4.0 * times.iter().map(|at| pulse(t - at)).sum::<f64>()
        })
        .collect();
    trace(values, 1e4)
}

#[test]
fn no_impact_higher_than_the_hum_is_lost() {
    let rate = 13.37;
    let times: Vec<f64> = (0..1000).map(|k| 0.013 + f64::from(k) / rate).take_while(|t| *t < 1.99).collect();
    for hum in [0.0, 0.2, 0.4, 0.5, 1.0] {
        let found = impacts(&over_hum(&times, hum), &ImpactsOptions::default()).unwrap();
        assert_eq!(found.n, times.len(), "hum {hum}: {:?}", found.findings);
        // The slope of hum of 1 V is 314 V/s, that of the flanks 2π·10³ V/s or more where the hum shifts them
        // by its 1 V: 0.2 ms at most.
        let off = (found.frequency.value / rate - 1.0).abs();
        assert!(off < 2e-4 / found.interval.value / (times.len() - 1) as f64, "hum {hum}: {off}");
    }
}

#[test]
fn a_refusal_says_what_may_help() {
    // Impacts as high as the hum, at its rate.
    let times: Vec<f64> = (0..98).map(|k| 0.013 + 0.02 * f64::from(k)).collect();
    let mut low = over_hum(&times, 0.0);
    for (i, v) in low.values.iter_mut().enumerate() {
        *v = *v * 0.05 + (std::f64::consts::TAU * 50.0 * i as f64 / 1e4).sin();
    }
    if let Err(error) = impacts(&low, &ImpactsOptions::default()) {
        assert!(error.to_string().contains("band in which the impacts ring"), "{error}");
    }
    let mut noise = Noise::new(8);
    let quiet = trace((0..5000).map(|_| noise.normal()).collect(), 1000.0);
    let error = impacts(&quiet, &ImpactsOptions::default()).unwrap_err().to_string();
    assert!(error.contains("band in which the impacts ring") && !error.contains("threshold"), "{error}");
}

#[test]
fn two_unequal_intervals_a_cycle_are_a_pattern_and_miss_nothing() {
    for (second, excitation) in [(0.03, 8.3333), (0.045, 8.3333), (0.05, 8.3333)] {
        let times: Vec<f64> =
            (0..32).map(|k| 0.02 + 0.12 * f64::from(k / 2) + if k % 2 == 1 { second } else { 0.0 }).collect();
        let trace = over_hum(&times, 0.0);
        let options = ImpactsOptions { excitation: Some(excitation), ..Default::default() };
        let found = impacts(&trace, &options).unwrap();
        assert_eq!((found.n, found.missed, found.doubled, found.pattern), (32, 0, 0, Some(2)), "{found:?}");
        // Noise of 0.05 on a slope of 6e3 V/s is 8 µs an onset; a line through 32 of them knows T to
        // 8e-6·√(12/32³) = 0.15 µs; four of these.
        assert!((found.interval.value - 0.06).abs() < 6e-7, "{:?}", found.interval);
        assert_eq!(found.per_cycle, Some(PerCycle { impacts: 2, cycles: 1 }), "{:?}", found.findings);
        let alone = impacts(&trace, &ImpactsOptions::default()).unwrap();
        assert!(alone.regular && has(&alone, "interval-pattern"), "{alone:?}");
    }
}

#[test]
fn what_is_known_to_be_complete_misses_nothing() {
    let mut times: Vec<f64> = (0..30).map(|k| 0.02 + 0.05 * f64::from(k)).collect();
    times.remove(12);
    let trace = over_hum(&times, 0.0);
    let known = ImpactsOptions { complete: true, ..ImpactsOptions::default() };
    assert_eq!(impacts(&trace, &ImpactsOptions::default()).unwrap().missed, 1);
    let found = impacts(&trace, &known).unwrap();
    // 28 intervals in 1.45 s.
    assert!(found.missed == 0 && (found.interval.value - 1.45 / 28.0).abs() < 2e-3, "{found:?}");
}

#[test]
fn two_impacts_are_not_regular() {
    let options = ImpactsOptions { excitation: Some(7.0), ..ImpactsOptions::default() };
    let found = impacts(&pulses(&[0.1, 0.2], 400, 1000.0, 0.005), &options).unwrap();
    assert!(!found.regular && has(&found, "one-interval") && !has(&found, "no-fraction-fits"), "{found:?}");
}

/// A contact circuit closes within one sample; its interval is near a whole number of samples or not, its
/// first edge anywhere. The stated interval covers the truth, and a train at the rate of the excitation does
/// not drift.
#[test]
fn edges_within_one_sample_leave_the_interval_unsure() {
    let (rate, n, seed) = (1000.0, 40, 21);
    let mut noise = Noise::new(seed);
    let (mut inside, mut cases) = (0, 0);
    for period in [100.0, 100.001, 100.01, 100.02, 99.99, 100.37] {
        for _ in 0..12 {
            let first = 200.0 + noise.uniform();
            let edges: Vec<f64> = (0..n).map(|k| first + period * f64::from(k)).collect();
            let mut values: Vec<f64> = (0..4400).map(|_| 0.01 * noise.normal()).collect();
            for edge in &edges {
                let at = edge.ceil() as usize;
                values[at..at + 12].iter_mut().for_each(|v| *v += 5.0);
            }
            let options = ImpactsOptions {
                excitation: Some(rate / period),
                keep_hum: true,
                ..ImpactsOptions::default()
            };
            let found = impacts(&trace(values, rate), &options).unwrap();
            assert!(has(&found, "onset-within-sample"), "{:?}", found.findings);
            assert!(found.onset_std.unwrap() > 0.28 / rate, "{:?}", found.onset_std);
            let error = found.interval.value - period / rate;
            // The first and last edge are each up to a sample late.
            assert!(error.abs() <= 1.0 / rate / f64::from(n - 1) + 1e-6, "seed {seed}, {period}: {error}");
            inside += usize::from(error.abs() < 1.96 * found.interval.std.unwrap());
            assert_eq!(found.per_cycle, Some(PerCycle { impacts: 1, cycles: 1 }), "{:?}", found.findings);
            cases += 1;
        }
    }
    // 95 % of 72 cases, less two standard deviations of 1.8 cases.
    assert!(inside * 100 >= cases * 90, "seed {seed}: {inside} of {cases}");
    // An excitation wrong by more than the samples hide gives a drift with a stated beat.
    let mut values = vec![0.0; 4400];
    (0..n as usize).for_each(|k| values[200 + 100 * k..212 + 100 * k].fill(5.0));
    let options = ImpactsOptions { excitation: Some(10.1), keep_hum: true, ..ImpactsOptions::default() };
    let found = impacts(&trace(values, rate), &options).unwrap();
    let beat = found.beat.as_ref().unwrap();
    assert!((beat.value - 0.1).abs() < 1e-9 && beat.std.is_some(), "{beat:?}");
}

#[test]
fn uneven_times_and_missing_values_are_named() {
    let mut odd = pulses(&[0.1, 0.3], 500, 1000.0, 0.001);
    odd.values[200..210].fill(f64::NAN);
    let why = impacts(&odd, &ImpactsOptions::default()).unwrap_err().to_string();
    assert!(why.contains("10 values of the trace") && why.contains("from 0.2 s to 0.209 s"), "{why}");
    let mut times: Vec<f64> = (0..500).map(|i| f64::from(i) / 1000.0).collect();
    times[300..].iter_mut().for_each(|t| *t += 0.03);
    odd.axis.grid = Grid::Uneven(times);
    let why = impacts(&odd, &ImpactsOptions::default()).unwrap_err().to_string();
    assert!(why.contains("unevenly spaced"), "{why}");
}

/// A bearing with a fault of its outer ring: three rises a ball passage that ring at 3.2 kHz, with slip,
/// under a shaft and noise.
fn bearing(seed: u64, passage: f64) -> Trace {
    let (rate, n) = (25_600.0, 51_200);
    let mut noise = Noise::new(seed);
    let tau = std::f64::consts::TAU;
    let mut values: Vec<f64> =
        (0..n).map(|i| 4.0 * (tau * 29.95 * f64::from(i) / rate).sin() + 0.08 * noise.normal()).collect();
    let mut at = 0.3 / passage;
    while at < f64::from(n) / rate - 0.01 {
        let height = 1.0 + 0.15 * noise.normal();
        for (later, part) in [(0.0, 1.0), (3e-4, 0.7), (6e-4, 0.5)] {
            let first = ((at + later) * rate).ceil() as usize;
            for (k, v) in values[first..].iter_mut().take(200).enumerate() {
                let t = (first + k) as f64 / rate - at - later;
                *v += height * part * (-1200.0 * t).exp() * (tau * 3200.0 * t).sin();
            }
        }
        at += (1.0 + 0.01 * noise.normal()) / passage;
    }
    trace(values, rate)
}

#[test]
fn ball_passages_in_the_sound_of_a_machine() {
    let passage = 107.3;
    for seed in 0..4 {
        let record = bearing(seed, passage);
        let options =
            ImpactsOptions { band: Some((2000.0, 4500.0)), envelope: true, ..ImpactsOptions::default() };
        let found = impacts(&record, &options).unwrap();
        // The slip of 1 % of 214 passages leaves 0.07 % of the mean.
        assert!(
            (found.frequency.value / passage - 1.0).abs() < 4.0 * 0.01 / 214f64.sqrt(),
            "{:?}",
            found.frequency
        );
        assert!(found.regular && found.missed + found.doubled < 4, "{} {}", found.missed, found.doubled);
    }
}

/// Ticks of a clock in a reverberant room: each is noise that begins abruptly and decays. The largest of 48
/// samples of noise is 2.3σ, and one sample in four passes half of that. An onset therefore scatters by 3.5
/// samples, the mean of ten intervals of 0.5 s by √2·3.5/16 000/10 s.
#[test]
fn ticks_in_a_room_that_reverberates_are_counted_once() {
    let (mut noise, rate) = (Noise::new(31), 16_000.0);
    let mut values: Vec<f64> = (0..96_000).map(|_| 2e-4 * noise.normal()).collect();
    for k in 0..11 {
        let from = 4000 + 8000 * k;
        for (i, v) in values[from..].iter_mut().enumerate().take(8000) {
            *v += 0.3 * (-(i as f64) / 800.0).exp() * noise.normal();
        }
    }
    let found = impacts(&trace(values, rate), &ImpactsOptions::default()).unwrap();
    assert_eq!((found.n, found.missed, found.doubled), (11, 0, 0));
    let std = 2f64.sqrt() * 3.5 / rate / 10.0;
    assert!((found.interval.value - 0.5).abs() < 4.0 * std, "{:?}", found.interval);
}

/// Bursts at random, as of rain, have no period.
#[test]
fn what_has_no_period_is_refused() {
    let mut noise = Noise::new(1);
    let mut values: Vec<f64> = (0..50_000).map(|_| 0.01 * noise.normal()).collect();
    for _ in 0..100 {
        let at = noise.between(0.0, 49_900.0) as usize;
        values[at..at + 60].iter_mut().enumerate().for_each(|(k, v)| *v += (-(k as f64) / 10.0).exp());
    }
    let record = trace(values, 10_000.0);
    let why = impacts(&record, &ImpactsOptions::default()).unwrap_err();
    assert!(why.exit_code() == 1 && why.to_string().contains("irregular"), "{why}");
    let found = impacts(&record, &ImpactsOptions { complete: true, ..ImpactsOptions::default() }).unwrap();
    assert!((found.n as f64 - 100.0).abs() < 12.0, "{}", found.n);
}

/// A train of bursts sampled at 25.6 kHz. They ring at 3 kHz, decay by the factor e within `part` of their
/// period, and lie in noise of 1/200 of their height.
fn ringing(part: f64, offset: f64) -> Trace {
    let (rate, n, period) = (25_600.0, 25_600, 0.0123);
    let mut noise = Noise::new(12);
    let mut values: Vec<f64> = (0..n).map(|_| offset + 5e-3 * noise.normal()).collect();
    for k in 0..81 {
        let at = 0.0071 + period * f64::from(k);
        for (i, v) in values.iter_mut().enumerate().skip((at * rate) as usize + 1) {
            let t = i as f64 / rate - at;
            *v += (-t / (part * period)).exp() * (std::f64::consts::TAU * 3000.0 * t).sin();
        }
    }
    trace(values, rate)
}

#[test]
fn an_envelope_that_rings_until_the_next_impact_has_them_all() {
    for (part, offset) in [(0.05, 0.0), (0.2, 0.0), (0.25, 0.0), (0.33, 2.0), (0.5, 0.0)] {
        for band in [Some((2100.0, 3900.0)), None] {
            let options = ImpactsOptions { band, envelope: true, ..ImpactsOptions::default() };
            let found = impacts(&ringing(part, offset), &options).unwrap();
            assert_eq!(
                (found.n, found.missed, found.doubled),
                (81, 0, 0),
                "{part} {band:?}: {:?}",
                found.findings
            );
            // Noise of 1/200 of the height over a flank of a few samples: 0.05 samples, and so by a line
            // through 81 points 1e-7 s of 80 intervals.
            assert!((found.interval.value - 0.0123).abs() < 1e-6, "{part} {band:?}: {:?}", found.interval);
            assert!(!has(&found, "count-depends-on-ringing"), "{part} {band:?}: {:?}", found.findings);
        }
    }
}

/// Each hint of an error, when followed, finds the impacts.
#[test]
fn the_hints_of_a_refusal_find_the_impacts() {
    let plain = ImpactsOptions::default();
    // Bursts of 1 V on a slow swing of 60 V.
    let mut slow = ringing(0.05, 0.0);
    for (i, v) in slow.values.iter_mut().enumerate() {
        *v += 60.0 * (std::f64::consts::TAU * 3.0 * i as f64 / 25_600.0).sin();
    }
    // The band in which they ring is found, or stated. The period is 12.3 ms.
    let found = impacts(&slow, &plain).unwrap();
    assert!(has(&found, "impacts-in-band") && found.n == 81, "{found:?}");
    assert!(
        (found.frequency.value - 1.0 / 12.3e-3).abs() < 3.0 * found.frequency.std.unwrap(),
        "{:?}",
        found.frequency
    );
    let band = ImpactsOptions { band: Some((2000.0, 4000.0)), ..plain.clone() };
    assert_eq!(impacts(&slow, &band).unwrap().n, 81);
    // A band in which nothing rings.
    let beside = ImpactsOptions { band: Some((9000.0, 11_000.0)), ..plain.clone() };
    let mut noise = Noise::new(3);
    let hiss = trace((0..25_600).map(|_| noise.normal()).collect(), 25_600.0);
    let why = impacts(&hiss, &beside).unwrap_err().to_string();
    assert!(why.contains("another band"), "{why}");
    // A pause longer than the period joins all impacts. For a record with only one impact, the hint does not
    // suggest a shorter pause.
    let long = ImpactsOptions { refractory: Some(0.1), ..plain.clone() };
    let why = impacts(&ringing(0.05, 0.0), &long).unwrap_err().to_string();
    assert!(why.contains("shorter pause"), "{why}");
    let short = ImpactsOptions { refractory: Some(0.001), ..plain };
    assert_eq!(impacts(&ringing(0.05, 0.0), &short).unwrap().n, 81);
    let why = impacts(&pulses(&[0.3], 1000, 1000.0, 0.005), &long).unwrap_err().to_string();
    assert!(!why.contains("pause"), "{why}");
}

/// Impacts of a machine every 80 ms, with a jitter of `jitter` times 80 ms. Two echoes follow each.
fn echoing(seed: u64, jitter: f64, echo: f64) -> (Trace, Vec<f64>) {
    let (rate, mut noise) = (20_000.0, Noise::new(seed));
    let times: Vec<f64> = (0..40).map(|k| 0.05 + 0.08 * (f64::from(k) + jitter * noise.normal())).collect();
    let mut values: Vec<f64> = (0..66_000).map(|_| 2e-3 * noise.normal()).collect();
    for (delay, part) in [(0.0, 1.0), (4.1e-3, echo), (9.7e-3, 0.7 * echo)] {
        for at in times.iter().map(|t| t + delay) {
            for (i, v) in values.iter_mut().enumerate().skip((at * rate) as usize + 1).take(200) {
                let t = i as f64 / rate - at;
                *v += part * (-t / 6e-4).exp() * (std::f64::consts::TAU * 2000.0 * t).sin();
            }
        }
    }
    (trace(values, rate), times)
}

#[test]
fn echoes_are_no_impacts() {
    for echo in [0.05, 0.15, 0.3, 0.5] {
        for seed in 0..4 {
            let (record, times) = echoing(seed, 0.02, echo);
            let found = impacts(&record, &ImpactsOptions::default()).unwrap();
            assert_eq!((found.n, found.missed, found.doubled), (40, 0, 0), "{echo}: {:?}", found.findings);
            let mean = (times[39] - times[0]) / 39.0;
            // Four of the stated standard uncertainties.
            assert!((found.interval.value - 0.08).abs() < 4.0 * found.interval.std.unwrap(), "{mean}");
        }
        // Without jitter, the bursts may also be three impacts a cycle. The finding expresses this doubt,
        // and the pause that it names removes the echoes.
        let (record, _) = echoing(9, 0.0, echo);
        let found = impacts(&record, &ImpactsOptions::default()).unwrap();
        let doubt = found.findings.iter().find(|f| f.code == "impacts-or-echoes");
        assert!(
            found.n == 40 || doubt.is_some() && found.interval.std.is_none(),
            "{echo}: {:?}",
            found.findings
        );
        if let Some(pause) = doubt.and_then(|f| f.get("pause")) {
            let options = ImpactsOptions { refractory: Some(pause), ..ImpactsOptions::default() };
            let found = impacts(&record, &options).unwrap();
            // One onset is known to half a swing of 2 kHz, 0.25 ms, and 39 intervals share two of them.
            assert!(found.n == 40 && (found.interval.value - 0.08).abs() < 1e-5, "{:?}", found.interval);
        }
    }
}

/// Three seconds of a bearing with a fault of its outer race: each roller excites a resonance of 3 kHz by an
/// amplitude that the shaft of 29.95 Hz modulates; the shaft's own tone, and noise. The time of the first
/// impact is anywhere.
fn outer_race(seed: u64, zeta: f64, modulation: f64, tone: f64, sigma: f64) -> Trace {
    let (rate, shaft, ring, mut noise) = (12_000.0, 29.95, 3000.0, Noise::new(seed));
    let turn = |t: f64| std::f64::consts::TAU * shaft * t;
    let mut values: Vec<f64> =
        (0..36_000).map(|i| tone * turn(f64::from(i) / rate).sin() + sigma * noise.normal()).collect();
    let first = noise.uniform() / RACE;
    for at in (0..242).map(|k| first + f64::from(k) / RACE).filter(|at| *at < 3.0) {
        let size = (1.0 + modulation * turn(at).cos()) * (1.0 + 0.05 * noise.normal());
        for (i, v) in values.iter_mut().enumerate().skip((at * rate) as usize + 1).take(600) {
            let angle = std::f64::consts::TAU * ring * (i as f64 / rate - at);
            *v += size * (-zeta * angle).exp() * angle.sin();
        }
    }
    trace(values, rate)
}

/// Impacts a second of its outer race.
const RACE: f64 = 80.69;

#[test]
fn the_fault_of_an_outer_race_is_found_in_the_band_in_which_it_rings() {
    let (mut answered, mut within) = (0, 0);
    for (seed, zeta, modulation, tone, sigma) in [
        (1, 0.02, 0.1, 0.05, 0.02),
        (2, 0.05, 0.3, 0.3, 0.1),
        (3, 0.05, 0.3, 0.5, 0.2),
        (4, 0.03, 0.5, 0.5, 0.1),
        (5, 0.05, 0.3, 1.0, 0.1),
    ] {
        let Ok(found) = impacts(&outer_race(seed, zeta, modulation, tone, sigma), &ImpactsOptions::default())
        else {
            continue;
        };
        let Some(std) = found.frequency.std else { continue };
        let off = (found.frequency.value - RACE).abs() / std;
        println!("bearing {seed}: {} Hz ± {std}, {off:.2} std, {} impacts", found.frequency.value, found.n);
        answered += 1;
        within += usize::from(off < 2.0);
        // A plausible wrong period, such as that of every second impact or of the shaft, is thousands of
        // uncertainties away.
        assert!(off < 4.0, "{seed}: {:?} {:?}", found.frequency, found.findings);
    }
    // Of five, 4.75 within two standard uncertainties.
    assert!(answered >= 4 && within + 1 >= answered, "{answered} {within}");
}

/// A free decay of 9.6 Hz after a pluck, for several sampling rates and damping ratios: no search takes its
/// swings for impacts.
#[test]
fn the_swings_of_a_free_decay_are_no_impacts() {
    for (rate, zeta) in [(500.0, 0.01), (2000.0, 0.003), (2000.0, 0.03), (10_000.0, 0.02)] {
        let mut noise = Noise::new(7);
        let decay =
            |t: f64| if t < 0.0 { 0.0 } else { (-zeta * t).exp() * (t * (1.0 - zeta * zeta).sqrt()).sin() };
        let angle = |i: u32| std::f64::consts::TAU * 9.6 * (f64::from(i) / rate - 0.5);
        let values = (0..(5.0 * rate) as u32).map(|i| decay(angle(i)) + 1e-3 * noise.normal()).collect();
        let trace = trace(values, rate);
        for refractory in [None, Some(0.02)] {
            let options = ImpactsOptions { refractory, ..ImpactsOptions::default() };
            let said = impacts(&trace, &options).unwrap_err();
            let why = said.why();
            let (_, found) = why.split_once("a free decay of ").unwrap();
            let frequency: f64 = found.split(' ').next().unwrap().parse().unwrap();
            // Noise of a thousandth over the 16 periods or more that are seen.
            assert!((frequency - 9.6).abs() < 1e-3, "{rate} {zeta} {refractory:?}: {said}");
            assert_eq!(said.advice(), "vibro decay FILE");
            let said = crate::restitution::Train::of(&trace, &options, None).unwrap_err();
            assert!(said.to_string().contains("the record rings"), "{rate} {zeta} {refractory:?}: {said}");
        }
    }
}
