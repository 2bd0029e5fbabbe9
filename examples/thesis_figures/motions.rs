//! Simulated motions at one frequency: in phase, out of phase, regular and irregular.

use crate::scene::{hertz, rig, under_sine};
use crate::sheet::{Claim, Sheet};
use crate::sweeps::CONTACT;
use vibroimpact::analysis::figures;
use vibroimpact::figure::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series};
use vibroimpact::model::portrait::{Portrait, PortraitOptions};
use vibroimpact::model::regime::regime;
use vibroimpact::model::{
    Chirp, Compliant, Excitation, Motion, Pulses, Regime, Rig, Simulation, Sine, State,
};
use vibroimpact::{Error, Result};

/// Motions that chapter 4 shows over time.
pub fn simulated() -> Result<Vec<Sheet>> {
    let sine = |force| Excitation::Sine(Sine { force, frequency: 3.0 });
    let pulses = |force| Excitation::Pulse(Pulses { force, width: 0.01, frequency: 3.0 });
    let mut all = vec![eleven()?];
    let missed = "its grazing resonance is at 5.58 Hz here";
    for (name, title, hz, excitation, in_phase, why) in [
        ("motion_missed", "Figure 4.20: motion at 4.66 Hz, sine of 0.1 N", 4.66, sine(0.1), true, missed),
        ("motion_grazing", "Beside 4.20: motion at 5.5 Hz, sine of 0.1 N", 5.5, sine(0.1), true, ""),
        ("motion_pulses", "Figure 4.21: motion at 5.66 Hz, pulses of 0.5 N", 5.66, pulses(0.5), true, ""),
        ("motion_clapping", "Figure 4.22: motion at 10.61 Hz, sine of 0.2 N", 10.61, sine(0.2), false, ""),
        (
            "motion_hammering",
            "Figure 4.23: motion at 10.72 Hz, pulses of 0.6 N",
            10.72,
            pulses(0.6),
            false,
            "",
        ),
    ] {
        let (figure, claim) = swept_to(title, hz, &excitation, in_phase, why)?;
        all.push(Sheet::new(name, title, figure, vec![claim.only_with("this force")]));
    }
    Ok(all)
}

/// The motion at `hz` (Hz) in an upward sweep from 3 Hz, with the claim whether the masses move in phase.
fn swept_to(
    title: &str,
    hz: f64,
    excitation: &Excitation,
    in_phase: bool,
    why: &str,
) -> Result<(Figure, Claim)> {
    let rig = Rig::thesis();
    let mut motion = Compliant::new(&rig, excitation, CONTACT, State::REST, 0.0)?;
    Chirp::new(0.02).advance(&mut motion, (hz - 3.0) / 0.02, &mut |_| {})?;
    motion.advance(motion.time() + 300.0 / hz, &mut |_| {})?;
    let portrait = Portrait::take(&mut motion, &PortraitOptions { cycles: 40, samples: 150, shown: 4 })?;
    let product: f64 = portrait.states.iter().map(|s| s.x1 * s.x2).sum();
    let squares = |of: fn(&State) -> f64| portrait.states.iter().map(|s| of(s).powi(2)).sum::<f64>().sqrt();
    let alike = product / squares(|s| s.x1) / squares(|s| s.x2);
    let claim = Claim::told(
        format!("motion of both masses at {hz} Hz"),
        if in_phase { "in phase" } else { "out of phase" },
        format!("correlation of x₁ and x₂ {alike:.2}, impacts/cycles {}", portrait.pattern.regime)
            .replace('-', "−"),
        (alike > 0.0) == in_phase,
        why,
    );
    let figure = figures::traces(title, &portrait, rig.gap).height(100.0);
    Ok((figure, claim))
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
            "irregular, by the integration and by impacts without duration",
            format!("impacts/cycles {}, J {:.6} N s", portrait.pattern.regime, last.impulse),
            !once,
            "exact flights with located impacts repeat to rounding, and their impacts have no duration either: the integration alone is left",
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
        let agrees = match found {
            Regime::Irregular => thesis == "irregular",
            Regime::Periodic { impacts: 1, cycles: 1 } => thesis != "irregular",
            _ => false,
        };
        let (mut others, mut values) = (Vec::new(), format!("{force} N"));
        for other in [0.7, 0.2112] {
            let pattern = settled(other, force, hz)?;
            others.push(format!("{pattern} with R {other}"));
            if pattern != found {
                values = format!("R {restitution} and {force} N");
            }
        }
        let here = format!("impacts/cycles {found}; {}", others.join(", "));
        let figure = if hz < 7.0 { "5.2" } else { "5.3" };
        let claim = Claim::told(format!("{figure}: impacts at {hz} Hz"), thesis, here, agrees, "");
        claims.push(claim.only_with(&values));
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
