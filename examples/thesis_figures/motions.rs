//! Simulated motions at one frequency: in phase, out of phase, regular and irregular.

use crate::scene::{hertz, rig, under_sine};
use crate::sheet::{Claim, Sheet};
use crate::sweeps::CONTACT;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibroimpact::analysis::figures;
use vibroimpact::figure::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series};
use vibroimpact::model::portrait::{Portrait, PortraitOptions};
use vibroimpact::model::regime::regime;
use vibroimpact::model::{
    Chirp, Compliant, Excitation, Motion, Pulses, Regime, Rig, Simulation, Sine, State,
};
use vibroimpact::{Error, Result};

fn sine(force: f64, frequency: f64) -> Excitation {
    Excitation::Sine(Sine { force, frequency })
}

fn pulses(force: f64, frequency: f64) -> Excitation {
    Excitation::Pulse(Pulses { force, width: 0.01, frequency })
}

/// Motions that chapter 4 shows over time.
pub fn simulated() -> Result<Vec<Sheet>> {
    let mut all = vec![eleven()?];
    for (name, title, hz, drawn, in_phase, with) in [
        ("motion_missed", "Figure 4.20: motion at 4.66 Hz, sine of 0.1 N", 4.66, 0.1, true, sine as Force),
        ("motion_grazing", "Beside 4.20: motion at 5.5 Hz, sine of 0.1 N", 5.5, 0.1, true, sine),
        ("motion_pulses", "Figure 4.21: motion at 5.66 Hz, pulses of 0.5 N", 5.66, 0.5, true, pulses),
        ("motion_clapping", "Figure 4.22: motion at 10.61 Hz, sine of 0.2 N", 10.61, 0.2, false, sine),
        ("motion_hammering", "Figure 4.23: motion at 10.72 Hz, pulses of 0.6 N", 10.72, 0.6, false, pulses),
    ] {
        let shown = |force, cycles| Shown::swept_to(hz, &with(force, 3.0), cycles);
        let motion = shown(drawn, LATER)?;
        let what = format!("motion of both masses at {hz} Hz");
        let claim = |what: String, motion: &Shown| {
            let thesis = match (name, in_phase) {
                ("motion_grazing", _) => "–",
                (_, true) => "in phase",
                (_, false) => "out of phase",
            };
            let why = if thesis == "–" { "near the grazing resonance of this page" } else { "" };
            Claim::told(what, thesis, motion.words(), motion.is(in_phase), why)
        };
        let mut claims = Vec::new();
        for (cycles, when) in [(0.0, "where a sweep up stops"), (LATER, "300 cycles later")] {
            let claim = claim(format!("{what}, {when}"), &shown(drawn, cycles)?);
            if name == "motion_grazing" {
                claims.push(claim);
                continue;
            }
            let motions = FORCES.map(|force| Ok((force, shown(force, cycles)?)));
            let motions: Vec<(f64, Shown)> = motions.into_iter().collect::<Result<_>>()?;
            let tried: Vec<(f64, bool)> = motions.iter().map(|(force, m)| (*force, m.is(in_phase))).collect();
            let mut claim = claim.of_forces("", &tried);
            if motions.iter().any(|(_, motion)| motion.0.pattern.regime == Regime::NoImpact) {
                claim = claim.and("where it does not hold the masses do not meet");
            }
            if name == "motion_missed" {
                claim = claim.and("by the phase at 4.66 Hz; there is no resonance here");
            }
            if name == "motion_hammering" {
                claim = claim.and("with 0.5 N the start decides: the sweep of 4.16 is in antiphase here");
            }
            claims.push(claim);
        }
        if name == "motion_missed" {
            claims.push(claim(format!("{what}, from rest"), &Shown::from_rest(hz, &with(drawn, hz))?));
        }
        let figure = figures::traces(title, &motion.0, Rig::thesis().gap).height(100.0);
        all.push(Sheet::new(name, title, figure, claims));
    }
    Ok(all)
}

/// Forces in N that are tried where the thesis states none.
const FORCES: [f64; 5] = [0.1, 0.2, 0.5, 1.0, 1.5];

/// Cycles between the end of a sweep and the settled motion.
const LATER: f64 = 300.0;

/// An excitation of a force (N) at a frequency (Hz).
type Force = fn(f64, f64) -> Excitation;

/// Samples of a motion in each cycle.
const SAMPLES: u32 = 150;

/// A motion over 40 cycles.
struct Shown(Portrait);

impl Shown {
    /// The motion at `hz` (Hz), these cycles after an upward sweep from 3 Hz stops there.
    fn swept_to(hz: f64, excitation: &Excitation, cycles: f64) -> Result<Shown> {
        let mut motion = Compliant::new(&Rig::thesis(), excitation, CONTACT, State::REST, 0.0)?;
        Chirp::new(0.02).advance(&mut motion, (hz - 3.0) / 0.02, &mut |_| {})?;
        Shown::after(motion, hz, cycles)
    }

    /// The motion at `hz` (Hz) from rest.
    fn from_rest(hz: f64, excitation: &Excitation) -> Result<Shown> {
        Shown::after(Compliant::new(&Rig::thesis(), excitation, CONTACT, State::REST, 0.0)?, hz, LATER)
    }

    /// The motion after these cycles.
    fn after(mut motion: Compliant, hz: f64, cycles: f64) -> Result<Shown> {
        motion.advance(motion.time() + cycles / hz, &mut |_| {})?;
        Portrait::take(&mut motion, &PortraitOptions { cycles: 40, samples: SAMPLES, shown: 4 }).map(Shown)
    }

    /// Correlation of both displacements.
    fn alike(&self) -> f64 {
        let states = &self.0.states;
        let squares = |of: fn(&State) -> f64| states.iter().map(|s| of(s).powi(2)).sum::<f64>().sqrt();
        states.iter().map(|s| s.x1 * s.x2).sum::<f64>() / squares(|s| s.x1) / squares(|s| s.x2)
    }

    /// Phase of x₂ to x₁ at the excitation frequency in degrees, as `vibro model sweep` takes it.
    fn lead(&self) -> f64 {
        let line = |of: fn(&State) -> f64| -> Complex64 {
            let turn = |i: usize| Complex64::cis(-TAU * i as f64 / f64::from(SAMPLES));
            self.0.states.iter().enumerate().map(|(i, s)| of(s) * turn(i)).sum()
        };
        (line(|s| s.x2) / line(|s| s.x1)).arg().to_degrees()
    }

    /// Whether the masses strike, and move in phase or out of phase.
    fn is(&self, in_phase: bool) -> bool {
        self.0.pattern.regime != Regime::NoImpact && (self.lead().abs() < 90.0) == in_phase
    }

    fn words(&self) -> String {
        let (lead, alike, regime) = (self.lead(), self.alike(), self.0.pattern.regime);
        format!("phase of x₂ to x₁ {lead:.0}°, correlation {alike:.2}, impacts/cycles {regime}")
            .replace('-', "−")
    }
}

fn eleven() -> Result<Sheet> {
    let rig = rig(0.7);
    let frequency = hertz(2.13);
    let mut motion = Simulation::new(&rig, &Sine { force: 0.5, frequency })?;
    motion.advance(2000.0 / frequency, &mut |_| {})?;
    let portrait = Portrait::take(&mut motion, &PortraitOptions { cycles: 200, samples: 150, shown: 4 })?;
    let last = portrait.pattern.strikes.last().ok_or_else(|| Error::refused("no impacts at 11.1 Hz"))?;
    let closed = under_sine(&rig, 0.5, 2.13).first().map_or(f64::NAN, |o| o.impulse);
    let once = portrait.pattern.regime == Regime::Periodic { impacts: 1, cycles: 1 };
    let claims = vec![
        Claim::told(
            "classical impacts at 11.1 Hz (ν 2.13), F₀ 0.5 N, R 0.7",
            "irregular, by the integration and by impacts of infinite acceleration",
            format!("impacts/cycles {}, J {:.6} N s", portrait.pattern.regime, last.impulse),
            !once,
            "exact flights with located impacts repeat to rounding, and their impacts have no duration either; what is left is the integration, or the detection of impacts, which by section 4.2 leaves out the direction of the velocity",
        ),
        Claim::told(
            "its impulse in the closed form",
            "–",
            format!("{closed:.6} N s"),
            (closed - last.impulse).abs() < 1e-12,
            "the simulation settles on the orbit",
        ),
    ];
    let figure = figures::traces("Motion at 11.1 Hz", &portrait, rig.gap).height(100.0);
    Ok(Sheet::new("motion_11hz", "Figure 4.4: the motion at 11.1 Hz with classical impacts", figure, claims))
}

/// Regime after 3000 cycles from rest at a frequency in Hz.
fn settled(restitution: f64, force: f64, frequency: f64) -> Result<Regime> {
    let mut motion = Simulation::new(&rig(restitution), &Sine { force, frequency })?;
    Ok(regime(&mut motion, 3000, 300)?.regime)
}

/// Impact patterns of the rig, figures 5.2 and 5.3.
pub fn patterns() -> Result<Sheet> {
    let (restitution, force) = (0.98, 0.3);
    let mut figure = Figure::double("Impacts at 5.61 and 7.49 Hz").height(75.0).columns(2);
    let mut claims = Vec::new();
    for (letter, hz, thesis) in [('a', 5.61, "irregular"), ('b', 7.49, "one impact a cycle")] {
        let mut motion = Simulation::new(&rig(restitution), &Sine { force, frequency: hz })?;
        motion.advance(3000.0 / hz, &mut |_| {})?;
        let portrait = Portrait::take(&mut motion, &PortraitOptions { cycles: 300, samples: 10, shown: 1 })?;
        let (n, speed): (Vec<f64>, Vec<f64>) = portrait
            .impacts
            .iter()
            .take(120)
            .enumerate()
            .map(|(i, impact)| (i as f64, impact.approach_velocity))
            .unzip();
        let plot =
            Plot::new(AxisSpec::new("Impact", ""), AxisSpec::new("Approach speed", "m/s").limits(0.0, 0.5))
                .title(format!("({letter}) {hz} Hz"))
                .with(Series::points("", n, speed).ink(Ink::Nth(0)).marker(Marker::Circle))
                .legend(Legend::Hidden);
        figure = figure.panel(plot);
        let found = portrait.pattern.regime;
        let claimed = |regime| match regime {
            Regime::Irregular => thesis == "irregular",
            Regime::Periodic { impacts: 1, cycles: 1 } => thesis != "irregular",
            _ => false,
        };
        let here = format!("impacts/cycles {found} with R {restitution} and {force} N");
        let figure = if hz < 7.0 { "5.2" } else { "5.3" };
        let mut claim =
            Claim::told(format!("{figure}: impacts at {hz} Hz"), thesis, here, claimed(found), "");
        for other in [restitution, 0.7, 0.2112] {
            let tried = [0.1, 0.2, 0.3, 0.5].map(|force| Ok((force, claimed(settled(other, force, hz)?))));
            let tried: Vec<(f64, bool)> = tried.into_iter().collect::<Result<_>>()?;
            claim = claim.of_forces(&format!("R {other} and "), &tried);
        }
        claims.push(claim);
    }
    let figure = figure.caption(
        "Approach speed from impact to impact, sine of 0.3 N, R = 0.98, after 3000 cycles from rest.",
    );
    Ok(Sheet::new(
        "motion_irregular",
        "Figures 5.2 and 5.3: impact patterns at 5.61 and 7.49 Hz",
        figure,
        claims,
    ))
}
