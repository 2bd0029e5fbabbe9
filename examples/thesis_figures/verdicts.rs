//! Where the energy rule of the thesis accepts unstable or impossible orbits, and what observable motions
//! look like.

use crate::impulse::IMPULSE;
use crate::scene::{self, accepted, grid, hertz, ratio, real, rig, under_impulses, under_sine};
use crate::sheet::{Claim, Sheet};
use crate::sweeps::{only_up, without_duration};
use ndarray::Array2;
use vibroimpact::analysis::figures;
use vibroimpact::figure::{AxisSpec, Figure, Heatmap, Ink, Legend, Plot, Series};
use vibroimpact::model::{ChangeKind, Excitation, Impulses, Loss, Orbit, Rig, Sine, orbits_of, response};
use vibroimpact::{Error, Result};

pub fn sheets() -> Result<Vec<Sheet>> {
    let mut all = vec![multipliers()?, inadmissible()?];
    all.extend(traces()?);
    all.push(branches()?);
    all.push(regions()?);
    Ok(all)
}

/// The orbit that the energy rule accepts.
fn one(restitution: f64, force: f64, nu: f64) -> Result<Orbit> {
    let found = under_sine(&rig(restitution), force, nu);
    accepted(&found).cloned().ok_or_else(|| Error::refused(format!("no motion at ν {nu}")))
}

fn multipliers() -> Result<Sheet> {
    let nu = grid(1.0, 2.3, 1041);
    let mut plot =
        Plot::new(ratio(1.0, 2.3), AxisSpec::new("Largest multiplier, modulus", "").limits(0.9, 1.7))
            .legend(Legend::Above)
            .with(Series::horizontal("border of stability", 1.0));
    for (nth, force) in [0.9, 0.05].into_iter().enumerate() {
        let radius = |nu: &f64| {
            one(1.0, force, *nu)
                .ok()
                .filter(|o| o.validity.admissible)
                .and_then(|o| o.spectral_radius())
                .unwrap_or(f64::NAN)
        };
        let y: Vec<f64> = nu.iter().map(radius).collect();
        plot = plot.with(Series::line(format!("F₀ {force} N"), nu.clone(), y).ink(Ink::Nth(nth)));
    }
    let flip = one(1.0, 0.9, 1.2)?;
    let pair = one(1.0, 0.05, 1.3)?;
    let [m, n] = [&flip, &pair].map(|o| o.multipliers.map_or_else(num_complex::Complex64::default, |m| m[0]));
    plot =
        plot.note(format!("flip, −{:.3}", m.re.abs()), 1.2, m.norm()).note("Neimark–Sacker", 1.3, n.norm());
    let stable = |o: &Orbit| o.validity.stable == Some(true) || !o.validity.energy_rule;
    let why = "the rule sees no loss but that of one multiplier through +1";
    let claims = vec![
        Claim::told(
            "F₀ 0.9 N, R 1, ν 1.2: the positive root",
            "stable",
            format!(
                "{}, multiplier −{:.3}",
                flip.validity.instability.map_or("stable", Loss::name),
                m.re.abs()
            ),
            stable(&flip),
            why,
        ),
        Claim::told(
            "F₀ 0.05 N, R 1, ν 1.3: the positive root",
            "stable",
            format!(
                "{}, multipliers {:.3} ± {:.3}i",
                pair.validity.instability.map_or("stable", Loss::name),
                n.re,
                n.im.abs()
            ),
            stable(&pair),
            why,
        ),
    ];
    let figure = Figure::single("Multipliers").height(70.0).panel(plot).caption(
        "Largest Floquet multiplier of the motions that the energy rule accepts and in which the masses do not pass through each other, R = 1.",
    );
    Ok(Sheet::new(
        "verdict_multipliers",
        "Beside 3.54: the positive root is not always stable",
        figure,
        claims,
    ))
}

fn inadmissible() -> Result<Sheet> {
    let rig = rig(0.7);
    let orbit = one(0.7, 0.5, 0.8)?;
    let figure = figures::orbit("Inadmissible orbit", &rig, &orbit).height(70.0);
    let depth = -1e3 * orbit.validity.min_gap;
    let why = "the masses would pass through each other here, too, not in the two peaks of 3.6 alone";
    let claims = vec![Claim::told(
        "3.7, F₀ 0.5 N, R 0.7, ν 0.8: the positive root",
        "drawn as possible",
        format!("impossible, by {depth:.1} mm"),
        orbit.validity.admissible,
        why,
    )];
    Ok(Sheet::new(
        "verdict_inadmissible",
        "Figures 3.5 and 3.6: a positive root that is no motion",
        figure,
        claims,
    ))
}

/// Phase angle in degrees by which x₂ leads x₁ at the excitation frequency, −180 to 180.
fn lead(orbit: &Orbit) -> f64 {
    (orbit.fundamental[1] / orbit.fundamental[0]).arg().to_degrees()
}

/// Both masses over time at a resonance, with the parameters of the thesis.
struct Trace {
    name: &'static str,
    title: &'static str,
    nu: f64,
    excitation: Excitation,
    in_phase: bool,
}

fn traces() -> Result<Vec<Sheet>> {
    let rig = Rig { c1: 0.0, c2: 0.0, ..rig(0.7) };
    let sine = |force, nu| Excitation::Sine(Sine { force, frequency: hertz(nu) });
    let train = |nu| Excitation::Impulse(Impulses { impulse: IMPULSE, frequency: hertz(nu) });
    let all = [
        (
            "trace_clapping",
            "Figure 3.8: clapping resonance over time, sine of 0.5 N",
            2.13,
            sine(0.5, 2.13),
            false,
        ),
        (
            "trace_grazing",
            "Figure 3.9: grazing resonance over time, sine of 0.05 N",
            1.05,
            sine(0.05, 1.05),
            true,
        ),
        ("impulse_grazing", "Figure 3.16: grazing resonance over time, impulses", 1.05, train(1.05), true),
        ("impulse_clapping", "Figure 3.17: clapping resonance over time, impulses", 2.13, train(2.13), false),
    ];
    let all =
        all.map(|(name, title, nu, excitation, in_phase)| Trace { name, title, nu, excitation, in_phase });
    all.into_iter().map(|trace| traced(&rig, &trace)).collect()
}

/// Least and largest x₁ in mm of an orbit, from 200 instants of its period.
fn x1_of(orbit: &Orbit) -> (f64, f64) {
    let x1 = (0..200).map(|i| 1e3 * orbit.state(f64::from(i) / 200.0 * orbit.period()).x1);
    x1.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)))
}

fn traced(rig: &Rig, trace: &Trace) -> Result<Sheet> {
    let found = orbits_of(rig, &trace.excitation, 1)?.orbits;
    let orbit = accepted(&found).ok_or_else(|| Error::refused(format!("no motion at ν {}", trace.nu)))?;
    let lead = lead(orbit);
    let agrees = real(orbit) && (lead.abs() < 90.0) == trace.in_phase;
    let [first, second] = orbit.peak_to_peak.map(|p| 500.0 * p);
    let here = format!(
        "phase of x₂ to x₁ {lead:.0}°, amplitudes {first:.2} and {second:.2} mm, {}",
        orbit.validity.stability()
    );
    let claim = Claim::told(
        format!("motion of both masses at ν {}, R 0.7, c₁ and c₂ 0", trace.nu),
        match (trace.in_phase, trace.name) {
            (true, _) => "in phase",
            (false, "trace_clapping") => "out of phase, x₁ the larger",
            (false, _) => "out of phase",
        },
        here.replace('-', "−"),
        agrees,
        "",
    );
    let mut claims = vec![claim];
    if trace.name == "impulse_clapping" {
        let (least, most) = x1_of(orbit);
        claims.push(Claim::told(
            "3.14: x₁ in the clapping resonance, R 0.7, c₁ and c₂ 0",
            "negative",
            format!("{:.2} mm at the impact, {least:.2} to {most:.2} mm", 1e3 * orbit.state(0.0).x1)
                .replace('-', "−"),
            -least > most,
            "its larger side is, which jidnew draws; at the impact x₁ is above 0",
        ));
        let rig = Rig { c2: 0.0, ..scene::rig(1.0) };
        let found = under_impulses(&rig, IMPULSE, 2.13);
        let orbit = accepted(&found).ok_or_else(|| Error::refused("no motion at ν 2.13 with R 1"))?;
        let (least, most) = x1_of(orbit);
        claims.push(Claim::told(
            "3.13: x₁ in the clapping resonance, R 1, c₁ 0.1, c₂ 0",
            "negative",
            format!("{least:.1} to {most:.2} mm").replace('-', "−"),
            most < 0.0,
            "throughout",
        ));
    }
    let figure = figures::orbit(trace.title, rig, orbit).height(70.0);
    Ok(Sheet::new(trace.name, trace.title, figure, claims))
}

fn branches() -> Result<Sheet> {
    let rig = rig(0.98);
    let sine = Excitation::Sine(Sine { force: 0.1, frequency: 1.0 });
    let found = response(&rig, &sine, 3.0, 14.0, 700, 1)?;
    let top =
        found.changes.iter().filter(|c| c.kind == ChangeKind::Fold).map(|c| c.frequency).fold(0.0, f64::max);
    let mut claim = Claim::told(
        "clapping resonance",
        "only when sweeping up",
        format!(
            "with R 0.98 and 0.1 N its branch ends in a fold at {top:.2} Hz, the motion without impacts is stable beside it"
        ),
        true,
        "",
    );
    for restitution in [0.98, 0.7] {
        let mut tried = Vec::new();
        for force in [0.1, 0.2, 0.5, 1.0] {
            tried.push((force, only_up(&without_duration(&scene::rig(restitution), force)?)));
        }
        claim = claim.of_forces(&format!("R {restitution} and "), &tried);
    }
    let claims = vec![claim];
    let figure = figures::branches("Response with all its branches", &found, None).height(125.0);
    Ok(Sheet::new(
        "branches",
        "Beside 4.11 to 4.15: response with its branches and the backbone",
        figure,
        claims,
    ))
}

/// Classes of the root that the energy rule accepts.
const CLASSES: [&str; 6] =
    ["none with J > 0", "masses pass", "flip", "Neimark–Sacker", "real", "two beyond +1"];

/// Index of the class of these orbits; NaN, which is drawn white, if it is none of them.
fn class(orbits: &[Orbit]) -> f64 {
    let Some(orbit) = accepted(orbits) else { return 0.0 };
    match (orbit.validity.admissible, orbit.validity.instability) {
        (false, _) => 1.0,
        (true, Some(Loss::Flip)) => 2.0,
        (true, Some(Loss::NeimarkSacker)) => 3.0,
        (true, None) => 4.0,
        // One multiplier beyond +1 breaks the energy rule, so here there are two, as a Neimark–Sacker pair
        // can become.
        (true, Some(Loss::Fold)) => 5.0,
        (true, Some(Loss::Grazing)) => f64::NAN,
    }
}

fn regions() -> Result<Sheet> {
    let nu = grid(0.6, 2.4, 181);
    let (restitution, force) = (grid(0.0, 1.0, 51), grid(0.02, 1.0, 50));
    let by = |rows: &[f64], of: &dyn Fn(f64, f64) -> Vec<Orbit>| {
        Array2::from_shape_fn((rows.len(), nu.len()), |(row, column)| class(&of(rows[row], nu[column])))
    };
    let over_r = by(&restitution, &|r, nu| under_sine(&rig(r), 0.5, nu));
    let over_f = by(&force, &|force, nu| under_sine(&rig(0.7), force, nu));
    let all = || over_r.iter().chain(&over_f);
    let accepted = all().filter(|c| **c != 0.0).count();
    let real = all().filter(|c| **c == 4.0).count();
    let passing = all().filter(|c| **c == 1.0).count();
    let [share, through] = [real, passing].map(|n| 100.0 * n as f64 / accepted as f64);
    let plot = |title: &str, label: &str, unit: &str| {
        Plot::new(ratio(0.6, 2.4), AxisSpec::new(label, unit)).title(title)
    };
    let figure = Figure::double("Where the positive root is a motion")
        .height(90.0)
        .columns(2)
        .panel(plot("(a) F₀ 0.5 N", "Restitution R", "").heatmap(Heatmap::classes(&nu, &restitution, &over_r, &CLASSES)?).legend(Legend::Hidden))
        .panel(plot("(b) R 0.7", "Force F₀", "N").heatmap(Heatmap::classes(&nu, &force, &over_f, &CLASSES)?).legend(Legend::Above))
        .caption(
            "The root that the energy rule accepts, over frequency and restitution or force: whether it is a motion that can be seen. At none \
             there is no root with J > 0; masses pass: they would pass through each other; two beyond +1: two real multipliers are.",
        );
    let claims = vec![Claim::told(
        "the positive roots of both maps",
        "stable",
        format!(
            "{share:.0} % possible and stable; in {through:.0} % the masses would pass through each other"
        ),
        real == accepted,
        "the rule is necessary, not sufficient",
    )];
    Ok(Sheet::new("regions", "Beside 3.54: regions of existence and stability", figure, claims))
}
