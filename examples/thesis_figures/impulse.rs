//! Closed form under impulses, and the impact oscillator.

use crate::scene::{accepted, add_orbits, border, grid, hertz, ratio, rig, under_impulses, under_sine};
use crate::sheet::{Claim, Sheet};
use std::f64::consts::PI;
use vibroimpact::Result;
use vibroimpact::analysis::figures;
use vibroimpact::figure::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};
use vibroimpact::model::portrait::{Portrait, PortraitOptions};
use vibroimpact::model::{Excitation, Green, Impulses, Motion, Rig, Simulation};

/// Impulse of the thesis' examples in N s.
const IMPULSE: f64 = 0.009;

pub fn sheets() -> Result<Vec<Sheet>> {
    Ok(vec![impulses(), timing()?, damping(), absent()?, wall()])
}

fn impulse_axis() -> AxisSpec {
    AxisSpec::new("Impulse J", "N s").log()
}

fn exists(rig: &Rig, nu: f64) -> bool {
    under_impulses(rig, IMPULSE, nu).iter().any(|o| o.validity.exists)
}

fn impulses() -> Sheet {
    let nu = grid(0.75, 2.5, 1401);
    let scenes = [(0.009, 0.7), (0.009, 1.0), (0.02, 0.7), (0.005, 0.7)];
    let mut plot = Plot::new(ratio(0.75, 2.5), impulse_axis().limits(5e-4, 0.5)).legend(Legend::Above);
    for (nth, (impulse, restitution)) in scenes.into_iter().enumerate() {
        let rig = rig(restitution);
        let name = format!("F {impulse} N s, R {restitution}");
        plot = add_orbits(plot, &name, nth, &nu, |nu| under_impulses(&rig, impulse, nu), |o| o.impulse);
    }
    let rig = rig(0.7);
    let [low, high] = [(1.1, 1.5), (1.5, 2.0)].map(|(a, b)| border(a, b, |nu| exists(&rig, nu)));
    let why =
        "all roots in 0 < τ < T have J < 0 between; what the equations 3.42 to 3.44 give there is spurious";
    let claims = vec![Claim::told(
        "F 0.009 N s, R 0.7: motions with one impact a cycle",
        "a root for any τ, one of them drawn over time",
        format!("none for ν {low:.4} to {high:.4}"),
        exists(&rig, 1.3) && exists(&rig, 1.7),
        why,
    )];
    let figure = Figure::double("Impulse over frequency under impulses").height(95.0).panel(plot).caption(
        "Impulse of all motions with one impact a cycle under an impulse F a cycle. Coloured: those that can be and are stable; thin and grey: the others.",
    );
    Sheet::new("impulse", "Impulses: impulse over frequency", figure, claims)
}

/// A root of the contact conditions at the time τ between impulse and impact, in cycles, with its J.
struct Root {
    timing: f64,
    impulse: f64,
}

/// Roots of the conditions y(τ) = Δ + JC, ẏ(τ) = JP where y, the response to the impulses, is continued
/// beyond its cycle, as the equations with sin λ(t + τ) do that ask for no 0 < τ < T.
fn continued(rig: &Rig, nu: f64, from: f64, to: f64) -> Result<Vec<Root>> {
    let period = 1.0 / hertz(nu);
    let [first, second] = rig.oscillators();
    let [a, b] = [Green::new(rig.m1, first, period)?, Green::new(rig.m2, second, period)?];
    let (c, p) = (a.start + b.start, 1.0 / rig.exchange() + a.slope_before + b.slope_before);
    let g = |timing: f64| {
        let (y, v) = a.at(timing * period);
        p * (IMPULSE * y - rig.gap) - c * IMPULSE * v
    };
    let at = grid(from, to, 4001);
    let crossing = at.windows(2).filter(|w| g(w[0]) * g(w[1]) < 0.0);
    Ok(crossing
        .map(|w| {
            let timing = border(w[0], w[1], |t| g(t) < 0.0);
            Root { timing, impulse: IMPULSE * a.at(timing * period).1 / p }
        })
        .collect())
}

fn timing() -> Result<Sheet> {
    let rig = rig(0.7);
    let nu = grid(0.75, 2.5, 351);
    let mut spurious = (Vec::new(), Vec::new());
    for nu in &nu {
        for (from, to) in [(-1.0, 0.0), (1.0, 2.0)] {
            for root in continued(&rig, *nu, from, to)?.iter().filter(|r| r.impulse > 0.0) {
                spurious.0.push(*nu);
                spurious.1.push(root.timing);
            }
        }
    }
    let fine = grid(0.75, 2.5, 1401);
    let plot = Plot::new(
        ratio(0.75, 2.5),
        AxisSpec::new("Time τ from impulse to impact in cycles", "").limits(-1.0, 2.0),
    )
    .with(Series::points("spurious roots", spurious.0, spurious.1).ink(Ink::Nth(3)).marker(Marker::Cross))
    .with(Series::horizontal("", 0.0))
    .with(Series::horizontal("", 1.0))
    .legend(Legend::Above);
    let plot =
        add_orbits(plot, "real", 0, &fine, |nu| under_impulses(&rig, IMPULSE, nu), |o| o.timing / o.period());
    let outside = [continued(&rig, 1.5, -1.0, 0.0)?, continued(&rig, 1.5, 1.0, 2.0)?];
    let told: Vec<String> = outside
        .iter()
        .flatten()
        .filter(|r| r.impulse > 0.0)
        .map(|r| format!("τ {:.3} T (J {:.5} N s)", r.timing, r.impulse).replace('-', "−"))
        .collect();
    let claims = vec![Claim::told(
        "roots with J > 0 at ν 1.5",
        "motions",
        format!("{}: spurious", told.join(", ")),
        told.is_empty(),
        "the response to the impulses holds from one impulse to the next only, 0 < τ < T",
    )];
    let figure = Figure::double("Timing under impulses").height(90.0).panel(plot).caption(
        "Time from impulse to impact, F = 0.009 N s, R = 0.7: real motions coloured, others with J > 0 thin and grey; crosses: roots with J > 0 \
         of the same equations outside of 0 < τ < T.",
    );
    Ok(Sheet::new("impulse_timing", "Impulses: timing, and the spurious roots", figure, claims))
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
    let claims = vec![Claim::told(
        "J at ν 1.0501, F 0.009 N s, R 0.7",
        format!("{printed:.5} N s"),
        format!("{right:.5} N s"),
        (printed - right).abs() < 0.01 * right,
        &why,
    )];
    let figure = Figure::single("Small damping").panel(plot).caption(
        "Impulse at the grazing resonance under impulses of 0.009 N s, R = 0.7, with the damper of the excited mass and without it.",
    );
    Sheet::new("impulse_damping", "Impulses: the damper that is left out", figure, claims)
}

fn absent() -> Result<Sheet> {
    let rig = rig(0.7);
    let train = Excitation::Impulse(Impulses { impulse: IMPULSE, frequency: hertz(1.5) });
    let mut motion = Simulation::new(&rig, &train)?;
    motion.advance(3000.0 / hertz(1.5), &mut |_| {})?;
    let portrait = Portrait::take(&mut motion, &PortraitOptions { cycles: 300, samples: 100, shown: 6 })?;
    let none = !exists(&rig, 1.5);
    let claims = vec![Claim::told(
        "motion at ν 1.5, F 0.009 N s, R 0.7",
        "an orbit with one impact a cycle",
        format!("from rest: impacts/cycles {}", portrait.pattern.regime),
        !none,
        "no such orbit exists there, nor does that of its last figure over time",
    )];
    let figure =
        figures::traces("Motion where no orbit has one impact a cycle", &portrait, rig.gap).height(100.0);
    Ok(Sheet::new("impulse_absent", "Impulses: the motion where there is no such orbit", figure, claims))
}

/// The impact oscillator: mass 2 a wall, no losses, for which J = 2mΩ tan(πΩ/ω)(±|A| − Δ).
fn wall() -> Sheet {
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
    let plot = Plot::new(ratio(0.7, 2.1), impulse_axis().limits(1e-2, 10.0))
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
    let worst = coarse.iter().map(|nu| (computed(*nu) / textbook(*nu) - 1.0).abs()).fold(0.0, f64::max);
    let claims = vec![Claim::told(
        "impulse in the limit of a single mass",
        "J = 2mΩ tan(πΩ/ω)(±A − Δ)",
        format!("the same{}", if worst < 1e-9 { " to 9 digits" } else { "" }),
        worst < 1e-9,
        "no losses, R = 1, mass 2 a wall",
    )];
    let figure = Figure::single("Impact oscillator").panel(plot).caption(
        "Larger impulse of the impact oscillator without losses, F₀ = 0.3 N, over the textbook's closed form.",
    );
    Sheet::new("wall", "The single-mass limit: an impact oscillator", figure, claims)
}
