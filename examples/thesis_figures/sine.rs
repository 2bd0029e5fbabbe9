//! Closed form under a sine force: impulse over frequency, the sign of χ, the phase.

use crate::scene::{accepted, add_orbits, border, grid, hertz, peak, ratio, real, rig, under_sine};
use crate::sheet::{Claim, Sheet};
use vibroimpact::Result;
use vibroimpact::figure::{AxisSpec, Figure, Ink, Legend, Plot, Series, Stroke};
use vibroimpact::model::{Green, Orbit, Rig, Sine, Steady};

pub fn sheets() -> Result<Vec<Sheet>> {
    Ok(vec![forces(), restitutions(), sign()?, phases()?, additional_peak()])
}

fn impulse_axis() -> AxisSpec {
    AxisSpec::new("Impulse J", "N s").log()
}

/// Impulse of the real motion that the energy rule accepts.
pub fn impulse(rig: &Rig, force: f64, nu: f64) -> Option<f64> {
    accepted(&under_sine(rig, force, nu)).filter(|o| real(o)).map(|o| o.impulse)
}

/// C = χ₁(0) + χ₂(0) in m/(N s).
fn chi(nu: f64) -> Result<f64> {
    let rig = Rig::thesis();
    let [first, second] = rig.oscillators();
    let period = 1.0 / hertz(nu);
    Ok(Green::new(rig.m1, first, period)?.start + Green::new(rig.m2, second, period)?.start)
}

/// ν to which the clapping peak goes with the force: C = 0.
pub fn limit() -> f64 {
    border(2.0, 2.4, |nu| chi(nu).is_ok_and(|c| c < 0.0))
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
        claims.push(Claim::number(what, "1.05", at, (4, ""), 0.005, "it moves by 0.003 with the force"));
    }
    for force in all {
        let (at, _) = peak(1.5, 2.4, |nu| impulse(&rig, force, nu));
        let what = format!("clapping resonance, ν at F₀ {force} N");
        let why = "it moves with the force; a threshold of 1e-6, which equals Δ² in m², hid that";
        let why = if (at - 2.13).abs() <= 0.005 { "the force is large enough" } else { why };
        claims.push(Claim::number(what, "2.13", at, (3, ""), 0.005, why));
    }
    let limit = limit();
    let why = "it is where the peak goes with a large force: χ₁(0) + χ₂(0) = 0";
    claims.push(Claim::number(
        "clapping resonance, ν in the limit of large forces",
        "2.13",
        limit,
        (4, ""),
        0.005,
        why,
    ));
    let figure = Figure::double("Impulse over frequency for several forces").height(95.0).panel(plot).caption(
        "Impulse of all motions with one impact a cycle, R = 1. Coloured: those that can be and are stable; thin and grey: those \
         that are unstable or in which the masses would pass through each other.",
    );
    Sheet::new("sine_force", "Sine: impulse over frequency for several forces", figure, claims)
}

fn restitutions() -> Sheet {
    let nu = grid(0.75, 2.5, 1401);
    let mut plot = Plot::new(ratio(0.75, 2.5), impulse_axis().limits(1e-3, 1.0)).legend(Legend::Above);
    let mut claims = Vec::new();
    for (nth, restitution) in [1.0, 0.9, 0.7, 0.4].into_iter().enumerate() {
        let rig = rig(restitution);
        let name = format!("R {restitution}");
        plot = add_orbits(plot, &name, nth, &nu, |nu| under_sine(&rig, 0.5, nu), |o| o.impulse);
        let (at, _) = peak(1.5, 2.4, |nu| impulse(&rig, 0.5, nu));
        let why = "losses move it down, too; the same threshold hid that";
        claims.push(Claim::number(
            format!("clapping resonance, ν at R {restitution}"),
            "2.13",
            at,
            (3, ""),
            0.005,
            why,
        ));
    }
    plot = plot.with(Series::vertical("thesis, clapping", 2.13));
    let figure = Figure::double("Impulse over frequency for several restitutions")
        .height(95.0)
        .panel(plot)
        .caption("Impulse of all motions with one impact a cycle, F₀ = 0.5 N; colours as above.");
    Sheet::new("sine_restitution", "Sine: impulse over frequency for several restitutions", figure, claims)
}

fn sign() -> Result<Sheet> {
    let nu = grid(0.75, 2.5, 1401);
    let values: Vec<f64> = nu.iter().map(|nu| chi(*nu)).collect::<Result<_>>()?;
    let plot = Plot::new(ratio(0.75, 2.5), AxisSpec::new("χ₁(0) + χ₂(0)", "m/(N s)"))
        .with(Series::line("", nu, values).stroke(Stroke::Solid))
        .with(Series::horizontal("", 0.0))
        .with(Series::vertical(
            "clapping peak, F₀ 0.5 N, R 1",
            peak(1.5, 2.4, |nu| impulse(&rig(1.0), 0.5, nu)).0,
        ))
        .legend(Legend::Hidden);
    let negative = |nu: f64| chi(nu).is_ok_and(|c| c < 0.0);
    let (low, high) = (border(1.06, 1.2, negative), limit());
    let why =
        "with χ outside the root 3.33 and 3.42 pick the other root where χ < 0, and are 0·∞ at the ends";
    let claims = vec![Claim::told(
        "χ₁(0) + χ₂(0) on the clapping branch",
        "equations as for a positive one",
        format!("negative for ν {low:.3} to {high:.3}"),
        false,
        why,
    )];
    let figure = Figure::single("The sign of χ").panel(plot).caption(
        "χ₁(0) + χ₂(0): displacement of both masses at the impact under a unit impulse once a cycle.",
    );
    Ok(Sheet::new("sine_sign", "Sine: the sign of χ", figure, claims))
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
    Ok(Sheet::new("sine_phase", "Sine: phase at the impact", figure, claims))
}

/// J near ν = 1 with M(1 + R), and with M alone in its place: that is R = 0 in the closed form.
fn additional_peak() -> Sheet {
    let nu = grid(0.9, 1.1, 801);
    let mut plot = Plot::new(ratio(0.9, 1.1), AxisSpec::new("Impulse J", "N s").limits(0.0, f64::NAN));
    let mut tops = Vec::new();
    for (nth, (restitution, name)) in
        [(1.0, "M(1 + R), R = 1"), (0.0, "M in its place")].into_iter().enumerate()
    {
        let rig = rig(restitution);
        let value = |nu: f64| accepted(&under_sine(&rig, 0.5, nu)).map_or(f64::NAN, |o| o.impulse);
        let all: Vec<f64> = nu.iter().map(|nu| value(*nu)).collect();
        let near = nu
            .iter()
            .zip(all.windows(3))
            .filter(|(nu, w)| (0.98..1.02).contains(*nu) && w[1] > w[0] && w[1] > w[2]);
        tops.push(near.count());
        let stroke = if nth == 0 { Stroke::Solid } else { Stroke::Dashed };
        plot = plot.with(Series::line(name, nu.clone(), all).ink(Ink::Nth(nth)).stroke(stroke));
    }
    plot = plot.with(Series::vertical("", 1.0));
    let told = |n: usize| if n == 0 { "none" } else { "one" };
    let why = "the right equations have none; the script that is said to have mistaken M(1 + R) is lost, and M alone in its place does not make one in them";
    let here = format!("{}; with M in the place of M(1 + R) {}", told(tops[0]), told(tops[1]));
    let claims = vec![Claim::told(
        "additional peak at ν = 1",
        "one, the masses pass through each other",
        here,
        tops[0] > 0,
        why,
    )];
    let figure = Figure::single("Impulse near ν = 1").panel(plot).caption(
        "Impulse of the motion that the energy rule accepts near the natural frequency of the excited mass, F₀ = 0.5 N.",
    );
    Sheet::new("sine_extra_peak", "Sine: no additional peak at ν = 1", figure, claims)
}
