//! Simulated motions at one frequency: in phase, out of phase, regular and irregular.

use crate::scene::{hertz, rig, under_sine};
use crate::sheet::{Claim, Sheet};
use crate::sweeps::CONTACT;
use vibroimpact::analysis::figures;
use vibroimpact::figure::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series};
use vibroimpact::model::portrait::{Portrait, PortraitOptions};
use vibroimpact::model::regime::regime;
use vibroimpact::model::{Chirp, Compliant, Excitation, Motion, Regime, Rig, Simulation, Sine, State};
use vibroimpact::{Error, Result};

pub fn sheets() -> Result<Vec<Sheet>> {
    let mut all = vec![eleven()?, irregular()?];
    for (name, title, hz, in_phase) in [
        ("motion_grazing", "Motion at the grazing resonance, sweeping up", 5.5, true),
        ("motion_clapping", "Motion at the clapping resonance, sweeping up", 10.4, false),
    ] {
        all.push(swept_to(name, title, hz, in_phase)?);
    }
    Ok(all)
}

/// The motion that a sweep up with a sine of 0.1 N has at `hz`.
fn swept_to(name: &'static str, title: &'static str, hz: f64, in_phase: bool) -> Result<Sheet> {
    let rig = Rig::thesis();
    let start = 3.0;
    let sine = Excitation::Sine(Sine { force: 0.1, frequency: start });
    let mut motion = Compliant::new(&rig, &sine, CONTACT, State::REST, 0.0)?;
    Chirp::new(0.02).advance(&mut motion, (hz - start) / 0.02, &mut |_| {})?;
    motion.advance(motion.time() + 300.0 / hz, &mut |_| {})?;
    let portrait = Portrait::take(&mut motion, &PortraitOptions { cycles: 40, samples: 150, shown: 4 })?;
    let product: f64 = portrait.states.iter().map(|s| s.x1 * s.x2).sum();
    let squares = |of: fn(&State) -> f64| portrait.states.iter().map(|s| of(s).powi(2)).sum::<f64>().sqrt();
    let alike = product / squares(|s| s.x1) / squares(|s| s.x2);
    let claims = vec![Claim::told(
        format!("motion of both masses at {hz} Hz"),
        if in_phase { "in phase" } else { "out of phase" },
        format!("correlation of x₁ and x₂ {alike:.2}, impacts/cycles {}", portrait.pattern.regime)
            .replace('-', "−"),
        (alike > 0.0) == in_phase,
        "",
    )];
    let figure = figures::traces(title, &portrait, rig.gap).height(100.0);
    Ok(Sheet::new(name, title, figure, claims))
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
            "irregular",
            format!("impacts/cycles {}, J {:.6} N s", portrait.pattern.regime, last.impulse),
            !once,
            "its simulation had an error of integration; exact flights with located impacts repeat to rounding",
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
    Ok(Sheet::new("motion_11hz", "The motion at 11.1 Hz with classical impacts", figure, claims))
}

/// Regime at a frequency in Hz, from rest.
fn settled(restitution: f64, force: f64, frequency: f64) -> Result<Regime> {
    let mut motion = Simulation::new(&rig(restitution), &Sine { force, frequency })?;
    Ok(regime(&mut motion, 3000, 300)?.regime)
}

fn irregular() -> Result<Sheet> {
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
        let mut others = Vec::new();
        for restitution in [0.7, 0.2112] {
            others.push(format!("{} with R {restitution}", settled(restitution, force, hz)?));
        }
        let why =
            format!("with R {restitution} and {force} N, which are not stated ({} )", others.join(", "))
                .replace(" )", ")");
        claims.push(Claim::told(
            format!("impacts at {hz} Hz"),
            thesis,
            format!("impacts/cycles {found}"),
            agrees,
            &why,
        ));
    }
    let figure = figure.caption(
        "Approach speed from impact to impact, sine of 0.3 N, R = 0.98, after 3000 cycles from rest.",
    );
    Ok(Sheet::new("motion_irregular", "Impact patterns at 5.61 and 7.49 Hz", figure, claims))
}
