//! Closed form under a sine force: impulse over frequency, the sign of χ, the phase.

use crate::programs;
use crate::scene::{accepted, add_orbits, border, grid, hertz, peak, ratio, real, rig, under_sine};
use crate::sheet::{Claim, Sheet};
use std::f64::consts::TAU;
use vibroimpact::Result;
use vibroimpact::figure::{AxisSpec, Figure, Legend, Plot, Series, Stroke};
use vibroimpact::model::{Green, Orbit, Rig, Sine, Steady};

pub fn sheets() -> Result<Vec<Sheet>> {
    Ok(vec![forces(), restitutions(), sign()?, phases()?])
}

fn impulse_axis() -> AxisSpec {
    AxisSpec::new("Impulse J", "N s").log()
}

/// Impulse in N s of the orbit that the energy rule accepts, if it can be observed.
pub fn impulse(rig: &Rig, force: f64, nu: f64) -> Option<f64> {
    accepted(&under_sine(rig, force, nu)).filter(|o| real(o)).map(|o| o.impulse)
}

/// C = χ₁(0) + χ₂(0) in m/(N s).
fn chi(rig: &Rig, nu: f64) -> Result<f64> {
    let [first, second] = rig.oscillators();
    let period = 1.0 / hertz(nu);
    Ok(Green::new(rig.m1, first, period)?.start + Green::new(rig.m2, second, period)?.start)
}

/// ν that the clapping peak approaches with increasing force, where C = 0.
pub fn limit() -> f64 {
    border(2.0, 2.4, |nu| chi(&Rig::thesis(), nu).is_ok_and(|c| c < 0.0))
}

fn forces() -> Sheet {
    let rig = rig(1.0);
    let all = [0.05, 0.1, 0.5, 0.9];
    let nu = grid(0.75, 2.5, 1401);
    let mut plot = Plot::new(ratio(0.75, 2.5), impulse_axis().limits(1e-3, 1.0)).legend(Legend::Above);
    for (nth, force) in all.into_iter().enumerate() {
        let name = format!("F₀ {force} N");
        plot = add_orbits(plot, &name, nth, &nu, |nu| under_sine(&rig, force, nu), |o| o.impulse);
    }
    plot =
        plot.with(Series::vertical("thesis, grazing", 1.05)).with(Series::vertical("thesis, clapping", 2.13));
    let mut claims = Vec::new();
    for force in all {
        let (at, _) = peak(1.0, 1.15, |nu| impulse(&rig, force, nu));
        let what = format!("grazing resonance, ν at F₀ {force} N");
        claims.push(Claim::number(what, "1.05", at, (4, ""), "it moves by 0.003 with the force"));
    }
    for force in all {
        let (at, _) = peak(1.5, 2.4, |nu| impulse(&rig, force, nu));
        let what = format!("clapping resonance, ν at F₀ {force} N");
        let why = "it moves with the force, which the program hides (see its table below)";
        claims.push(Claim::number(what, "2.13", at, (3, ""), if at < 2.11 { why } else { "" }));
    }
    let ratios = all.map(|force| force * rig.receptances(TAU * hertz(2.13))[0].norm() / rig.gap);
    claims.push(Claim::told(
        "3.4: second term of 3.65 beside the first at F₀ 0.9 N",
        "dominates, so that the backbone loses its shape",
        format!(
            "A/Δ at ν 2.13: {} for 0.05, 0.1, 0.5 and 0.9 N",
            ratios.map(|ratio| format!("{ratio:.2}")).join(", ")
        ),
        ratios[3] > 1.0,
        "with 0.5 N it is the larger, too; the shape itself was in a picture that is lost",
    ));
    let limit = limit();
    let why = "it is where the peak goes with a large force: χ₁(0) + χ₂(0) = 0";
    claims.push(Claim::number(
        "clapping resonance, ν in the limit of large forces",
        "2.13",
        limit,
        (4, ""),
        why,
    ));
    let figure = Figure::double("Impulse over frequency for several forces").height(95.0).panel(plot).caption(
        "Impulse of all motions with one impact a cycle, R = 1. Coloured: those that can be and are stable; thin and grey: those \
         that are unstable or in which the masses would pass through each other.",
    );
    Sheet::new("sine_force", "Figure 3.4: sine, impulse over frequency for several forces", figure, claims)
}

fn restitutions() -> Sheet {
    let nu = grid(0.75, 2.5, 1401);
    let mut plot = Plot::new(ratio(0.75, 2.5), impulse_axis().limits(1e-3, 1.0)).legend(Legend::Above);
    let undriven = Rig { c1: 0.0, ..rig(0.7) };
    let top = |rig: &Rig, low, high| peak(low, high, |nu| impulse(rig, 0.5, nu));
    let [(_, first), (at, second)] = [(1.0, 1.15), (1.5, 2.4)].map(|(low, high)| top(&undriven, low, high));
    let elastic = top(&rig(1.0), 1.5, 2.4).1;
    let here = format!(
        "{second:.3} N s at ν {at:.3}; first peak {first:.3} N s, second one with R 1 {elastic:.2} N s"
    );
    let mut claims = vec![Claim::told(
        "R 0.7, c₁ 0: second peak",
        "much reduced",
        here,
        second < first && second < 0.5 * elastic,
        "beside R 1, and beside the first peak",
    )];
    for (nth, restitution) in [1.0, 0.9, 0.7, 0.4].into_iter().enumerate() {
        let rig = rig(restitution);
        let name = format!("R {restitution}");
        plot = add_orbits(plot, &name, nth, &nu, |nu| under_sine(&rig, 0.5, nu), |o| o.impulse);
        let (right, _) = top(&rig, 1.5, 2.4);
        let program = programs::sine(restitution, 0.1, 0.5, programs::JSNEW);
        let (cut, _) = peak(1.5, 2.4, |nu| Some(programs::impulse(&program, nu)));
        claims.push(Claim::told(
            format!("R {restitution}, c₁ 0.1: ν of the clapping resonance"),
            "–",
            format!("{right:.3}; {cut:.3} with the threshold of jsnew"),
            true,
            "losses move it down; the threshold moves it by 0.014 at most, and hides nothing here",
        ));
    }
    plot = add_orbits(plot, "R 0.7, c₁ 0", 4, &nu, |nu| under_sine(&undriven, 0.5, nu), |o| o.impulse);
    plot = plot.with(Series::vertical("thesis, clapping", 2.13));
    let figure = Figure::double("Impulse over frequency for several restitutions")
        .height(95.0)
        .panel(plot)
        .caption("Impulse of all motions with one impact a cycle, F₀ = 0.5 N; colours as above. Figure 3.5 has R = 0.7 and c₁ = 0.");
    Sheet::new(
        "sine_restitution",
        "Figure 3.5: sine, impulse over frequency for several restitutions",
        figure,
        claims,
    )
}

fn sign() -> Result<Sheet> {
    let nu = grid(0.75, 2.5, 1401);
    let values: Vec<f64> = nu.iter().map(|nu| chi(&Rig::thesis(), *nu)).collect::<Result<_>>()?;
    let plot = Plot::new(ratio(0.75, 2.5), AxisSpec::new("χ₁(0) + χ₂(0)", "m/(N s)"))
        .with(Series::line("", nu, values).stroke(Stroke::Solid))
        .with(Series::horizontal("", 0.0))
        .with(Series::vertical(
            "clapping peak, F₀ 0.5 N, R 1",
            peak(1.5, 2.4, |nu| impulse(&rig(1.0), 0.5, nu)).0,
        ))
        .legend(Legend::Hidden);
    let damped = Rig::thesis();
    let undriven = Rig { c1: 0.0, ..damped };
    // Limits of the range around `inside` in which C is negative.
    let negative = |rig: &Rig, inside: f64, [low, high]: [f64; 2]| {
        [low, high].map(|end| border(inside, end, |nu| chi(rig, nu).is_ok_and(|c| c < 0.0)))
    };
    let [low, high] = negative(&damped, 2.0, [1.06, 2.4]);
    let [first, last] = negative(&damped, 1.03, [0.98, 1.1]);
    let [from, to] = negative(&undriven, 1.03, [0.98, 1.1]);
    let roots: Vec<f64> = under_sine(&rig(1.0), 0.5, 1.05).iter().map(|o| o.impulse).collect();
    let (right, other) = roots.iter().fold((f64::MIN, f64::MAX), |(a, b), j| (a.max(*j), b.min(*j)));
    let why = "with χ outside the root 3.33 and 3.42 pick the other root where χ < 0, and are 0·∞ at the ends; the programs have it inside";
    let claims = vec![
        Claim::told(
            "χ₁(0) + χ₂(0) on the clapping branch",
            "equations as for a positive one",
            format!("negative for ν {low:.3} to {high:.3}"),
            false,
            why,
        ),
        Claim::told(
            "χ₁(0) + χ₂(0) at the grazing resonance",
            "equations as for a positive one",
            format!(
                "negative for ν {first:.4} to {last:.4}, under impulses (c₁ left out) for ν {from:.4} to {to:.4}"
            ),
            false,
            "3.33 and 3.42 pick the other root at the resonance itself, too",
        ),
        Claim::told(
            "3.33 at ν 1.05, F₀ 0.5 N, R 1, positive root: J",
            format!("{other:.4} N s").replace('-', "−"),
            format!("{right:.4} N s"),
            other > 0.0,
            "χ < 0 outside the root turns its sign",
        ),
    ];
    let figure = Figure::single("The sign of χ").panel(plot).caption(
        "χ₁(0) + χ₂(0): displacement of both masses at the impact under a unit impulse once a cycle.",
    );
    Ok(Sheet::new("sine_sign", "Beside 3.33: the sign of χ", figure, claims))
}

fn phases() -> Result<Sheet> {
    let rig = rig(0.7);
    let nu = grid(0.75, 2.5, 1401);
    let mut plot =
        Plot::new(ratio(0.75, 2.5), AxisSpec::new("Phase φ", "°").limits(0.0, 360.0)).legend(Legend::Above);
    for (nth, force) in [0.1, 0.5].into_iter().enumerate() {
        let name = format!("F₀ {force} N");
        let value = |o: &Orbit| o.timing.to_degrees();
        plot = add_orbits(plot, &name, nth, &nu, |nu| under_sine(&rig, force, nu), value);
    }
    let steady = Steady::new(&rig, &Sine { force: 0.5, frequency: hertz(2.1) })?;
    let lag = -steady.response.arg().to_degrees();
    let printed = (-steady.response.im / steady.response.re).atan().to_degrees();
    let why = "the arctangent of a quotient loses the quadrant above ν = 1: atan2(cω, k − mω²)";
    let claims = vec![Claim::told(
        "lag of the linear motion behind the force at ν 2.1 by the formula of φ₂",
        format!("{printed:.2}°").replace('-', "−"),
        format!("{lag:.2}°"),
        (printed - lag).abs() < 0.1,
        why,
    )];
    let figure = Figure::double("Phase at the impact")
        .height(80.0)
        .panel(plot)
        .caption("Phase φ of the forced part A cos(ωt + φ) at the impact, R = 0.7; colours as above.");
    Ok(Sheet::new("sine_phase", "Beside φ₂: phase at the impact", figure, claims))
}
