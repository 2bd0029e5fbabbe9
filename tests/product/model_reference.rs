//! Closed-form orbits against an independent implementation: every root on seven frequency grids.

use std::f64::consts::TAU;
use std::path::Path;
use vibroimpact::model::{Excitation, Impulses, Orbit, Rig, Sine, orbits_of};

/// One row of a reference file, in SI units; `fixtures/reference/README.md` describes the columns.
struct Row {
    nu: f64,
    omega: f64,
    impulse: f64,
    timing: f64,
    approach: f64,
    min_gap: f64,
    radius: f64,
    peak_to_peak: [f64; 2],
    admissible: bool,
    stable: bool,
}

/// The reference sampled each period at this many times.
const SAMPLES: f64 = 8000.0;

fn rows(text: &str) -> Vec<Row> {
    let row = |line: &str| {
        let v: Vec<f64> = line.split(',').map(|field| field.trim().parse().unwrap()).collect();
        assert_eq!(v.len(), 13, "{line}");
        Row {
            nu: v[0],
            omega: v[1],
            impulse: v[2],
            timing: v[3],
            approach: v[4],
            min_gap: v[5],
            radius: v[6],
            peak_to_peak: [v[9], v[10]],
            admissible: v[11] == 1.0,
            stable: v[12] == 1.0,
        }
    };
    text.lines().skip(1).map(row).collect()
}

/// Condition number of a root: largest |J| over the distance to the nearest other root, plus 1. It is large
/// near a fold, where two roots merge.
fn condition(all: &[Orbit], orbit: &Orbit) -> f64 {
    let nearest = all
        .iter()
        .filter(|other| other.timing != orbit.timing)
        .map(|other| (other.impulse - orbit.impulse).abs())
        .fold(f64::INFINITY, f64::min);
    let largest = all.iter().map(|o| o.impulse.abs()).fold(0.0, f64::max);
    1.0 + largest / nearest
}

fn check_file(name: &str, excitation: &Excitation, rig: &Rig) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/reference/orbits").join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    let rows = rows(&text);
    assert!(rows.len() > 250, "{name} holds {} rows", rows.len());
    let (mut worst, mut borders) = (0.0_f64, 0);
    let sine = matches!(excitation, Excitation::Sine(_));
    let find = |omega: f64| orbits_of(rig, &excitation.at_frequency(omega / TAU), 1).unwrap().orbits;
    for row in &rows {
        let found = find(row.omega);
        let place = format!("{name} ν {} J {} timing {}", row.nu, row.impulse, row.timing);
        // φ counts modulo 2π, τ modulo the period.
        let cycle = if sine { TAU } else { TAU / row.omega };
        let apart = |orbit: &Orbit| {
            let turn = (orbit.timing - row.timing).rem_euclid(cycle);
            turn.min(cycle - turn) / cycle
        };
        let orbit = found
            .iter()
            .min_by(|a, b| apart(a).total_cmp(&apart(b)))
            .unwrap_or_else(|| panic!("{place}: no root found"));
        let amplify = condition(&found, orbit);
        let tolerance = 1e-10 * amplify;
        let error = (orbit.impulse / row.impulse - 1.0).abs();
        worst = worst.max(error / amplify);
        assert!(error < tolerance, "{place}: {} ({error:e})", orbit.impulse);
        assert!(apart(orbit) < tolerance, "{place}: timing {}", orbit.timing);
        assert!((orbit.approach_velocity / row.approach - 1.0).abs() < tolerance, "{place}");
        borders += check_verdicts(row, orbit, &place);
        check_samples(row, orbit, &place);
    }
    // Each row has its own root: as many roots as rows at each frequency.
    for pair in rows.chunk_by(|a, b| a.omega == b.omega) {
        let count = find(pair[0].omega).len();
        assert_eq!(count, pair.len(), "ν {}", pair[0].nu);
    }
    println!("{name}: {} rows, worst J {worst:e}, {borders} on a border", rows.len());
    assert!(borders * 50 < rows.len(), "{name}: {borders} verdicts on a border");
}

/// Checks existence, stability and admissibility. Returns 1 for a row on a border, where verdicts may
/// differ: |spectral radius − 1| < 1e-9, or an overlap below 0.1 µm.
fn check_verdicts(row: &Row, orbit: &Orbit, place: &str) -> usize {
    let v = &orbit.validity;
    assert_eq!(v.exists, row.impulse > 0.0, "{place}");
    let radius = orbit.spectral_radius().unwrap_or(f64::NAN);
    let mut border = 0;
    if row.radius.is_nan() {
        assert!(radius.is_nan() && v.stable == Some(false) && !row.stable, "{place}: radius {radius}");
    } else {
        // Elements of the monodromy matrix scale with acceleration over approach velocity, and so do their
        // roundings; 40 is the assumed acceleration in m/s². A double multiplier is off by the square root
        // of it.
        let size = 1.0 + 40.0 / orbit.approach_velocity;
        let simple = (radius - row.radius).abs() < 1e-10 * size;
        let double = (radius - row.radius).abs() < (1e-15 * size).sqrt() * 10.0;
        assert!(simple || double, "{place}: radius {radius} for {}", row.radius);
        if (row.radius - 1.0).abs() < 1e-9 {
            border = 1;
        } else {
            assert_eq!(v.stable, Some(row.stable), "{place}");
        }
    }
    // The reference accepts an overlap of up to 0.1 µm; this library accepts none.
    if row.impulse > 0.0 && row.min_gap < 0.0 && row.min_gap > -1e-7 {
        border = 1;
    } else {
        assert_eq!(v.admissible, row.admissible, "{place}: min gap {} for {}", v.min_gap, row.min_gap);
    }
    border
}

/// The reference samples each period 8000 times. Exact extremes exceed sampled ones, at most by what lies
/// between two samples.
fn check_samples(row: &Row, orbit: &Orbit, place: &str) {
    let step = orbit.period() / SAMPLES;
    // Missed between samples: velocity × step at velocity jumps, acceleration × step² elsewhere. The
    // acceleration is at most max(ω, 40 rad/s)² × amplitude, since no natural frequency exceeds 40 rad/s.
    let mut slope = [0.0_f64; 2];
    for i in 0..=2000 {
        let state = orbit.state(orbit.period() * f64::from(i) / 2000.0);
        slope = [slope[0].max(state.v1.abs() * 1.01), slope[1].max(state.v2.abs() * 1.01)];
    }
    for (i, (exact, sampled)) in orbit.peak_to_peak.iter().zip(row.peak_to_peak).enumerate() {
        let top = row.omega.max(40.0).powi(2) * exact;
        let missed = slope[i] * step + top * step * step;
        let rounding = 1e-9 * exact;
        assert!(
            *exact >= sampled - rounding && exact - sampled <= missed + rounding,
            "{place}: peak to peak of x{} {exact} for {sampled}, at most {missed} missed",
            i + 1
        );
    }
    let top = row.omega.max(40.0).powi(2) * (orbit.peak_to_peak[0] + orbit.peak_to_peak[1]);
    let missed = (slope[0] + slope[1]) * step + top * step * step;
    let error = row.min_gap - orbit.validity.min_gap;
    assert!(
        error >= -1e-9 * row.min_gap.abs() - 1e-15 && error <= missed,
        "{place}: min gap {} for {}, at most {missed} missed",
        orbit.validity.min_gap,
        row.min_gap
    );
}

fn sine(force: f64) -> Excitation {
    Excitation::Sine(Sine { force, frequency: 1.0 })
}

const IMPULSE: Excitation = Excitation::Impulse(Impulses { impulse: 0.009, frequency: 1.0 });

#[test]
fn light_force_elastic_impacts() {
    check_file("sine_F0.1_R1_c0.1.csv", &sine(0.1), &Rig { restitution: 1.0, ..Rig::thesis() });
}

#[test]
fn medium_force() {
    check_file("sine_F0.5_R0.7_c0.1.csv", &sine(0.5), &Rig::thesis());
}

#[test]
fn medium_force_without_dampers() {
    check_file("sine_F0.5_R0.7_c0.csv", &sine(0.5), &Rig { c1: 0.0, c2: 0.0, ..Rig::thesis() });
}

#[test]
fn large_force_elastic_impacts() {
    check_file("sine_F0.9_R1_c0.1.csv", &sine(0.9), &Rig { restitution: 1.0, ..Rig::thesis() });
}

#[test]
fn impulses() {
    check_file("impulse_F0.009_R0.7_c0.1.csv", &IMPULSE, &Rig::thesis());
}

#[test]
fn impulses_on_a_damped_mass() {
    check_file("impulse_F0.009_R0.7_c1_0_c2_0.1.csv", &IMPULSE, &Rig { c1: 0.0, ..Rig::thesis() });
}

#[test]
fn impulses_elastic_impacts() {
    check_file("impulse_F0.009_R1_c0.1.csv", &IMPULSE, &Rig { restitution: 1.0, ..Rig::thesis() });
}
