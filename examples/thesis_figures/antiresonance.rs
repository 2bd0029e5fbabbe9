//! The antiresonance of figures 3.13 to 3.15, and the frequency ratio where x₁ is really smallest.

use crate::impulse::{IMPULSE, without};
use crate::programs::{JIDNEW, Program, SCENES, impulses, largest as largest_of, peaks, told};
use crate::scene::{accepted, add_orbits, grid, hertz, peak, ratio, real, rig, under_impulses, under_sine};
use crate::sheet::{Claim, Sheet};
use vibroimpact::Result;
use vibroimpact::figure::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series};
use vibroimpact::model::portrait::{Portrait, PortraitOptions};
use vibroimpact::model::{Excitation, Impulses, Motion, Orbit, Rig, Simulation, State};

/// Range of ν between the resonances, in which the antiresonance is sought.
const BETWEEN: (f64, f64) = (1.1, 2.1);

/// Motion of a rig after 2000 cycles from rest.
struct Settled {
    nu: f64,
    /// Largest displacements of masses 1 and 2 in m.
    largest: [f64; 2],
    pattern: String,
}

/// Largest displacements of both masses in m, each from its own position of rest.
fn largest<'a>(states: impl Iterator<Item = &'a State>) -> [f64; 2] {
    states.fold([0.0, 0.0], |[a, b], s| [a.max(s.x1.abs()), b.max(s.x2.abs())])
}

/// Largest displacements of both masses in m on an orbit, from 200 instants of its period.
fn of_orbit(orbit: &Orbit) -> [f64; 2] {
    let states: Vec<State> = (0..200).map(|i| orbit.state(f64::from(i) / 200.0 * orbit.period())).collect();
    largest(states.iter())
}

/// The motion under impulses after 2000 cycles from rest, measured over the next 200 cycles.
fn settled(rig: &Rig, nu: f64) -> Result<Settled> {
    let frequency = hertz(nu);
    let train = Excitation::Impulse(Impulses { impulse: IMPULSE, frequency });
    let mut motion = Simulation::new(rig, &train)?;
    motion.advance(2000.0 / frequency, &mut |_| {})?;
    let portrait = Portrait::take(&mut motion, &PortraitOptions { cycles: 200, samples: 60, shown: 200 })?;
    let pattern = portrait.pattern.regime.to_string();
    Ok(Settled { nu, largest: largest(portrait.states.iter()), pattern })
}

/// The figure (time to the impact; displacements), and the claims of the thesis beside the computed values.
pub fn sheet() -> Result<Sheet> {
    let rig = rig(0.7);
    let nu = grid(1.0, 2.4, 141);
    let all = nu.iter().map(|nu| settled(&rig, *nu)).collect::<Result<Vec<Settled>>>()?;
    let mut claims = root_claims()?;
    let near = all.iter().min_by(|a, b| (a.nu - 1.75).abs().total_cmp(&(b.nu - 1.75).abs()));
    let in_words = |s: &Settled, digits: usize| {
        let [a, b] = s.largest.map(|x| 1e3 * x);
        format!("ν {:.digits$}: x₁ {a:.2} mm, x₂ {b:.2} mm, impacts/cycles {}", s.nu, s.pattern)
    };
    let [from, to] = without(&rig);
    claims.push(Claim::told(
        "R 0.7, c₁ and c₂ 0.1: ν without a motion of one impact a cycle",
        "drawn over all ν",
        format!("{from:.4} to {to:.4}"),
        from > to,
        "",
    ));
    let what = "motion from rest near ν 1.75, R 0.7, c₁ and c₂ 0.1";
    let why = "x₁ is as large as the gap, and no motion has one impact a cycle";
    claims.push(Claim::told(
        what,
        "x₁ near 0",
        near.map_or_else(String::new, |s| in_words(s, 2)),
        near.is_none(),
        why,
    ));
    claims.push(Claim::told(
        "the same: x₂ beside x₁",
        "x₂ the larger",
        near.map_or_else(String::new, |s| format!("{:.1} times x₁", s.largest[1] / s.largest[0])),
        near.is_some_and(|s| s.largest[1] > s.largest[0]),
        "",
    ));
    // x₁ changes with ν faster than the points of the figure show.
    let fine = grid(1.6, 1.7, 101).iter().map(|nu| settled(&rig, *nu)).collect::<Result<Vec<Settled>>>()?;
    let least = fine.iter().min_by(|a, b| a.largest[0].total_cmp(&b.largest[0]));
    let (at, small) = least.map_or((f64::NAN, f64::NAN), |s| (s.nu, s.largest[0]));
    let flat = || fine.iter().filter(|s| s.largest[0] < 1.1 * small).map(|s| s.nu);
    let why = format!(
        "in steps of 0.001; it is flat, less than 10 % more for ν {:.3} to {:.3}",
        flat().fold(f64::MAX, f64::min),
        flat().fold(0.0, f64::max)
    );
    let here = least.map_or_else(String::new, |s| in_words(s, 3));
    claims.push(
        Claim::told("the same: least x₁ between the resonances", "about ν 1.75", here, true, "")
            .against("1.75", at, &why),
    );
    claims.push(of_sine());
    claims.push(second_peak());
    claims.extend(printed_program_claims());
    claims.push(of_peaks());
    let find = |nu: f64| under_impulses(&rig, IMPULSE, nu);
    let fine = grid(1.0, 2.4, 1121);
    let (at, timings, x1) = spurious_roots(&nu)?;
    let crosses = |name: &str, y: &[f64]| {
        Series::points(name, at.clone(), y.to_vec()).ink(Ink::Nth(3)).marker(Marker::Cross)
    };
    let time = AxisSpec::new("Time τ to the impact in cycles", "").limits(0.0, 2.0);
    let when = Plot::new(ratio(1.0, 2.4), time)
        .title("(a) time from impulse to impact")
        .with(crosses("", &timings))
        .with(Series::horizontal("", 1.0));
    let when = add_orbits(when, "", 0, &fine, find, |o| o.timing / o.period());
    let mut size = Plot::new(ratio(1.0, 2.4), AxisSpec::new("Largest value", "mm").log().limits(0.5, 20.0))
        .title("(b) displacements")
        .legend(Legend::Above)
        .with(crosses("x₁ of 3.42 to 3.44, τ outside (0, T)", &x1));
    size = add_orbits(size, "x₁ of orbits", 0, &fine, find, |o| 1e3 * of_orbit(o)[0]);
    for (i, name, nth, marker) in
        [(0, "x₁ from rest", 0, Marker::OpenCircle), (1, "x₂ from rest", 1, Marker::Square)]
    {
        let y: Vec<f64> = all.iter().map(|s| 1e3 * s.largest[i]).collect();
        size = size.with(Series::points(name, nu.clone(), y).ink(Ink::Nth(nth)).marker(marker));
    }
    let figure = Figure::double("The antiresonance under impulses")
        .height(150.0)
        .panel(when.legend(Legend::Hidden))
        .panel(size.with(Series::vertical("thesis", 1.75)))
        .caption(
            "Impulses of 0.009 N s, R = 0.7, c₁ = c₂ = 0.1. Crosses: what the equations of the thesis give with τ outside 0 < τ < T, c₁ = 0. Lines: orbits \
             with one impact a cycle, grey where they cannot be seen. Open marks: the motion 2000 cycles after rest.",
        );
    Ok(Sheet::new(
        "antiresonance",
        "Figures 3.13 to 3.15: the antiresonance that is no motion",
        figure,
        claims,
    ))
}

/// Equations 3.42 to 3.44, with the errors of the printed programs in χ̇ and τ corrected.
fn corrected_program(restitution: f64, c2: f64) -> Program {
    impulses(restitution, c2, IMPULSE, &[])
}

/// ν, τ/T and largest x₁ in mm of the roots of figure 3.15 with τ outside 0 < τ < T. Their impact would lie
/// outside its own cycle, so they are no motions.
fn spurious_roots(nu: &[f64]) -> Result<(Vec<f64>, Vec<f64>, Vec<f64>)> {
    let program = corrected_program(0.7, 0.1);
    let all = nu.iter().map(|nu| Ok((nu + 1e-4, program.at(nu + 1e-4)?))).collect::<Result<Vec<_>>>()?;
    let outside = all.iter().filter(|(_, r)| r.impulse.norm() > 0.0 && !(0.0..1.0).contains(&r.timing));
    let rows = outside.map(|(nu, root)| (*nu, (root.timing, 1e3 * root.largest[0])));
    let (at, (timings, x1)) = rows.unzip();
    Ok((at, timings, x1))
}

/// Claims: at ν 1.75 the root that each of figures 3.13 to 3.15 shows has τ outside its cycle.
fn root_claims() -> Result<Vec<Claim>> {
    let mut claims = Vec::new();
    for (figure, restitution, c2) in SCENES {
        let root = corrected_program(restitution, c2).at(1.75)?;
        claims.push(Claim::told(
            format!("{figure}, R {restitution}, c₂ {c2}: τ of the root of 3.42 to 3.44 at ν 1.75"),
            "0 < τ < T",
            format!("{:.3} T, J {:.4} N s, x₁ {:.2} mm", root.timing, root.impulse.re, 1e3 * root.largest[0]),
            (0.0..1.0).contains(&root.timing),
            "the response to the impulses is continued beyond its cycle: there is no such motion",
        ));
    }
    Ok(claims)
}

/// Claim: the smallest x₁ between the resonances under a sine, figure 3.7.
fn of_sine() -> Claim {
    let rig = rig(0.7);
    let all = grid(BETWEEN.0, BETWEEN.1, 1001);
    let orbits = all.iter().filter_map(|nu| {
        accepted(&under_sine(&rig, 0.5, *nu)).filter(|o| real(o)).map(|o| (*nu, of_orbit(o)))
    });
    let (at, [first, second]) =
        orbits.min_by(|a, b| a.1[0].total_cmp(&b.1[0])).unwrap_or((f64::NAN, [f64::NAN; 2]));
    Claim::told(
        "3.7, sine of 0.5 N: least x₁ between the resonances",
        "x₂ larger there",
        format!("ν {at:.2}: x₁ {:.2} mm, x₂ {:.2} mm", 1e3 * first, 1e3 * second),
        second > first,
        "under a sine the orbits exist; jsdnew draws x₂ raised by the gap",
    )
}

/// Claim: the second peak of x₁ beside the first under a sine, figure 3.7.
fn second_peak() -> Claim {
    let rig = rig(0.7);
    let x1 = |nu| accepted(&under_sine(&rig, 0.5, nu)).filter(|o| real(o)).map(|o| 1e3 * of_orbit(o)[0]);
    let [(at, first), (beyond, second)] = [(1.0, 1.15), (1.7, 2.4)].map(|(low, high)| peak(low, high, x1));
    Claim::told(
        "3.7, sine of 0.5 N: second peak of x₁",
        "very small beside the first",
        format!("{second:.2} mm at ν {beyond:.3}, first {first:.1} mm at ν {at:.3}"),
        second < 0.2 * first,
        "",
    )
}

/// Claim: the peaks of x₁ near ν = 1 from jidnew and from the equations, at the frequency ratios of jidnew.
fn of_peaks() -> Claim {
    let nu = grid(0.8501, 1.1501, 16);
    let [printed, right] = [JIDNEW, &[]].map(|slips| {
        let of = |(_, restitution, c2)| {
            let program = impulses(restitution, c2, IMPULSE, slips);
            peaks(&nu, |nu| largest_of(&program, nu))
        };
        let mut all = SCENES.map(of).concat();
        all.dedup();
        all
    });
    Claim::told(
        "3.13 to 3.15: peaks of x₁ for ν 0.85 to 1.15 in steps of 0.02",
        "1, and the grazing resonance",
        format!("{} in each by jidnew with `./`; {} with its slips put right", told(&printed), told(&right)),
        printed.iter().chain(&right).any(|nu| *nu < 1.03),
        "the grazing resonance is alone: no peak is there to come from masses that pass through each other",
    )
}

/// Claims: ν of the smallest x₁ between the resonances from jidnew, as printed except for its `/`.
fn printed_program_claims() -> Vec<Claim> {
    let between = || grid(0.7501, 2.9901, 113).into_iter().filter(|nu| (BETWEEN.0..=BETWEEN.1).contains(nu));
    let of = |(figure, restitution, c2)| {
        let program = impulses(restitution, c2, IMPULSE, JIDNEW);
        let x1 = |nu: &f64| largest_of(&program, *nu);
        let at = between().min_by(|a, b| x1(a).total_cmp(&x1(b))).unwrap_or(f64::NAN);
        let why = format!("x₁ {:.2} mm: the figure was drawn by another program", 1e3 * x1(&at));
        Claim::number(format!("{figure}, jidnew with `./`: ν of the notch of x₁"), "1.75", at, (2, ""), &why)
    };
    SCENES.map(of).into()
}
