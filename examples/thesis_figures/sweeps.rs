//! Simulated sweeps as in the thesis: 0.02 Hz/s, running RMS, contact of 1e5 N/m with a damper of 0.1 N
//! s/m, gap 1 mm.

use crate::scene::{self, hertz, peak};
use crate::sheet::{Claim, Sheet};
use crate::sine;
use std::f64::consts::TAU;
use vibroimpact::Result;
use vibroimpact::analysis::figures;
use vibroimpact::figure::{AxisSpec, Figure, Marker, Panel, Plot, Series};
use vibroimpact::model::contact::conversion;
use vibroimpact::model::regime::regime;
use vibroimpact::model::sweep::{Observable, Pace, Plan, Point, Swept, apart};
use vibroimpact::model::{
    Buffer, Compliant, Excitation, Law, Motion, Pulses, Reaction, Regime, Rig, Simulation, Sine, State,
};
use vibroimpact::record::Direction;

/// Contact of the thesis' simulations.
pub const CONTACT: Law = Law::spring(1e5, 0.1);

/// Ranges in Hz in which the grazing and the clapping resonance are sought.
const TWO: [(f64, f64); 2] = [(4.0, 8.0), (8.0, 14.0)];

/// Range in Hz in which the largest value of the downward sweep is sought.
const LOW: [(f64, f64); 1] = [(4.0, 14.0)];

/// Forces in N beside that of a figure, since the thesis states none.
const OTHERS: [f64; 4] = [0.2, 0.5, 1.0, 1.5];

const BOTH: [Direction; 2] = [Direction::Up, Direction::Down];

pub fn sheets() -> Result<Vec<Sheet>> {
    Ok(vec![sine_force()?, forces()?, pulse()?, loose()?, classical()?, reaction()?])
}

fn plan(from: f64, to: f64) -> Plan {
    Plan { from, to, pace: Pace::Rate { rate: 0.02, points: 2400 }, observable: Observable::Rms }
}

fn sine_of(force: f64, frequency: f64) -> Excitation {
    Excitation::Sine(Sine { force, frequency })
}

/// Sweeps in both directions with force amplitude `force` (N); `make` returns the motion at the start
/// frequency (Hz).
fn swept<M: Motion>(plan: &Plan, force: f64, make: impl Fn(f64) -> Result<M> + Sync) -> Result<Swept> {
    apart(&BOTH, |direction| {
        let start = if direction == Direction::Up { plan.from } else { plan.to };
        plan.frequency(&mut make(start)?, force, direction)
    })
}

/// Frequency in Hz and running RMS in m of the largest x₁ between two frequencies.
fn highest(points: &[Point], from: f64, to: f64) -> (f64, f64) {
    let inside = points.iter().filter(|p| (from..=to).contains(&p.frequency));
    inside.max_by(|a, b| a.x1.total_cmp(&b.x1)).map_or((f64::NAN, f64::NAN), |p| (p.frequency, p.x1))
}

/// Sweep figure of both masses. In each range (Hz) of `up` and `down` the largest x₁ is labelled with its
/// frequency.
fn picture(swept: &Swept, up: &[(f64, f64)], down: &[(f64, f64)], caption: &str) -> Figure {
    let mut figure = figures::sweep(swept, &[], &[], Observable::Rms, false).height(120.0).caption(caption);
    for (points, ranges, way) in [(&swept.up, up, ""), (&swept.down, down, ", down")] {
        for (from, to) in ranges {
            let (at, height) = highest(points, *from, *to);
            if let Some(Panel::Plot(plot)) = figure.panels.first_mut() {
                *plot = plot.clone().note(format!("{at:.2} Hz{way}"), at, height);
            }
        }
    }
    figure
}

/// Frequency in Hz and running RMS in m of the clapping resonance going up, and the largest running RMS
/// within 0.5 Hz of it going down.
fn both_ways(swept: &Swept) -> (f64, f64, f64) {
    let [_, (from, to)] = TWO;
    let (at, up) = highest(&swept.up, from, to);
    (at, up, highest(&swept.down, at - 0.5, at + 0.5).1)
}

/// Whether the clapping resonance going up has impacts, and going down not half its size.
pub fn only_up(swept: &Swept) -> bool {
    let (at, up, down) = both_ways(swept);
    largest_force(&swept.up, |r| r.impulse, at - 0.01, at + 0.01).0 > 0.0 && down < 0.5 * up
}

/// Claim: whether the clapping resonance of the upward sweep is absent in the downward sweep, with the force
/// of this sweep and the other forces (N) of `others`.
fn clapping(swept: &Swept, force: f64, others: &[f64], with: impl Fn(f64) -> Result<Swept>) -> Result<Claim> {
    let (at, up, down) = both_ways(swept);
    let here = format!("up {:.2} mm at {at:.2} Hz, down at most {:.2} mm near it", 1e3 * up, 1e3 * down);
    let mut tried = vec![(force, only_up(swept))];
    for force in others {
        tried.push((*force, only_up(&with(*force)?)));
    }
    Ok(Claim::told("clapping resonance", "only going up", here, true, "").of_forces("", &tried))
}

fn sine_force() -> Result<Sheet> {
    let rig = Rig::thesis();
    let with = |force| {
        let make = |f| Compliant::new(&rig, &sine_of(force, f), CONTACT, State::REST, 0.0);
        swept(&plan(3.0, 14.0), force, make)
    };
    let swept = with(0.1)?;
    let [(grazing, first), (second_at, second)] = TWO.map(|(from, to)| highest(&swept.up, from, to));
    let down = highest(&swept.down, 4.0, 14.0).0;
    let mut larger = vec![(0.1, first > second)];
    for force in OTHERS {
        let up = with(force)?.up;
        let [first, second] = TWO.map(|(from, to)| highest(&up, from, to).1);
        larger.push((force, first > second));
    }
    let claims = vec![
        Claim::number("largest below 8 Hz, up", "5.58", grazing, (2, "Hz"), "").recomputed(),
        Claim::number("grazing resonance on the rig", "5.6", grazing, (2, "Hz"), ""),
        Claim::number(
            "grazing resonance, the thesis' sine simulation",
            "4.66",
            grazing,
            (2, "Hz"),
            "no force gives it with both masses on their springs (next figure), but one with a loose mass comes near. 5.66 Hz may be meant: section 4.4 has a loose mass lower this resonance, to 4.73 Hz",
        ),
        Claim::number("clapping resonance, up", "10.59", second_at, (2, "Hz"), "").recomputed(),
        Claim::number("clapping resonance, the thesis' sine simulation", "10.61", second_at, (2, "Hz"), ""),
        Claim::number("largest, down", "5.44", down, (2, "Hz"), "").recomputed(),
        Claim::told(
            "first resonance",
            "linear",
            format!("{grazing:.2} Hz up, {down:.2} Hz down"),
            (grazing - down).abs() < 0.005 * grazing,
            "it depends on the direction, as the second does; the force moves it little (next figure)",
        ),
        Claim::told(
            "first peak beside the second, up",
            "the larger",
            format!("{:.2} and {:.2} mm", 1e3 * first, 1e3 * second),
            first > second,
            "",
        )
        .of_forces("", &larger),
        clapping(&swept, 0.1, &OTHERS, with)?,
    ];
    let figure = picture(
        &swept,
        &TWO,
        &LOW,
        "Running RMS of both masses, sine of 0.1 N, 3 to 14 Hz at 0.02 Hz/s and back.",
    );
    Ok(Sheet::new("sweep_sine", "Figures 4.11, 4.12, 4.14 and 4.15: sweep with a sine", figure, claims))
}

/// Peaks of sweeps with other forces, since the thesis does not state its amplitudes.
fn forces() -> Result<Sheet> {
    let rig = Rig::thesis();
    let forces = [0.05, 0.07, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0];
    let mut found = (Vec::new(), Vec::new());
    for force in forces {
        let make = |f| Compliant::new(&rig, &sine_of(force, f), CONTACT, State::REST, 0.0);
        let swept = swept(&plan(3.0, 14.0), force, make)?;
        found.0.push(highest(&swept.up, 3.0, 7.0).0);
        found.1.push(highest(&swept.up, 7.0, 14.0).0);
    }
    // The claim is judged by the computed value that is nearest to the thesis' value.
    let claim = |what: &str, printed: &str, found: &[f64], why: &str| {
        let stated: f64 = printed.parse().unwrap_or(f64::NAN);
        let (least, most) = range(found);
        let here = format!("{least:.2} to {most:.2} Hz");
        Claim::told(what, format!("{printed} Hz"), here, true, "").against(
            printed,
            stated.clamp(least, most),
            why,
        )
    };
    let [first, second] = rig.natural_frequencies();
    let both = ((rig.k1 + rig.k2) / (rig.m1 + rig.m2)).sqrt() / TAU;
    let lossy = hertz(peak(1.5, 2.4, |nu| sine::impulse(&scene::rig(0.7), 0.1, nu)).0);
    let limit = sine::limit();
    let axis = |low: f64, high: f64| AxisSpec::new("Frequency of the peak", "Hz").limits(low, high);
    let force = || AxisSpec::new("Force F₀", "N").log();
    let figure = Figure::double("Peaks over force")
        .height(70.0)
        .columns(2)
        .panel(
            Plot::new(force(), axis(4.5, 6.0))
                .title("(a) below 7 Hz")
                .with(Series::points("", forces, found.0.clone()).marker(Marker::Circle))
                .with(Series::horizontal("rig", 5.6))
                .with(Series::horizontal("thesis' simulation", 4.66)),
        )
        .panel(
            Plot::new(force(), axis(9.0, 12.0))
                .title("(b) above 7 Hz")
                .with(Series::points("", forces, found.1.clone()).marker(Marker::Circle))
                .with(Series::horizontal("rig, at most", 11.5))
                .with(Series::horizontal("rig, repeated", 9.5)),
        )
        .caption("Frequencies of the largest running RMS of the excited mass when sweeping up at 0.02 Hz/s, over the force.");
    let mut claims = vec![
        claim(
            "4.11: grazing resonance in the sine simulation",
            "4.66",
            &found.0,
            &format!(
                "the masses have {first:.2} and {second:.2} Hz alone and {both:.2} Hz together; a loose mass comes near"
            ),
        ),
        claim(
            "5.1.1: clapping resonance on the rig, in the repeat",
            "9.5",
            &found.1,
            &format!(
                "this contact loses little: with R 0.7 and 0.1 N the closed form has its peak at {lossy:.2} Hz"
            ),
        ),
        claim(
            "5.1.1: clapping resonance on the rig, at most",
            "11.5",
            &found.1,
            &format!(
                "the closed form goes to ν {limit:.3}, {:.2} Hz, with the force: the rig is not quite these numbers",
                hertz(limit)
            ),
        ),
    ];
    claims.extend(compared(range(&found.0), range(&found.1)));
    Ok(Sheet::new(
        "sweep_forces",
        "Beside 4.11 and section 5.2: peaks of the sweeps over the force",
        figure,
        claims,
    ))
}

/// The smallest and the largest of some values.
fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, 0.0), |(least, most), v| (v.min(least), v.max(most)))
}

/// Claims of section 5.2 on both resonances of the simulation (ranges in Hz), beside those of the closed
/// form.
fn compared(grazing: (f64, f64), clapping: (f64, f64)) -> Vec<Claim> {
    let closed = |low, high| {
        let of = |force| peak(low, high, |nu| sine::impulse(&scene::rig(1.0), force, nu)).0;
        range(&[0.05, 0.1, 0.5, 0.9].map(of))
    };
    let (first, second) = (closed(1.0, 1.15), closed(1.5, 2.4));
    let percent = |(least, most): (f64, f64)| 100.0 * (most / least - 1.0);
    let (least, most) = (hertz(first.0), hertz(first.1));
    vec![
        Claim::told(
            "5.2: clapping resonance of the closed form over the force",
            "constant",
            format!("ν {:.3} to {:.3} for 0.05 to 0.9 N, R 1", second.0, second.1),
            percent(second) < 0.5,
            "the threshold of the programs hides it (3.4)",
        ),
        Claim::told(
            "5.2: clapping resonance of the simulation over the force",
            "varies slightly",
            format!(
                "by {:.0} % from 0.05 to 1 N, the closed form by {:.0} %",
                percent(clapping),
                percent(second)
            ),
            percent(clapping) < 10.0,
            "beside 21 % on the rig, 9.5 to 11.5 Hz; the closed form, which section 5.2 calls constant, varies about as much",
        ),
        Claim::told(
            "5.2: grazing resonances of rig, closed form and simulation",
            "about equal",
            format!("5.6, {least:.2} to {most:.2} and {:.2} to {:.2} Hz", grazing.0, grazing.1),
            grazing.1 < 1.1 * least,
            "but for its own 4.66 Hz",
        ),
    ]
}

fn pulse() -> Result<Sheet> {
    let rig = Rig::thesis();
    let make = |force, frequency| {
        let pulses = Excitation::Pulse(Pulses { force, width: 0.01, frequency });
        Compliant::new(&rig, &pulses, CONTACT, State::REST, 0.0)
    };
    let with = |force| swept(&plan(3.0, 14.0), force, |f| make(force, f));
    // The thesis' range, and a separate sweep below it. Between 6 and 7.5 Hz the motion is irregular, and
    // the start decides whether the sweep leaves this range with impacts.
    let mut swept = with(0.5)?;
    let below = plan(1.5, 3.0).frequency(&mut make(0.5, 1.5)?, 0.5, Direction::Up)?;
    swept.up.splice(0..0, below);
    let at = |from, to| highest(&swept.up, from, to).0;
    let down = highest(&swept.down, 4.0, 14.0).0;
    let held = regime(&mut make(0.5, 6.5)?, 1000, 300)?.regime;
    let claims = vec![
        Claim::number("grazing resonance, up", "5.58", at(4.0, 8.0), (2, "Hz"), "").recomputed(),
        Claim::number(
            "grazing resonance, the thesis' pulse simulation",
            "5.66",
            at(4.0, 8.0),
            (2, "Hz"),
            "its force is not stated",
        ),
        Claim::number("clapping resonance, up", "10.71", at(8.0, 14.0), (2, "Hz"), "").recomputed(),
        Claim::number(
            "clapping resonance, the thesis' pulse simulation",
            "10.72",
            at(8.0, 14.0),
            (2, "Hz"),
            "",
        ),
        Claim::number("sub-harmonic peak, 1/2, up", "2.81", at(2.3, 3.3), (2, "Hz"), "").recomputed(),
        Claim::number("sub-harmonic peak, 1/3, up", "1.87", at(1.6, 2.2), (2, "Hz"), "").recomputed(),
        Claim::number("largest, down", "5.42", down, (2, "Hz"), "").recomputed(),
        clapping(&swept, 0.5, &[0.6, 1.0, 1.5, 2.0], with)?,
        Claim::told(
            "4.16, 4.17: noise, here after 1000 cycles at 6.5 Hz from rest",
            "errors of the integration",
            format!("impacts/cycles {held}"),
            held != Regime::Irregular,
            "the motion itself is irregular there",
        ),
    ];
    let figure = picture(
        &swept,
        &[(1.6, 2.2), (2.3, 3.3), TWO[0], TWO[1]],
        &LOW,
        "Running RMS of both masses, rectangular pulses of 0.5 N and 10 ms, 3 to 14 Hz at 0.02 Hz/s and back, and 1.5 to 3 Hz.",
    );
    Ok(Sheet::new("sweep_pulse", "Figures 4.16 to 4.19: sweep with pulses", figure, claims))
}

fn loose() -> Result<Sheet> {
    let rig = Rig::thesis();
    // Fewer points than in the other sweeps: the motion is irregular, and its curves take more space.
    let plan = Plan { pace: Pace::Rate { rate: 0.02, points: 1500 }, ..plan(3.0, 14.0) };
    let make = |buffer, phase| {
        swept(&plan, 0.1, |f| {
            Compliant::loose(&rig, &sine_of(0.1, f), buffer, Some(CONTACT), State::REST, phase)
        })
    };
    // A force that begins at zero, as the sine of a simulation does, gives the loose mass a velocity.
    let swept = make(Buffer::thesis(), 0.75 * TAU)?;
    let crest = make(Buffer::thesis(), 0.0)?;
    let always = make(Buffer { damper_always: true, ..Buffer::thesis() }, 0.75 * TAU)?;
    let [(grazing, height), (clapping, up)] = TWO.map(|(from, to)| highest(&swept.up, from, to));
    let (lower, damped) = highest(&always.up, 4.0, 8.0);
    let force = |from, to| largest_force(&swept.up, |r| r.rms, from, to);
    let first = force(4.0, 7.0);
    let [(down_at, down), (_, still)] = [&swept, &crest].map(|s| highest(&s.down, 7.0, 9.5));
    let claims = vec![
        Claim::number("grazing resonance, up", "4.66", grazing, (2, "Hz"), "").recomputed(),
        Claim::told("its running RMS, up", "(19.5 mm)", format!("{:.1} mm", 1e3 * height), true, "").against(
            "19.5",
            1e3 * height,
            "there its highest instant, here the mean over a point; the motion is irregular",
        ),
        Claim::number("clapping resonance, up", "10.23", clapping, (2, "Hz"), "").recomputed(),
        Claim::number(
            "grazing resonance, the thesis' loose-mass simulation",
            "4.73",
            grazing,
            (2, "Hz"),
            "the motion is irregular there, and the force is not stated",
        ),
        Claim::number(
            "clapping resonance, the thesis' loose-mass simulation",
            "10.27",
            clapping,
            (2, "Hz"),
            "",
        ),
        Claim::told(
            "clapping resonance going down",
            "smaller",
            format!("{:.2} mm at {down_at:.2} Hz, {:.2} mm up", 1e3 * down, 1e3 * up),
            (0.1..0.7).contains(&(down / up)),
            &format!("with one that begins with its crest the masses do not meet, {:.2} mm", 1e3 * still),
        )
        .only_with("a force that begins with a zero"),
        Claim::told(
            "grazing resonance, damper always on, up",
            "–",
            format!("{lower:.2} Hz, {:.1} mm", 1e3 * damped),
            damped < height,
            "a variant that is not the thesis': it loses more",
        ),
        Claim::told(
            "4.30: RMS force between the masses, up",
            "a peak at the first resonance",
            format!(
                "{:.2} N at {:.2} Hz, {:.2} N at {clapping:.2} Hz",
                first.0,
                first.1,
                force(clapping - 0.1, clapping + 0.1).0
            ),
            (first.1 - grazing).abs() < 0.3,
            "",
        ),
    ];
    let figure = picture(
        &swept,
        &TWO,
        &LOW,
        "Running RMS of both masses, sine of 0.1 N; spring and damper of the excited mass act in compression only, beyond 1 mm at rest.",
    );
    Ok(Sheet::new("sweep_loose", "Figures 4.26 to 4.30: sweep with a loose mass", figure, claims))
}

/// One of the quantities of the force between the masses.
type Part = fn(&Reaction) -> Option<f64>;

/// Largest value and its frequency in Hz between two frequencies.
fn largest_force(points: &[Point], value: Part, from: f64, to: f64) -> (f64, f64) {
    let inside = points.iter().filter(|p| (from..=to).contains(&p.frequency));
    let all = inside.map(|p| (value(&p.reaction).unwrap_or(0.0), p.frequency));
    all.fold((0.0, f64::NAN), |a, b| if b.0 > a.0 { b } else { a })
}

/// The force between the masses in the sweep with a sine of 0.1 N: peak, RMS and impulse a cycle.
fn reaction() -> Result<Sheet> {
    let rig = Rig::thesis();
    let make = |f| Compliant::new(&rig, &sine_of(0.1, f), CONTACT, State::REST, 0.0);
    let swept = swept(&plan(3.0, 14.0), 0.1, make)?;
    let top = |value: Part, from, to| largest_force(&swept.up, value, from, to);
    let [peak, rms, impulse]: [(f64, f64); 3] =
        [(|r| r.peak) as Part, |r| r.rms, |r| r.impulse].map(|value| top(value, 3.0, 14.0));
    let clapping = highest(&swept.up, 8.0, 14.0).0;
    let mut claims = vec![Claim::told(
        "RMS force, going up, is greatest",
        "at the second resonance",
        format!("{:.2} N at {:.2} Hz", rms.0, rms.1),
        (rms.1 - clapping).abs() < 0.1,
        "",
    )];
    for force in [0.1, 0.2] {
        claims.push(reduced(&rig, force)?);
    }
    claims.extend([Claim::told(
        "peak force and impulse a cycle, going up, largest",
        "–",
        format!("{:.1} N at {:.2} Hz, {:.2} mN s at {:.2} Hz", peak.0, peak.1, 1e3 * impulse.0, impulse.1),
        true,
        "at the clapping resonance, too",
    )]);
    let figure = figures::forces(&swept, false).caption(
        "Force between the masses in the sweep with a sine force of 0.1 N: peak, RMS, and impulse a cycle. The thesis' contact, 1e5 N/m.",
    );
    Ok(Sheet::new("reaction", "Figure 4.13: force between the masses", figure, claims))
}

/// Claim: whether the RMS force is smaller at the first resonance than below it, in an upward sweep with a
/// sine of `force` (N).
fn reduced(rig: &Rig, force: f64) -> Result<Claim> {
    let make = |f| Compliant::new(rig, &sine_of(force, f), CONTACT, State::REST, 0.0);
    let swept = plan(3.0, 8.0).frequency(&mut make(3.0)?, force, Direction::Up)?;
    let at = highest(&swept, 4.0, 8.0).0;
    let top = |from, to| largest_force(&swept, |r| r.rms, from, to);
    let (there, below) = (top(at - 0.01, at + 0.01), top(at - 0.6, at - 0.1));
    Ok(Claim::told(
        format!("RMS force at the first resonance, going up, sine of {force} N"),
        "reduced",
        format!("{:.2} N at {at:.2} Hz, up to {:.2} N at {:.2} Hz", there.0, below.0, below.1),
        there.0 < below.0,
        if there.0 < below.0 { "" } else { "x₁ and the force have their peaks together" },
    )
    .only_with(&format!("{force} N")))
}

/// Sweeps in both directions with a sine of `force` (N) and impacts without duration.
pub fn without_duration(rig: &Rig, force: f64) -> Result<Swept> {
    swept(&plan(3.0, 14.0), force, |f| Simulation::new(rig, &sine_of(force, f)))
}

fn classical() -> Result<Sheet> {
    // Restitution of the contact above on this rig: e^{−ζω₀t_c} with ζ = c₃/(2√(k₃M)).
    let ratio = 0.1 / (2.0 * (1e5 * Rig::thesis().reduced_mass()).sqrt());
    let restitution = conversion::restitution(ratio);
    let contact = conversion::duration(ratio, 1e5, Rig::thesis().reduced_mass());
    let rig = scene::rig(restitution);
    let with = |force| without_duration(&rig, force);
    let swept = with(0.1)?;
    let claims = vec![
        Claim::number("grazing resonance, up", "5.58", highest(&swept.up, 4.0, 8.0).0, (2, "Hz"), "")
            .recomputed(),
        Claim::number(
            "clapping resonance, up",
            "10.59",
            highest(&swept.up, 8.0, 14.0).0,
            (2, "Hz"),
            &format!("the {:.1} ms in contact are missing from each cycle", 1e3 * contact),
        )
        .recomputed(),
        Claim::number("largest, down", "5.44", highest(&swept.down, 4.0, 14.0).0, (2, "Hz"), "").recomputed(),
        clapping(&swept, 0.1, &OTHERS, with)?,
    ];
    let figure = picture(
        &swept,
        &TWO,
        &LOW,
        "As the sweep with a sine force, with impacts that take no time (classical impact) and lose as much.",
    );
    Ok(Sheet::new("sweep_classical", "Beside 4.3: sweep with classical impacts", figure, claims))
}
