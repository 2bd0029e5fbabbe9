//! Frequencies from records with a wandering clock: their uncertainty includes that of the clock.

use vibroimpact::math::Noise;
use vibroimpact::measure::tones::tones;
use vibroimpact::read::Reader;

const DRAWS: u64 = 120;
/// Standard deviation of a sampling step in s.
const WANDER: f64 = 1e-6;

/// Fits a sine of 12 Hz that a telephone sampled with scattering steps. Returns its frequency in Hz, the
/// standard uncertainty in Hz, and the relative standard uncertainty of the clock.
fn found(seed: u64) -> (f64, f64, f64) {
    let mut noise = Noise::new(seed);
    let mut t = 0.0;
    let mut next = || {
        t += 9.9988e-3 + WANDER * noise.normal();
        let value = 2.0 * (std::f64::consts::TAU * 12.0 * t).sin() + 1e-2 * noise.normal();
        format!("{t:.9E},{value:.9E}\n")
    };
    let head = "\"Time (s)\",\"Linear Acceleration x (m/s^2)\"\n".to_owned();
    let text = (0..1000).fold(head, |text, _| text + &next());
    let recording = Reader::new().from_reader("Raw Data.csv", text.as_bytes()).expect("read");
    let trace = recording.trace(None, None).expect("a trace");
    let fitted = tones(&trace, 1).expect("a sine");
    let frequency = &fitted.tones[0].frequency;
    (frequency.value, frequency.std.expect("an uncertainty"), trace.meta.clock)
}

#[test]
fn the_uncertainty_of_a_frequency_holds_the_truth_where_the_clock_wanders() {
    let all: Vec<(f64, f64, f64)> = (1..=DRAWS).map(found).collect();
    let held = all.iter().filter(|(value, std, _)| (value - 12.0).abs() <= 2.0 * std).count();
    // Two standard uncertainties with seven degrees of freedom hold 91 % (Student); 120 draws scatter by 2.6
    // %.
    assert!(held as f64 >= 0.85 * DRAWS as f64, "{held} of {DRAWS}");
    // Steps that scatter by σ make the mean step of n samples uncertain by σ·√(6/(5n)).
    let expected = WANDER / 9.9988e-3 * (6.0 / 5.0 / 1000f64).sqrt();
    let mean = all.iter().map(|(_, _, clock)| clock.powi(2)).sum::<f64>() / DRAWS as f64;
    // The mean of 120 variances with seven degrees of freedom scatters by 5 %.
    assert!((mean.sqrt() / expected - 1.0).abs() < 0.15, "{} of {expected}", mean.sqrt());
}

/// Times are printed in whole milliseconds, at sampling rates whose step is no whole millisecond. Every
/// second record lacks one sample.
#[test]
fn a_tone_lies_within_its_uncertainty_where_times_have_few_digits() {
    for seed in 1..=DRAWS / 2 {
        let mut noise = Noise::new(seed);
        let (rate, frequency) = (noise.between(200.0, 1600.0), noise.between(10.0, 60.0));
        let lost = if seed.is_multiple_of(2) { 2000 } else { usize::MAX };
        let mut row = |i: usize| {
            let t = i as f64 / rate;
            let value = (std::f64::consts::TAU * frequency * t).sin() + 1e-2 * noise.normal();
            format!("{:.3},{value:.5}\n", (1e3 * t).floor() / 1e3)
        };
        let rows: String = (0..6000).filter(|i| *i != lost).map(&mut row).collect();
        let text = format!("time (s),a (m/s^2)\n{rows}");
        let read = |stretch| {
            let read = Reader::new().stretch(stretch).from_reader("a.csv", text.as_bytes()).expect("read");
            let number = read.all_findings().iter().find_map(|found| found.get("longest"));
            (read.trace(None, None).expect("a trace"), number)
        };
        let (trace, longest) = read(None);
        assert_eq!(trace.rate().is_none(), seed.is_multiple_of(2), "{rate} Hz");
        let trace = longest.map_or(trace, |number| read(Some(number as usize)).0);
        let found = &tones(&trace, 1).expect("a sine").tones[0].frequency;
        let std = found.std.expect("an uncertainty");
        assert!(
            (found.value - frequency).abs() <= 3.5 * std,
            "{rate} Hz: {} ± {std}, not {frequency}",
            found.value
        );
        // Where steps are shorter than the last printed digit, one or two of 4000 samples may be lost
        // unnoticed.
        assert!(std < 1.5 / 3900.0 * frequency, "{rate} Hz: {std}");
    }
}
