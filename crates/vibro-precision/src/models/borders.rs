//! The borders of what models can.

use std::f64::consts::TAU;

use super::grazing;
use super::task::Task;
use super::truth;
use vibro_model::{Rig, Sine, State, Steady};
use vibro_record::Result;
use vibro_record::units::notation::quantity;

/// Cycles that a motion is followed.
const CYCLES: f64 = 6.0;

/// A scene at a border.
#[derive(Debug, Clone, PartialEq)]
pub struct Border {
    /// Name of the border.
    pub name: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// The motion.
    pub task: Task,
    /// What is asked there.
    pub asks: Asks,
}

/// What is asked of a method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Asks {
    /// The impacts and rests of the motion.
    Motion,
    /// Whether there is an impact, and when: in s, or never.
    First(Option<f64>),
    /// The motions that repeat.
    Orbit,
    /// As [`Asks::Motion`], of methods that have a contact.
    Contact,
    /// The approach speed after so many cycles.
    Cycles(f64),
}

/// ν = ω/Ω₁ to a frequency in Hz.
fn at(rig: &Rig, nu: f64) -> f64 {
    nu * (rig.k1 / rig.m1).sqrt() / TAU
}

/// Six cycles at ν 2.1 under 0.5 N from x₁ = −1 mm.
fn motion(rig: Rig) -> Task {
    let frequency = at(&Rig::thesis(), 2.1);
    Task {
        start: State { x1: -1e-3, ..State::REST },
        most: 100_000,
        ..Task::sine(rig, 0.5, frequency, CYCLES / frequency)
    }
}

/// Restitution up to which the first chatter of a motion ends in rest, by halving: with more the masses are let go while they still bounce.
fn onset(task: &impl Fn(f64) -> Task) -> f64 {
    // The first release is at a quarter of a second whatever R is, the next chatter begins behind 0.4 s.
    let rests = |restitution: f64| {
        truth::motion(&Task { until: 0.3, ..task(restitution) }, None)
            .is_ok_and(|told| !told.sticks.is_empty())
    };
    let (mut low, mut high) = (0.7, 0.9);
    for _ in 0..20 {
        let middle = f64::midpoint(low, high);
        if rests(middle) { low = middle } else { high = middle }
    }
    low
}

/// All scenes; `quick` follows fewer cycles where many are asked for.
///
/// # Errors
/// If a scene cannot be built.
pub fn borders(quick: bool) -> Result<Vec<Border>> {
    let thesis = Rig::thesis();
    let mut all = Vec::new();
    let mut add = |border: &'static str, scene: String, task: Task, asks: Asks| {
        all.push(Border { name: border, scene, task, asks });
    };
    for depth in [1e-3, 1e-6, 1e-9, 1e-12, -1e-12, -1e-9, -1e-6, -1e-3] {
        let (task, time) = grazing::task(depth, 1)?;
        let words = if depth > 0.0 { "reached" } else { "missed" };
        add("grazing", format!("{words} by {}", quantity(depth.abs(), "m", 1)), task, Asks::First(time));
    }
    // The forced motion alone reaches the gap up to a factor 1 + ε.
    let frequency = at(&thesis, 2.1);
    let unit = Steady::new(&thesis, &Sine { force: 1.0, frequency })?.amplitude();
    for excess in [1e-3, 1e-9, -1e-9, -1e-3] {
        let task = Task { force: thesis.gap / unit * (1.0 + excess), ..motion(thesis) };
        let sign = if excess > 0.0 { '+' } else { '−' };
        add("grazing orbit", format!("amplitude over gap 1 {sign} {:.0e}", excess.abs()), task, Asks::Orbit);
    }
    for (name, restitution) in
        [("0", 0.0), ("1e-9", 1e-9), ("0.01", 0.01), ("0.99", 0.99), ("1 − 1e-6", 1.0 - 1e-6), ("1", 1.0)]
    {
        add("restitution", format!("R {name}"), motion(Rig { restitution, ..thesis }), Asks::Motion);
    }
    for (name, part) in
        [("none", 0.0), ("1e-9 of critical", 1e-9), ("critical", 1.0), ("100 times critical", 100.0)]
    {
        let critical = |m: f64, k: f64| 2.0 * part * (m * k).sqrt();
        let rig = Rig { c1: critical(thesis.m1, thesis.k1), c2: critical(thesis.m2, thesis.k2), ..thesis };
        // Enough force to reach across the gap.
        let task = Task { force: 0.5 * (1.0 + 20.0 * part), ..motion(rig) };
        add("damping", name.to_owned(), task, Asks::Motion);
    }
    for gap in [1e-6, 1e-12, 0.0, -1e-12, -1e-6, -5e-4] {
        add("gap", quantity(gap, "m", 1), motion(Rig { gap, ..thesis }), Asks::Motion);
    }
    for ratio in [1e-3, 1e-1, 1e1, 1e3] {
        let scale = ratio * thesis.m1 / thesis.m2;
        let rig = Rig { m2: thesis.m2 * scale, k2: thesis.k2 * scale, c2: thesis.c2 * scale, ..thesis };
        add("mass ratio", format!("m₂/m₁ {ratio:.0e}"), motion(rig), Asks::Motion);
    }
    // 0.07 to 7 % of the period in contact.
    for stiffness in [1e8, 1e5, 1e4] {
        let task = Task { stiffness, ..motion(thesis) };
        add("soft contact", format!("{stiffness:.0e} N/m"), task, Asks::Contact);
    }
    let pair = ((thesis.k1 + thesis.k2) / (thesis.m1 + thesis.m2)).sqrt() / TAU;
    let [first, second] = thesis.natural_frequencies();
    for (name, frequency, c) in [
        ("mass 1", first, 0.1),
        ("mass 1, no dampers", first, 0.0),
        ("mass 2", second, 0.1),
        ("mass 2, no dampers", second, 0.0),
        ("both together", pair, 0.1),
        ("both together, no dampers", pair, 0.0),
    ] {
        let rig = Rig { c1: c, c2: c, ..thesis };
        let task = Task { frequency, until: CYCLES / frequency, ..motion(rig) };
        add("resonance", name.to_owned(), task, Asks::Motion);
    }
    let chatter = |restitution: f64| {
        let scene_c = super::chatter::task();
        Task { rig: Rig { restitution, ..scene_c.rig }, until: 1.2, most: 100_000, ..scene_c }
    };
    for restitution in [0.3, 0.7, 0.9, 0.95] {
        add("chatter", format!("R {restitution}"), chatter(restitution), Asks::Motion);
    }
    let onset = onset(&chatter);
    for (sign, beside) in [('−', -1e-3), ('+', 1e-3)] {
        let scene = format!("R {onset:.4} {sign} 1e-3, where rest begins");
        add("chatter", scene, chatter(onset + beside), Asks::Motion);
    }
    for cycles in if quick { vec![1e3] } else { vec![1e4, 1e6] } {
        let task = Task { until: cycles / frequency, most: 200_000_000, ..motion(thesis) };
        add("long runs", format!("{cycles:.0e} cycles"), task, Asks::Cycles(cycles));
    }
    Ok(all)
}
