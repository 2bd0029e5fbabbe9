//! Compliant contacts.

use super::*;
use crate::compare::simulated::simulated;
use crate::model::Law;

/// Noisy sweeps of a rig whose contact is a spring and a damper, with the stiffness in N/m.
fn soft(setting: &Setting, stiffness: f64, seed: u64) -> Data {
    let (clean, kinds) = truth(setting, PACE);
    let mut data = noisy(&clean, &kinds, setting, seed);
    let mut normal = Noise::new(900 + seed);
    for _ in 0..16 {
        normal.normal();
    }
    let rig = &setting.rig;
    let law = Law::kelvin_voigt(stiffness, rig.restitution, rig.reduced_mass()).unwrap();
    for sequence in data.sequences.clone() {
        let points: Vec<(f64, f64)> =
            sequence.iter().map(|i| (clean.steps[*i].frequency, data.steps[*i].force)).collect();
        let came = simulated(&setting.rig, Some(law), &points, PACE);
        for (i, came) in sequence.iter().zip(&came) {
            let Ok(came) = came else { continue };
            for (seen, amplitude) in data.steps[*i].readings.iter_mut().zip(came.amplitude) {
                if let Some(seen) = seen {
                    seen.amplitude = (amplitude + seen.std * normal.normal()).abs().max(seen.std);
                    seen.upper_limit = (amplitude < FAINT * seen.std).then_some(3.0 * seen.std);
                }
            }
        }
    }
    data
}

const NAMES: &str = "parameters = [\"restitution\", \"c1\", \"c2\", \"gap\"]";

/// Kelvin–Voigt contacts that last 0.5 and 0.15 % of the period at resonance. With the stiffness stated the
/// rig is found; without it no uncertainty is stated.
#[test]
fn the_stiffness_of_the_contact_is_allowed_for() {
    allowed_for(&[(1e7, 42)], Some(1));
}

#[test]
#[ignore = "Monte Carlo: cargo test --release -- --ignored"]
fn the_stiffness_of_the_contact_is_allowed_for_from_all_starts() {
    allowed_for(&[(1e6, 41), (1e7, 42)], None);
}

/// Stiffnesses with their seeds; the last is also fitted without being stated.
fn allowed_for(contacts: &[(f64, u64)], starts: Option<usize>) {
    let setting = example();
    let entry = FitEntry { starts, ..toml::from_str(NAMES).unwrap() };
    let start = setting.with(Parameter::Gap, 1.1e-3).with(Parameter::C1, 0.08);
    println!("{contacts:?}");
    let drawn: Vec<(f64, Data)> =
        contacts.iter().map(|(stiffness, seed)| (*stiffness, soft(&setting, *stiffness, *seed))).collect();
    let blind = found(&drawn.last().unwrap().1, &start, None, &[], &entry).unwrap();
    assert!(blind.parameters.iter().all(|p| p.estimate.std.is_none()), "{:?}", blind.parameters);
    for (stiffness, data) in drawn {
        let fit = found(&data, &start, Some(stiffness), &[], &entry).unwrap();
        for found in &fit.parameters {
            let Estimate { value, std, .. } = found.estimate;
            let away = (value - setting.get(found.parameter)) / std.unwrap_or(f64::NAN);
            // Four standard deviations of eight values: exceeded in one of 2000 cases.
            assert!(away.abs() < 4.0, "{stiffness:e}: {found:?} lies {away} off");
        }
    }
}
