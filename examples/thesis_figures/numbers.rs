//! The rig's waterfall, and numbers that stand without a figure.

use crate::sheet::{Claim, Sheet};
use std::f64::consts::TAU;
use std::path::Path;
use vibroimpact::Result;
use vibroimpact::analysis;
use vibroimpact::analysis::figures;
use vibroimpact::measure::drill::{AngleOrigin, Beam};
use vibroimpact::measure::pulse::{PulseOptions, two_times};
use vibroimpact::measure::response::ResponseOptions;
use vibroimpact::measure::restitution::Drop;
use vibroimpact::measure::waterfall::waterfall;
use vibroimpact::model::Rig;

/// The measured waterfalls are lost; the example campaign is a rig of the same numbers, swept in steps.
pub fn spectra() -> Result<Sheet> {
    let campaign =
        analysis::open(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_mass_rig/campaign.toml"))?;
    let options = ResponseOptions::default();
    let points = |name: &str| -> Result<_> {
        Ok(analysis::named(&campaign, Some(name))?.sweep_and_response(&options)?.1.points)
    };
    let (up, down) = (points("mass 1, up")?, points("mass 1, down")?);
    let above = up.iter().filter(|p| p.excitation > 8.0);
    let top = above.max_by(|a, b| a.amplitude.value.total_cmp(&b.amplitude.value));
    let (at, high) = top.map_or((f64::NAN, f64::NAN), |p| (p.excitation, p.amplitude.value));
    // Steps up and down have the same frequencies.
    let there = down.iter().min_by(|a, b| (a.excitation - at).abs().total_cmp(&(b.excitation - at).abs()));
    let low = there.map_or(f64::NAN, |p| p.amplitude.value);
    let (sweep, response) = analysis::named(&campaign, Some("mass 1, up"))?.sweep_and_response(&options)?;
    let figure = figures::waterfall(&waterfall(&sweep, &options, &response), Some(20.0))?
        .height(95.0)
        .caption("Spectra of the excited mass of the example campaign (a simulated rig with the numbers of the thesis' one, 0.1 N), sweeping up.");
    let claims = vec![
        Claim::told(
            "clapping resonance on the rig",
            "only going up",
            format!("at {at:.2} Hz up {:.2} mm, down {:.2} mm", 1e3 * high, 1e3 * low),
            low < 0.2 * high,
            "as in all sweeps above",
        ),
        Claim::told(
            "its frequency on the rig",
            "11.5 Hz, 9.5 Hz repeated",
            format!("{at:.2} Hz"),
            (9.5..11.5).contains(&at),
            "it lies between, and depends on the force",
        ),
    ];
    Ok(Sheet::new("waterfall", "Waterfall of a sweep up", figure, claims))
}

/// Numbers of the thesis that models and measurements give without a figure.
pub fn numbers() -> Result<Sheet> {
    let mut claims = Vec::new();
    let [first, second] = Rig::thesis().natural_frequencies();
    claims.push(Claim::number("natural frequency of the excited mass", "5.23", first, (3, "Hz"), 0.005, ""));
    claims.push(Claim::number("natural frequency of the passive mass", "5.87", second, (3, "Hz"), 0.005, ""));
    let fall = Drop { height: 0.57, ..Drop::default() };
    let why = "its R is rounded; it holds where the struck mass does not move";
    claims.push(Claim::number(
        "restitution, drop from 0.57 m, 0.144 s",
        "0.2",
        fall.restitution(0.144),
        (4, ""),
        0.05,
        why,
    ));
    for (run, to_peak, xi, frequency) in [(1, 6.64e-6, "0.181", "25.0"), (2, 6.25e-6, "0.207", "24.6")] {
        let found = two_times(to_peak, 18.0e-6, None, &PulseOptions::default())?;
        let why = "a closed form in the place of a search by steps";
        claims.push(Claim::number(
            format!("ξ of the contact, run {run}"),
            xi,
            found.xi.value,
            (4, ""),
            0.0005,
            why,
        ));
        claims.push(Claim::number(
            format!("its frequency, run {run}"),
            frequency,
            found.frequency.value / 1e3,
            (2, "kHz"),
            0.05,
            "",
        ));
    }
    let (speed, acceleration, jerk) = (7.5, 150_000.0, 6.9e9);
    for (name, thesis, value) in [("a/v", "20", acceleration / speed), ("jerk/a", "46", jerk / acceleration)]
    {
        let why = "the ratio is in rad/s: it is to be divided by 2π";
        claims.push(Claim::number(
            format!("bandwidth {name}"),
            thesis,
            value / TAU / 1e3,
            (2, "kHz"),
            0.5,
            why,
        ));
    }
    let normal = Beam::new(30.0, AngleOrigin::Normal)?;
    let why = "if the 30° are counted from the normal to the motion";
    claims.push(Claim::number("factor of a beam at 30°", "2", normal.factor, (3, ""), 1e-9, why));
    let why = "counted from the line of motion it is 1/cos 30°";
    claims.push(Claim::number(
        "factor of a beam at 30°",
        "2",
        Beam::new(30.0, AngleOrigin::Axis)?.factor,
        (3, ""),
        1e-9,
        why,
    ));
    Ok(Sheet { name: "numbers", title: "Numbers beside the figures", figure: None, claims })
}
