use super::*;
use crate::synthetic::{Normal, trace};

/// Samples of 1 kHz: modes (frequency, damping ratio, amplitude, phase) from sample `onset` on, and white noise.
fn record(
    n: usize,
    onset: usize,
    modes: &[(f64, f64, f64, f64)],
    sigma: f64,
    normal: &mut Normal,
) -> Vec<f64> {
    let value = |i: usize, (f, zeta, a, phase): &(f64, f64, f64, f64)| {
        let (t, w) = ((i - onset) as f64 * 1e-3, TAU * f);
        a * (-zeta * w * t).exp() * (w * (1.0 - zeta * zeta).sqrt() * t + phase).cos()
    };
    let free = |i: usize| if i < onset { 0.0 } else { modes.iter().map(|m| value(i, m)).sum() };
    (0..n).map(|i| free(i) + sigma * normal.next()).collect()
}

fn found(values: Vec<f64>) -> Result<DecayResult> {
    decay(&trace(values), &DecayOptions::default())
}

/// Deviation in stated standard uncertainties.
fn off(estimate: &Estimate, truth: f64) -> f64 {
    (estimate.value - truth) / estimate.std.unwrap()
}

#[test]
fn coverage() {
    let mut normal = Normal(7);
    let (mut inside, mut all, mut worst, mut none, mut refused) = (0, 0, 0.0f64, 0, 0);
    for i in 0..300 {
        let f = 20.0 + 180.0 * normal.uniform();
        let zeta = 10f64.powf(-2.5 + 1.5 * normal.uniform());
        let sigma = 10f64.powf(-3.0 + 1.5 * normal.uniform());
        let values = record(6000, 700, &[(f, zeta, 1.0, 6.0 * normal.uniform())], sigma, &mut normal);
        match found(values) {
            Ok(found) => {
                let mode = &found.modes[0];
                if found.modes.len() != 1 || mode.zeta.std.is_none() {
                    println!(
                        "{i}: f {f:.2} zeta {zeta:.4} sigma {sigma:.4}: {} modes {:?}",
                        found.modes.len(),
                        found.findings
                    );
                    none += 1;
                    continue;
                }
                for off in [off(&mode.zeta, zeta), off(&mode.frequency, f)] {
                    all += 1;
                    inside += usize::from(off.abs() < 1.96);
                    if off.abs() > worst {
                        worst = off.abs();
                        println!(
                            "{i}: {f:.2} {zeta:.4} {sigma:.4} off {off:.2} {:?} part {} {}",
                            mode.zeta, found.start, found.end
                        );
                    }
                }
            }
            Err(error) => {
                println!("{i}: f {f:.2} zeta {zeta:.4} sigma {sigma:.4}: {error}");
                refused += 1;
            }
        }
    }
    println!("inside {inside} of {all}, worst {worst}, none {none}, refused {refused}");
    assert!(false);
}
