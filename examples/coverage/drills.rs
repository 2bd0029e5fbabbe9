//! Random records of a hammer drill, to check how often the stated uncertainties of its impacts cover the
//! truth: the velocity of the striker, as a vibrometer shows it, and one reference pulse per turn of the
//! crank.

use super::disturbance::{Mix, convert};
use super::record::{Answer, Kind, Record};
use std::f64::consts::{PI, TAU};
use vibroimpact::measure::drill::{AngleOrigin, Beam, DrillOptions, Edge, Slices, drill};

/// The kinds of records drawn here.
pub const KINDS: &[Kind] = &[Kind {
    name: "hammer drill",
    ranges: "20 to 60 turns a second, 12 to 50 turns at 20 to 60 kHz, one impact a turn of 1 to 9 m/s with 0.2 to 5 % of scatter, R 0.2 to 0.95 with up to 5 %, \
        phase with 0.0001 to 0.01 turns, contact 0.02 to 0.15 ms; white noise 0.0003 to 0.02 of the speed; half each with 1/f noise, a velocity offset of 0.1 to 2 %, \
        drop-outs of 0.05 to 1 ms (lines held or spikes), 12 bits",
    every: 1,
    draw,
}];

/// Mass of the striker in kg.
const STRIKER: f64 = 0.1;

/// An impact of the striker: its time in s, and the velocities before and after it in m/s, positive towards
/// the struck body.
struct Impact {
    time: f64,
    before: f64,
    after: f64,
}

/// The true motion of a hammer drill.
struct Hammer {
    /// Turns per second of the crank, and number of turns in the record.
    speed: f64,
    turns: usize,
    /// Mass of the struck body in kg.
    struck: f64,
    /// Mean velocity before an impact in m/s, and mean coefficient of restitution.
    before: f64,
    restitution: f64,
    /// Mean place of the impact in a turn, 0 to 1.
    phase: f64,
    /// Duration of a contact in s.
    contact: f64,
    /// Amplitude in m/s of a full sine in the free motion.
    sine: f64,
    /// Times of the reference pulses in s.
    edges: Vec<f64>,
    impacts: Vec<Impact>,
}

impl Hammer {
    /// Draws the motion, with an impact in each turn. Some lie before the first turn of the record and
    /// after the last.
    fn draw(mix: &mut Mix, speed: f64) -> Hammer {
        let turns = mix.random.between(12.0, 50.0) as usize;
        mix.note("turns", turns as f64);
        let struck = mix.log(0.1, 1.0);
        let (before, restitution) = (mix.log(1.0, 9.0), mix.random.between(0.2, 0.95));
        mix.note("R", restitution);
        let (before_scatter, restitution_scatter) =
            (mix.some(1.0, "scatter of speed", 0.002, 0.05), mix.log(0.001, 0.05));
        let phase = mix.random.between(0.1, 0.9);
        let (phase_scatter, turn_scatter) =
            (mix.some(1.0, "scatter of phase", 1e-4, 0.01), mix.log(1e-4, 0.01));
        let contact = mix.some(1.0, "contact in ms", 0.02, 0.15) * 1e-3;
        let sine = mix.random.between(-0.3, 0.3) * before;
        let mut edges = vec![0.003];
        for _ in 0..turns + 4 {
            edges.push(edges[edges.len() - 1] + (1.0 + turn_scatter * mix.random.normal()) / speed);
        }
        let impact = |turn: &[f64]| {
            let time = turn[0] + (phase + phase_scatter * mix.random.normal()) * (turn[1] - turn[0]);
            let before = before * (1.0 + before_scatter * mix.random.normal());
            let r = restitution * (1.0 + restitution_scatter * mix.random.normal());
            Impact { time, before, after: rebound(before, r, struck) }
        };
        let impacts = edges.windows(2).map(impact).collect();
        Hammer { speed, turns, struck, before, restitution, phase, contact, sine, edges, impacts }
    }

    /// Start and end of the record in s, each half a turn after a reference pulse.
    fn span(&self) -> (f64, f64) {
        (self.edges[1] + 0.5 / self.speed, self.edges[self.turns + 1] + 0.5 / self.speed)
    }

    /// Number of impacts in the whole turns of the record.
    fn counted(&self) -> usize {
        let (from, to) = self.span();
        let whole: Vec<&[f64]> = self.edges.windows(2).filter(|e| e[0] > from && e[1] < to).collect();
        let within = |i: &&Impact| i.time > whole[0][0] && i.time < whole[whole.len() - 1][1];
        self.impacts.iter().filter(within).count()
    }

    /// Velocity of the striker at `t` s. Between impacts it is a straight line, a half sine that brings the
    /// striker back to the same place every turn, and a full sine.
    fn velocity(&self, t: f64) -> f64 {
        let next = self.impacts.partition_point(|i| i.time <= t).clamp(1, self.impacts.len() - 1);
        let [last, next] = [&self.impacts[next - 1], &self.impacts[next]];
        let (v0, v1) = (last.after, next.before);
        let u = (t - last.time) / (next.time - last.time);
        let free = |u: f64| {
            v0 + (v1 - v0) * u - 0.25 * PI * (v0 + v1) * (PI * u).sin() + self.sine * (TAU * u).sin()
        };
        // Through the contact the velocity follows half a cosine wave; the impact is in its middle.
        let blend = |since: f64| 0.5 * (1.0 + (PI * since / self.contact).sin());
        if t - last.time < 0.5 * self.contact {
            let part = blend(t - last.time);
            return last.before * (1.0 - part) + free(u) * part;
        }
        if next.time - t < 0.5 * self.contact {
            let part = blend(t - next.time);
            return free(u) * (1.0 - part) + next.after * part;
        }
        free(u)
    }
}

/// Velocity of the striker after an impact on a body at rest with mass `struck` (kg).
fn rebound(before: f64, r: f64, struck: f64) -> f64 {
    before * (STRIKER - r * struck) / (STRIKER + struck)
}

/// Adds the disturbances of a vibrometer to the velocity of the striker: noise, an offset, the steps of a
/// converter, and drop-outs, in which the value is held or spikes.
fn disturb_velocity(mix: &mut Mix, values: &mut [f64], rate: f64, before: f64) {
    let n = values.len();
    let noise = mix.log(3e-4, 0.02) * before;
    mix.note("white noise", noise / before);
    mix.add_white(values, noise);
    let pink = mix.some(0.5, "1/f noise to white", 0.3, 3.0);
    mix.add_pink(values, pink * noise);
    let offset = mix.some(0.5, "offset", 1e-3, 0.02) * before;
    for v in values.iter_mut() {
        *v += offset;
    }
    if mix.chance(0.5) {
        mix.note("converter", 1.0);
        convert(values, 1.5 * before, 12);
    }
    let dropouts = mix.some(0.5, "drop-outs", 1.0, 20.0) as usize;
    for _ in 0..dropouts {
        let (start, length) =
            (mix.random.between(0.0, n as f64) as usize, (mix.log(5e-5, 1e-3) * rate).ceil() as usize);
        let spikes = mix.chance(0.5);
        let held = values[start];
        for v in values.iter_mut().skip(start).take(length) {
            *v = if spikes { before * mix.random.between(-4.0, 4.0) } else { held };
        }
    }
}

/// Draws the velocity of a striker and the pulses of its crank. Compares rotational speed, phase of the
/// impacts, velocities and restitution with the truth.
fn draw(mix: &mut Mix) -> Record {
    let (rate, speed) = (mix.log(20e3, 60e3), mix.log(20.0, 60.0));
    let hammer = Hammer::draw(mix, speed);
    let (from, to) = hammer.span();
    let n = ((to - from) * rate) as usize;
    let mut values: Vec<f64> = (0..n).map(|i| hammer.velocity(from + i as f64 / rate)).collect();
    disturb_velocity(mix, &mut values, rate, hammer.before);
    // A pulse of 5 V in the first tenth of each turn, with a rise of a few samples.
    let rise = mix.log(0.5, 5.0) / rate;
    let reference: Vec<f64> = (0..n)
        .map(|i| {
            let t = from + i as f64 / rate;
            let since = t - hammer.edges.iter().rfind(|e| **e <= t + 0.5 * rise).unwrap_or(&0.0);
            let pulse = if since < 0.1 / speed { (0.5 + since / rise).min(1.0) } else { 0.0 };
            5.0 * pulse + 0.01 * mix.random.normal()
        })
        .collect();
    mix.note("impacts", hammer.counted() as f64);
    let mut record = Record::default();
    let Ok(beam) = Beam::new(0.0, AngleOrigin::Axis) else { return record };
    let mut options = DrillOptions::new(1.0, beam, 1, Edge::Rising);
    (options.mass, options.struck_mass) = (Some(STRIKER), Some(hammer.struck));
    let found = drill(&Slices { rate, channels: vec![&values, &reference] }, &options, None).ok();
    let found = found.as_ref();
    let Hammer { before, restitution, phase, struck, .. } = hammer;
    let after = rebound(before, restitution, struck);
    record.answers.push(Answer::new("speed", speed, found.map(|d| &d.speed)));
    record.answers.push(Answer::new("phase", phase, found.and_then(|d| d.phase.as_ref())));
    record.answers.push(Answer::new("velocity before", before, found.and_then(|d| d.before.as_ref())));
    record.answers.push(Answer::new("velocity after", after, found.and_then(|d| d.after.as_ref())));
    record.answers.push(Answer::new("restitution", restitution, found.and_then(|d| d.restitution.as_ref())));
    record
}
