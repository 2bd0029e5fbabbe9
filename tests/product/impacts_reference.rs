//! Contact traces of the script `timeav`: `legacy` reproduces its printed figures, the default the truth.

use std::path::{Path, PathBuf};
use vibroimpact::measure::impacts::{Impacts, ImpactsOptions, impacts};
use vibroimpact::measure::legacy::contact_times;
use vibroimpact::read::Reader;
use vibroimpact::record::Trace;

/// Sampling rate in Hz: 2.56 × 50 Hz.
const RATE: f64 = 128.0;

const CASES: [&str; 7] = ["nominal", "ring60", "missing", "bigfirst", "noiselead", "irregular", "header"];

fn folder(case: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/reference/scripts").join(format!("timeav_{case}"))
}

fn trace(case: &str) -> Trace {
    let recording = Reader::new().rate(Some(RATE)).from_path(folder(case).join("TRACE01.DAT")).unwrap();
    recording.trace(None, None).unwrap()
}

fn truth(case: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(folder(case).join("TRUTH.csv")).unwrap();
    text.lines().skip(1).map(|l| l.trim().parse().unwrap()).collect()
}

/// The number after `key` in the output of the script.
fn printed(text: &str, key: &str) -> f64 {
    let rest = &text[text.find(key).unwrap() + key.len()..];
    rest.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn legacy_gives_what_the_script_printed() {
    for case in CASES {
        let text = std::fs::read_to_string(folder(case).join("out_timeav.txt")).unwrap();
        let found = contact_times(&trace(case));
        if text.starts_with("ERROR") {
            let error = found.unwrap_err();
            assert!(error.exit_code() == 1 && error.to_string().contains("header"), "{case}: {error}");
            continue;
        }
        let found = found.unwrap();
        assert_eq!(found.maxima as f64, printed(&text, "maxp="), "{case}");
        let times: Vec<f64> =
            text[text.find("peakt=").unwrap() + 6..].split_whitespace().map(|t| t.parse().unwrap()).collect();
        assert_eq!(found.times.len(), times.len(), "{case}");
        // The script printed six decimals.
        assert!(found.times.iter().zip(&times).all(|(a, b)| (a - b).abs() <= 0.5001e-6), "{case}");
        let (interval, frequency) = (printed(&text, "diffav="), printed(&text, "diffreq="));
        if times.len() == 1 {
            assert!(found.interval.is_nan() && interval.is_nan(), "{case}");
        } else {
            // The script printed 17 digits; sums of times differ by a few roundings.
            assert!((found.interval / interval - 1.0).abs() < 1e-14, "{case} {}", found.interval);
            assert!((found.frequency / frequency - 1.0).abs() < 1e-14, "{case} {}", found.frequency);
        }
    }
}

/// Checks that each found time belongs to one true time. Returns the standard deviation of their
/// differences in s.
fn matches(case: &str, found: &Impacts) -> f64 {
    let truth = truth(case);
    assert_eq!(found.n, truth.len(), "{case}: {:?}", found.findings);
    let off: Vec<f64> = found.times.iter().zip(&truth).map(|(a, b)| a - b).collect();
    let mean = off.iter().sum::<f64>() / off.len() as f64;
    // The truth begins one sampling interval after 0 and gives the middle of a pulse. Onsets lie up to two
    // samples before the middle.
    assert!((-3.0 / RATE..0.0).contains(&mean), "{case}: {mean}");
    let worst = off.iter().map(|o| (o - mean).abs()).fold(0.0, f64::max);
    // Apart from the mean difference, no onset is more than a sample off.
    assert!(worst < 1.0 / RATE, "{case}: {worst}");
    (off.iter().map(|o| (o - mean).powi(2)).sum::<f64>() / off.len() as f64).sqrt()
}

#[test]
fn every_true_impact_is_found_and_no_other() {
    for case in CASES {
        let found = impacts(&trace(case), &ImpactsOptions::default()).unwrap();
        let scatter = matches(case, &found);
        println!(
            "{case}: onsets scatter by {:.2} ms ({:.3} samples), stated {:.2} ms; interval {:.6} ± {:.1e} s; {}",
            1e3 * scatter,
            scatter * RATE,
            1e3 * found.onset_std.unwrap(),
            found.interval.value,
            found.interval.std.unwrap(),
            found.interval.method
        );
        let missing = if case == "missing" { 2 } else { 0 };
        assert_eq!((found.missed, found.doubled), (missing, 0), "{case}");
        assert_eq!(found.regular, case != "irregular", "{case}");
        if found.regular {
            // The true impact frequency is 7.49 Hz.
            let off = (found.frequency.value - 7.49).abs() / found.frequency.std.unwrap();
            assert!(off < 4.0, "{case}: {:?}", found.frequency);
            // Onsets scatter by less than a tenth of a sample; the script resolved whole samples.
            assert!(scatter < 0.1 / RATE, "{case}: {scatter}");
        }
    }
}

#[test]
fn an_excitation_tells_regular_from_irregular() {
    for (case, excitation, expected) in
        [("nominal", 7.49, Some((1, 1))), ("missing", 14.98, Some((1, 2))), ("irregular", 5.61, None)]
    {
        let options = ImpactsOptions { excitation: Some(excitation), ..ImpactsOptions::default() };
        let found = impacts(&trace(case), &options).unwrap();
        assert_eq!(found.per_cycle.map(|p| (p.impacts, p.cycles)), expected, "{case}: {found:?}");
        assert_eq!(found.regular, expected.is_some(), "{case}");
    }
}
