//! Closed form under impulses, and the impact oscillator.

use crate::programs::{self, JIDTW};
use crate::scene::{accepted, add_orbits, border, grid, hertz, ratio, rig, under_impulses, under_sine};
use crate::sheet::{Claim, Sheet};
use std::f64::consts::PI;
use vibroimpact::Result;
use vibroimpact::analysis::figures;
use vibroimpact::figure::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};
use vibroimpact::model::portrait::{Portrait, PortraitOptions};
use vibroimpact::model::{Excitation, Impulses, Motion, Rig, Simulation};

/// Impulse of the thesis' examples in N s.
pub const IMPULSE: f64 = 0.009;

pub fn sheets() -> Result<Vec<Sheet>> {
    Ok(vec![impulses()?, damping(), absent()?])
}

fn impulse_axis() -> AxisSpec {
    AxisSpec::new("Impulse J", "N s").log()
}

/// The rig of a figure under impulses, without c₁: the equations of the thesis leave it out.
fn undriven(restitution: f64, c2: f64) -> Rig {
    Rig { c1: 0.0, c2, ..rig(restitution) }
}

pub fn exists(rig: &Rig, nu: f64) -> bool {
    under_impulses(rig, IMPULSE, nu).iter().any(|o| o.validity.exists)
}

/// Limits in ν of the range around 1.5 in which no motion has one impact a cycle.
pub fn without(rig: &Rig) -> [f64; 2] {
    [1.05, 2.45].map(|end| border(1.5, end, |nu| !exists(rig, nu)))
}

fn impulses() -> Result<Sheet> {
    let nu = grid(0.75, 2.5, 1401);
    let mut plot = Plot::new(ratio(0.75, 2.5), impulse_axis().limits(5e-4, 0.5)).legend(Legend::Above);
    let scenes = [("3.10", 1.0, 0.0), ("3.11", 0.7, 0.0), ("3.12", 0.7, 0.1)];
    let mut claims = Vec::new();
    let mut first = Vec::new();
    for (nth, (figure, restitution, c2)) in scenes.into_iter().enumerate() {
        let rig = undriven(restitution, c2);
        let find = |nu| under_impulses(&rig, IMPULSE, nu);
        plot = add_orbits(plot, &format!("R {restitution}, c₂ {c2}"), nth, &nu, find, |o| o.impulse);
        let at = |nu| find(nu).iter().filter(|o| o.validity.exists).map(|o| o.impulse).reduce(f64::max);
        let [one, two] = [at(1.0501), at(2.1301)];
        first.push(one.unwrap_or(f64::NAN));
        let equations = programs::impulses(restitution, c2, IMPULSE, &[]);
        let [a, b] = [equations.at(1.0501)?.timing, equations.at(2.1301)?.timing];
        let outside = format!("the roots of 3.42 have τ {a:.3} T and {b:.3} T: both are outside 0 < τ < T");
        let told = |j: Option<f64>| j.map_or_else(|| "no motion".to_owned(), |j| format!("{j:.4} N s"));
        let (thesis, agrees, why) = match figure {
            "3.10" => ("second much the larger", two > one, outside.as_str()),
            "3.11" => ("first dominates, second reduced", one > two && two.is_some(), ""),
            _ => ("first reduced by c₂", first[2] < first[1], ""),
        };
        let what = format!("{figure}, R {restitution}, c₂ {c2}: J at ν 1.0501 and 2.1301");
        claims.push(Claim::told(what, thesis, format!("{}, {}", told(one), told(two)), agrees, why));
        if figure == "3.10" {
            claims.push(with_damper(thesis));
        }
        let [from, to] = without(&rig);
        claims.push(Claim::told(
            format!("{figure}: ν without a motion of one impact a cycle"),
            "drawn over all ν",
            format!("{from:.4} to {to:.4}"),
            from > to,
            "3.15 asks for 0 < τ < T, and such roots have J < 0 there; 3.42 to 3.44 do not ask",
        ));
    }
    let figure = Figure::double("Impulse over frequency under impulses").height(95.0).panel(plot).caption(
        "Impulse of all motions with one impact a cycle under an impulse of 0.009 N s a cycle, c₁ = 0. Coloured: those that can be and are stable; \
         thin and grey: the others, such as those without losses, which are neutral.",
    );
    Ok(Sheet::new("impulse", "Figures 3.10 to 3.12: impulses, impulse over frequency", figure, claims))
}

/// Claim: the peaks of figure 3.10 as motions of the rig with its damper c₁, which the equations leave out.
fn with_damper(thesis: &str) -> Claim {
    let rig = Rig { c2: 0.0, ..rig(1.0) };
    let [one, two] = [1.0501, 2.1301]
        .map(|nu| accepted(&under_impulses(&rig, IMPULSE, nu)).map_or(f64::NAN, |o| o.impulse));
    Claim::told(
        "3.10 with c₁ 0.1, R 1, c₂ 0: J at ν 1.0501 and 2.1301",
        thesis,
        format!("{one:.4} N s, {two:.4} N s"),
        two > one,
        "with the rig's damper of the excited mass both are motions",
    )
}

fn damping() -> Sheet {
    let nu = grid(0.95, 1.12, 681);
    let with = rig(0.7);
    let without = Rig { c1: 0.0, ..with };
    let value =
        |rig: &Rig, nu: f64| accepted(&under_impulses(rig, IMPULSE, nu)).map_or(f64::NAN, |o| o.impulse);
    let mut plot = Plot::new(ratio(0.95, 1.12), AxisSpec::new("Impulse J", "N s").limits(0.0, 0.04));
    for (nth, (rig, name)) in [(&with, "c₁ 0.1 N s/m"), (&without, "c₁ ignored")].into_iter().enumerate()
    {
        let y: Vec<f64> = nu.iter().map(|nu| value(rig, *nu)).collect();
        plot = plot.with(Series::line(name, nu.clone(), y).ink(Ink::Nth(nth)));
    }
    plot = plot.with(Series::vertical("", 1.0501));
    let [right, printed] = [&with, &without].map(|rig| value(rig, 1.0501));
    let excess = 100.0 * (printed / right - 1.0);
    let why = format!(
        "c₁ is left out of 3.40 to 3.44, which makes J {excess:.0} % too large; the closed form needs no small damping"
    );
    let claims = vec![
        Claim::told(
            "J at ν 1.0501, F 0.009 N s, R 0.7",
            format!("{printed:.5} N s"),
            format!("{right:.5} N s"),
            true,
            "",
        )
        .against(&format!("{printed:.5}"), right, &why),
    ];
    let figure = Figure::single("Small damping").panel(plot).caption(
        "Impulse at the grazing resonance under impulses of 0.009 N s, R = 0.7, with the damper of the excited mass and without it.",
    );
    Sheet::new("impulse_damping", "Beside 3.40 to 3.44: the damper that is left out", figure, claims)
}

fn absent() -> Result<Sheet> {
    let rig = rig(0.7);
    let train = Excitation::Impulse(Impulses { impulse: IMPULSE, frequency: hertz(1.5) });
    let mut motion = Simulation::new(&rig, &train)?;
    motion.advance(3000.0 / hertz(1.5), &mut |_| {})?;
    let portrait = Portrait::take(&mut motion, &PortraitOptions { cycles: 300, samples: 100, shown: 6 })?;
    let none = !exists(&rig, 1.5);
    let mut claims = vec![Claim::told(
        "motion at ν 1.5, F 0.009 N s, R 0.7, c₁ and c₂ 0.1",
        "an orbit with one impact a cycle",
        format!("from rest: impacts/cycles {}", portrait.pattern.regime),
        !none,
        "no such orbit exists there",
    )];
    let over_time = |slips| programs::impulses(1.0, 0.0, IMPULSE, slips).at(2.1301);
    let [slow, fast] = [over_time(JIDTW)?, over_time(&[])?];
    let outside = format!(
        "the root of 3.42 has τ {:.3} T; jidtw, with φ/ω on the other branch of the arcsine, draws a motion at {:.3} T, {:.2} mm off the contact",
        fast.timing,
        slow.timing,
        1e3 * slow.miss
    );
    for (c1, c2) in [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1)] {
        let found = exists(&Rig { c1, ..undriven(1.0, c2) }, 2.13);
        claims.push(Claim::told(
            format!("3.18: orbit at ν 2.13, F 0.009 N s, R 1, c₁ {c1}, c₂ {c2}"),
            if c2 == 0.0 { "drawn over time" } else { "–" },
            if found { "exists" } else { "none with J > 0" },
            found,
            if found { "it is absent without dampers, and with dampers of 0.01 N s/m" } else { &outside },
        ));
    }
    let figure =
        figures::traces("Motion where no orbit has one impact a cycle", &portrait, rig.gap).height(100.0);
    Ok(Sheet::new(
        "impulse_absent",
        "Figure 3.18 and beside 3.15: motions that are no orbits",
        figure,
        claims,
    ))
}

/// The impact oscillator: mass 2 is a wall, without losses. Its closed form is J = 2mΩ tan(πΩ/ω)(±|A| − Δ).
pub fn wall() -> Sheet {
    let limit = Rig { m2: f64::INFINITY, c1: 0.0, restitution: 1.0, ..Rig::thesis() };
    let natural = (limit.k1 / limit.m1).sqrt();
    let force = 0.3;
    let textbook = |nu: f64| {
        let omega = nu * natural;
        let amplitude = (force / (limit.k1 - limit.m1 * omega * omega)).abs();
        let of = |a: f64| 2.0 * limit.m1 * natural * (PI / nu).tan() * (a - limit.gap);
        of(amplitude).max(of(-amplitude))
    };
    let computed = |nu: f64| under_sine(&limit, force, nu).first().map_or(f64::NAN, |o| o.impulse);
    let nu = grid(0.705, 2.1, 719);
    let shown = |value: &dyn Fn(f64) -> f64| {
        nu.iter().map(|nu| value(*nu)).map(|j| if j > 0.0 { j } else { f64::NAN }).collect::<Vec<_>>()
    };
    let coarse = grid(0.705, 1.995, 44);
    let plot = Plot::new(ratio(0.7, 2.1), impulse_axis().limits(1e-3, 10.0))
        .with(Series::line("wall", nu.clone(), shown(&computed)).ink(Ink::Nth(0)).stroke(Stroke::Solid))
        .with(
            Series::points(
                "textbook",
                coarse.clone(),
                coarse.iter().map(|nu| textbook(*nu)).collect::<Vec<_>>(),
            )
            .ink(Ink::Nth(1))
            .marker(Marker::OpenCircle),
        );
    let backbone = shown(&|nu: f64| -2.0 * limit.m1 * natural * limit.gap * (PI / nu).tan());
    let plot =
        plot.with(Series::line("backbone", nu.clone(), backbone).ink(Ink::Grey).stroke(Stroke::Dashed));
    let worst = coarse.iter().map(|nu| (computed(*nu) / textbook(*nu) - 1.0).abs()).fold(0.0, f64::max);
    let omega = 1.5 * natural;
    let amplitude = force / (limit.m1 * (natural * natural - omega * omega).abs());
    let printed = 2.0 * limit.m1 * natural * (PI / 1.5).tan() * (amplitude - limit.gap);
    let right = computed(1.5);
    // The second term of 3.66 from the orbits: J less its first term, in units of the impulse.
    let orbits = under_impulses(&limit, IMPULSE, 0.8);
    let largest = orbits.iter().map(|o| o.impulse).fold(f64::NAN, f64::max);
    let term = (largest + 2.0 * limit.m1 * natural * limit.gap * (PI / 0.8).tan()) / IMPULSE;
    let claims = vec![
        Claim::told(
            "3.33 in the limit of a single mass",
            "J = 2mΩ tan(πΩ/ω)(±A − Δ)",
            format!("the same{}", if worst < 1e-9 { " to 9 digits" } else { "" }),
            worst < 1e-9,
            "no losses, R = 1, mass 2 a wall",
        ),
        Claim::told(
            "3.65 at ν 1.5, F₀ 0.3 N: J > 0",
            format!("{printed:.4} N s").replace('-', "−"),
            format!("{right:.4} N s"),
            (printed - right).abs() < 1e-9,
            "3.63 to 3.66 have one sign of A: where χ < 0, here for ν 1 to 2, J = (−Δ − A)/χ is the root above 0",
        ),
        Claim::told(
            "3.66 at ν 0.8: second term",
            format!("{:.3} F", 1.0 / (PI / 0.8).cos()).replace('-', "−"),
            format!("{term:.3} F"),
            (term - 1.0 / (PI / 0.8).cos()).abs() < 1e-9,
            "√(2r) of 3.64 is the magnitude of 2 sin(Ω₁T/2); 3.66 is printed without it and has the wrong sign for ν 2/3 to 1, where χ > 0",
        ),
        Claim::told(
            "3.3: the free motion, F₀ 0",
            "a backbone",
            "J = −2mΩΔ tan(πΩ/ω)",
            true,
            "above 0 for ν 1 to 2; it goes to infinity at ν 2",
        ),
    ];
    let figure = Figure::single("Impact oscillator").panel(plot).caption(
        "Larger impulse of the impact oscillator without losses, F₀ = 0.3 N, over the textbook's closed form, and its backbone (F₀ = 0).",
    );
    Sheet::new("wall", "Figure 3.3 and 3.63 to 3.66: the impact oscillator", figure, claims)
}
