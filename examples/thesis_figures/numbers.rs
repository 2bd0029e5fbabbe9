//! The waterfall of the rig, and numbers of chapters 5 and 6.

use crate::scene::grid;
use crate::sheet::{Claim, Sheet};
use std::f64::consts::{PI, TAU};
use std::path::Path;
use vibroimpact::Result;
use vibroimpact::analysis;
use vibroimpact::analysis::figures;
use vibroimpact::measure::drill::{AngleOrigin, Beam};
use vibroimpact::measure::pulse::{KelvinVoigt, LowPass, PulseOptions, two_times};
use vibroimpact::measure::response::ResponseOptions;
use vibroimpact::measure::restitution::Drop;
use vibroimpact::measure::waterfall::waterfall;
use vibroimpact::model::Rig;

/// The measured waterfalls are lost. The example campaign replaces them: a simulated rig with the same
/// numbers, swept in steps.
pub fn spectra() -> Result<Sheet> {
    let campaign =
        analysis::open(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_mass_rig/campaign.toml"))?;
    let options = ResponseOptions::default();
    let points = |name: &str| -> Result<_> {
        Ok(analysis::named(&campaign, Some(name))?.sweep_and_response(&options)?.1.points)
    };
    let (up, down, passive) = (points("mass 1, up")?, points("mass 1, down")?, points("mass 2, up")?);
    let above = up.iter().filter(|p| p.excitation > 8.0);
    let top = above.max_by(|a, b| a.amplitude.value.total_cmp(&b.amplitude.value));
    let (at, high) = top.map_or((f64::NAN, f64::NAN), |p| (p.excitation, p.amplitude.value));
    // Both directions have the same frequencies.
    let there = down.iter().min_by(|a, b| (a.excitation - at).abs().total_cmp(&(b.excitation - at).abs()));
    let low = there.map_or(f64::NAN, |p| p.amplitude.value);
    let (sweep, response) = analysis::named(&campaign, Some("mass 1, up"))?.sweep_and_response(&options)?;
    let figure = figures::waterfall(&waterfall(&sweep, &options, &response), Some(20.0))?
        .height(95.0)
        .caption("Spectra of the excited mass of the example campaign (a simulated rig with the numbers of the thesis' one, 0.1 N), sweeping up.");
    let mut claims = vec![
        Claim::told(
            "5.4 and 5.8: clapping resonance on the rig",
            "only going up",
            format!("at {at:.2} Hz up {:.2} mm, down {:.2} mm", 1e3 * high, 1e3 * low),
            low < 0.2 * high,
            "with larger forces the sweeps of chapter 4 find it going down, too",
        )
        .only_with("0.1 N"),
    ];
    let first = up.iter().filter(|p| p.excitation < 8.0).map(|p| p.amplitude.value).fold(0.0, f64::max);
    let between = up.iter().zip(&passive).filter(|(p, _)| (6.0..9.0).contains(&p.excitation));
    let least = between.min_by(|a, b| a.0.amplitude.value.total_cmp(&b.0.amplitude.value));
    let [x1, x2] = least.map_or([f64::NAN; 2], |(a, b)| [a.amplitude.value, b.amplitude.value]);
    let [peak, other, small, large] = [first, high, x1, x2].map(|x| 1e3 * x);
    claims.push(Claim::told(
        "5.5 and 5.7: peaks, and the antiresonance between them",
        "first peak the larger; between, x₂ the larger",
        format!("{peak:.1} and {other:.1} mm; x₁ {small:.2} mm, x₂ {large:.2} mm"),
        first > high && x2 > x1,
        "",
    ));
    for (what, thesis) in [("at most", "11.5"), ("in the repeat", "9.5")] {
        let why = "the force of the rig is not known, and the peak moves with it";
        claims.push(Claim::number(format!("5.1.1: clapping resonance, {what}"), thesis, at, (2, "Hz"), why));
    }
    Ok(Sheet::new("waterfall", "Figures 5.4 to 5.11: sweeps of the rig", figure, claims))
}

/// A table without a picture.
fn alone(name: &'static str, title: &'static str, claims: Vec<Claim>) -> Sheet {
    Sheet { name, title, figure: None, claims }
}

/// Numbers of the rig.
pub fn rig() -> Sheet {
    let [first, second] = Rig::thesis().natural_frequencies();
    let fall = Drop { height: 0.57, ..Drop::default() };
    let given = "by construction, since section 5.1.3 takes the stiffness of this rig from it";
    let why = "it holds where the struck mass does not move";
    let stiffness = |mass: f64, hz: f64, printed| {
        let what = format!("5.1.3: stiffness of {mass} kg at {hz} Hz");
        let why = "k = m(2πf)², for which no equation is printed";
        Claim::number(what, printed, mass * (TAU * hz).powi(2), (2, "N/m"), why)
    };
    let claims = vec![
        Claim::number("5.13: natural frequency of the excited mass", "5.23", first, (3, "Hz"), given),
        Claim::number("5.15: natural frequency of the passive mass", "5.87", second, (3, "Hz"), given),
        stiffness(0.125, 5.23, "135"),
        stiffness(0.094, 5.87, "128"),
        Claim::number(
            "5.18 and 5.2: restitution, drop from 0.57 m, 0.144 s",
            "0.2",
            fall.restitution(0.144),
            (4, ""),
            why,
        ),
    ];
    alone("rig_numbers", "Figures 5.13 to 5.18: numbers of the rig", claims)
}

/// The contact of table 6.4: as printed, and as seen through the low-pass of its amplifier.
fn contact() -> Result<Vec<Claim>> {
    let mut claims = Vec::new();
    for (run, to_peak, xi, frequency) in [(1, 6.64e-6, "0.181", "25.0"), (2, 6.25e-6, "0.207", "24.6")] {
        let found = two_times(to_peak, 18.0e-6, None, &PulseOptions::default())?;
        let why = "a closed form in the place of a search by steps";
        let of = |what: &str| format!("table of 6.4, run {run}: {what}");
        claims.push(Claim::number(of("ξ from its two times"), xi, found.xi.value, (4, ""), why));
        claims.push(Claim::number(of("f"), frequency, found.frequency.value / 1e3, (2, "kHz"), ""));
    }
    // The printed quotient α/ϑ at the ξ of run 1: with principal values, and with π subtracted in the
    // numerator.
    let xi = two_times(6.64e-6, 18.0e-6, None, &PulseOptions::default())?.xi.value;
    let root = (1.0 - xi * xi).sqrt();
    let above = (2.0 * xi * root / (1.0 - 2.0 * xi * xi)).atan();
    let below = ((4.0 * xi * xi - 1.0) * root / (xi * (3.0 - 4.0 * xi * xi))).atan();
    let [turned, plain] = [(above - PI) / below, above / below];
    claims.push(Claim::told(
        "6.4: ϑ is the whole pulse, α the time to its peak",
        "in the text; in the table ϑ 6.64 µs, α 18.0 µs",
        format!(
            "α/ϑ {turned:.3} with the numerator less π, {plain:.3} without; the table has {:.3}",
            18.0 / 6.64
        )
        .replace('-', "−"),
        false,
        "the text has the two swapped: the table and the formula have the peak as ϑ",
    ));
    let filter = LowPass::new(30e3, 2)?;
    let [peak, end] = filter.alone().unwrap_or([f64::NAN; 2]).map(|t| 1e6 * t);
    claims.push(Claim::told(
        "table of 6.4: what the low-pass of 30 kHz alone shows, second order",
        "6.64 and 6.25 µs to the peak, 18.0 µs in all",
        format!("{peak:.2} µs and {end:.1} µs"),
        false,
        "the filter alone, of an order that the thesis does not state, ends later than the pulse, so the table measures mostly the filter; `--low-pass 30000 --order 2` refuses the numbers",
    ));
    let mut seen = Vec::new();
    for (xi, f) in [0.05, 0.2, 0.4].into_iter().flat_map(|xi| [60e3, 100e3].map(|f| (xi, f))) {
        let Some(contact) = KelvinVoigt::new(xi, f) else { continue };
        let all = grid(0.0, 60e-6, 60_001);
        let value: Vec<f64> = all.iter().map(|t| contact.filtered(&filter, *t)).collect();
        let top = (1..value.len() - 1).find(|i| value[i + 1] < value[*i]).unwrap_or(0);
        let zero = (top..value.len()).find(|i| value[*i] < 0.0).unwrap_or(0);
        let read = two_times(all[top], all[zero], None, &PulseOptions::default())?;
        seen.push((read.xi.value, read.frequency.value / 1e3));
    }
    let range = |of: fn(&(f64, f64)) -> f64| {
        let all = || seen.iter().map(of);
        (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max))
    };
    let ((a, b), (low, high)) = (range(|s| s.0), range(|s| s.1));
    claims.push(Claim::told(
        "contacts of 60 to 100 kHz and ξ 0.05 to 0.4, read by two times behind it",
        "–",
        format!("ξ {a:.2} to {b:.2}, {low:.1} to {high:.1} kHz"),
        true,
        "behind the filter contacts of 60 and 100 kHz look alike",
    ));
    Ok(claims)
}

/// Numbers of the hammer drill.
pub fn drill() -> Result<Sheet> {
    let mut claims = Vec::new();
    for (angle, origin, why) in [
        ("from the normal to the motion", AngleOrigin::Normal, ""),
        ("from the line of motion", AngleOrigin::Axis, "it is 1/cos 30°"),
    ] {
        let what = format!("6.5: factor of a beam at 30° {angle}");
        claims.push(Claim::number(what, "2", Beam::new(30.0, origin)?.factor, (3, ""), why));
    }
    claims.extend(contact()?);
    let (speed, acceleration, jerk) = (7.5, 150_000.0, 6.9e9);
    for (name, thesis, value) in
        [("f₁, a/v", "20", acceleration / speed), ("f₂, jerk/a", "46", jerk / acceleration)]
    {
        let why = "the ratio is in rad/s: it is to be divided by 2π";
        claims.push(Claim::number(
            format!("6.18: bandwidth {name}"),
            thesis,
            value / TAU / 1e3,
            (2, "kHz"),
            why,
        ));
    }
    Ok(alone("drill_numbers", "Figures 6.5 to 6.18 and the table of 6.4", claims))
}
