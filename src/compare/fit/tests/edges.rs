//! Parameters at the ends of where they may lie, and answers that are no answers.

use super::*;

/// The answer of a campaign's entry from the example's noisy points.
fn answered(entry: &str, seed: u64, change: impl Fn(&mut Data)) -> Result<Fit> {
    println!("seed {seed}");
    let setting = example();
    let (clean, kinds) = truth(&setting, PACE);
    let mut data = noisy(&clean, &kinds, &setting, seed);
    change(&mut data);
    let entry: FitEntry = toml::from_str(entry).unwrap();
    let start = Setting { rig: Rig { restitution: 0.95, ..setting.rig }, ..setting };
    found(&data, &start, None, &[], &entry, PACE)
}

fn of(fit: &Fit, parameter: Parameter) -> &Fitted {
    fit.parameters.iter().find(|p| p.parameter == parameter).unwrap()
}

#[test]
fn bounds_that_the_points_contradict_leave_no_uncertainty() {
    let fit =
        answered("parameters = [\"restitution\", \"c2\"]\nbounds.restitution = [0.9, 0.97]", 31, |_| ())
            .unwrap();
    for fitted in &fit.parameters {
        assert!(fitted.estimate.std.is_none() && fitted.interval.is_none(), "{fitted:?}");
        assert!(fitted.reason.as_ref().is_some_and(|r| r.contains("restitution beyond 0.97")), "{fitted:?}");
    }
}

/// Without damper 2 the points pull nothing below 0; what c1 is known by does not rest on that.
#[test]
fn a_damper_that_is_not_there_is_told_from_nothing() {
    let setting = example().with(Parameter::C2, 1e-9);
    let (clean, kinds) = truth(&setting, PACE);
    println!("seed 32");
    let data = noisy(&clean, &kinds, &setting, 32);
    let entry: FitEntry = toml::from_str("parameters = [\"c1\", \"c2\"]").unwrap();
    let start = setting.with(Parameter::C2, 0.05).with(Parameter::C1, 0.12);
    let fit = found(&data, &start, None, &[], &entry, PACE).unwrap();
    let [c1, c2] = [Parameter::C1, Parameter::C2].map(|p| of(&fit, p));
    assert!(
        !c2.identifiable && c2.reason.as_ref().is_some_and(|r| r.contains("do not tell it from 0")),
        "{c2:?}"
    );
    // Four standard deviations are left in one of 16 000 cases.
    assert!((c1.estimate.value - 0.1).abs() < 4.0 * c1.estimate.std.unwrap(), "{c1:?}");
}

#[test]
fn as_many_points_as_parameters_tell_nothing_of_the_model() {
    let few = |data: &mut Data| {
        let clear: Vec<usize> = (0..40).filter(|i| data.steps[*i].clear().count() == 2).collect();
        for (i, step) in data.steps.iter_mut().enumerate() {
            if i != clear[clear.len() / 2] {
                step.seen = [None, None];
            }
        }
    };
    let fit = answered("parameters = [\"c2\", \"gap\"]", 33, few).unwrap();
    assert_eq!(fit.n, 2);
    assert!(fit.reduced_chi_squared.is_nan());
    assert!(
        fit.warnings.iter().any(|w| w.contains("nothing tells whether the model fits")),
        "{:?}",
        fit.warnings
    );
}

/// A calibration of 1 % that is not stated: ten times the noise, in a slope along frequency.
#[test]
fn residuals_that_are_no_noise_leave_no_uncertainty() {
    for seed in [34, 35, 36] {
        let wrong = |data: &mut Data| {
            *data = miscalibrated(data.clone(), 2e-2, seed);
            data.calibration = 0.0;
        };
        let fit = answered("parameters = [\"restitution\", \"c1\", \"c2\", \"gap\"]", seed, wrong).unwrap();
        assert!(
            fit.parameters.iter().all(|p| p.estimate.std.is_none() && !p.identifiable),
            "{:?}",
            fit.parameters
        );
        assert!(fit.warnings[0].contains("calibration"), "{}", fit.warnings[0]);
    }
}

#[test]
fn what_was_given_in_vain_is_said() {
    let fit =
        answered("parameters = [\"c2\"]\nprior.k1 = [130.0, 1.0]\nbounds.k2 = [50.0, 200.0]", 37, |_| ())
            .unwrap();
    for name in ["prior of k1", "bound of k2"] {
        assert!(fit.warnings.iter().any(|w| w.contains(name)), "{name}: {:?}", fit.warnings);
    }
}
