//! A striker of a hammer drill, seen by a vibrometer, and a pulse a turn of the crank.

use super::disturbance::{Mix, convert};
use super::record::{Answer, Kind, Record};
use std::f64::consts::{PI, TAU};
use vibroimpact::measure::drill::{AngleOrigin, Beam, DrillOptions, Edge, Slices, drill};

pub const KINDS: &[Kind] = &[Kind {
    name: "hammer drill",
    ranges: "20 to 60 turns a second, 12 to 50 turns at 20 to 60 kHz, one impact a turn of 1 to 9 m/s with 0.2 to 5 % of scatter, R 0.2 to 0.95 with up to 5 %, \
        phase with 0.0001 to 0.01 turns, contact 0.02 to 0.15 ms; white noise 0.0003 to 0.02 of the speed; half each with 1/f noise, a velocity offset of 0.1 to 2 %, \
        drop-outs of 0.05 to 1 ms (lines held or spikes), 12 bits",
    every: 1,
    draw,
}];

fn draw(mix: &mut Mix) -> Record {
    let (rate, speed) = (mix.log(20e3, 60e3), mix.log(20.0, 60.0));
    let turns = mix.random.between(12.0, 50.0) as usize;
    mix.note("turns", turns as f64);
    let (striker, struck) = (0.1, mix.log(0.1, 1.0));
    let (before, r) = (mix.log(1.0, 9.0), mix.random.between(0.2, 0.95));
    mix.note("R", r);
    let (speed_scatter, r_scatter) = (mix.some(1.0, "scatter of speed", 0.002, 0.05), mix.log(0.001, 0.05));
    let phase = mix.random.between(0.1, 0.9);
    let (phase_scatter, turn_scatter) = (mix.some(1.0, "scatter of phase", 1e-4, 0.01), mix.log(1e-4, 0.01));
    let contact = mix.some(1.0, "contact in ms", 0.02, 0.15) * 1e-3;
    let bend = mix.random.between(-0.3, 0.3) * before;
    // Edges of the reference, and impacts with their velocities; some before the first turn and behind the
    // last.
    let mut edges = vec![0.003];
    for _ in 0..turns + 4 {
        edges.push(edges[edges.len() - 1] + (1.0 + turn_scatter * mix.random.normal()) / speed);
    }
    let impacts: Vec<[f64; 3]> = edges
        .windows(2)
        .map(|edge| {
            let at = edge[0] + (phase + phase_scatter * mix.random.normal()) * (edge[1] - edge[0]);
            let v = before * (1.0 + speed_scatter * mix.random.normal());
            let r = r * (1.0 + r_scatter * mix.random.normal());
            [at, v, v * (striker - r * struck) / (striker + struck)]
        })
        .collect();
    let (from, to) = (edges[1] + 0.5 / speed, edges[turns + 1] + 0.5 / speed);
    let n = ((to - from) * rate) as usize;
    let mut values: Vec<f64> =
        (0..n).map(|i| velocity(&impacts, from + i as f64 / rate, contact, bend)).collect();
    let noise = mix.log(3e-4, 0.02) * before;
    mix.note("white noise", noise / before);
    mix.add_white(&mut values, noise);
    let pink = mix.some(0.5, "1/f noise to white", 0.3, 3.0);
    mix.add_pink(&mut values, pink * noise);
    let offset = mix.some(0.5, "offset", 1e-3, 0.02) * before;
    for v in &mut values {
        *v += offset;
    }
    if mix.chance(0.5) {
        mix.note("converter", 1.0);
        convert(&mut values, 1.5 * before, 12);
    }
    let faults = mix.some(0.5, "drop-outs", 1.0, 20.0) as usize;
    for _ in 0..faults {
        let (start, length) =
            (mix.random.between(0.0, n as f64) as usize, (mix.log(5e-5, 1e-3) * rate).ceil() as usize);
        let spikes = mix.chance(0.5);
        let held = values[start];
        for v in values.iter_mut().skip(start).take(length) {
            *v = if spikes { before * mix.random.between(-4.0, 4.0) } else { held };
        }
    }
    let rise = mix.log(0.5, 5.0) / rate;
    let reference: Vec<f64> = (0..n)
        .map(|i| {
            let t = from + i as f64 / rate;
            let since = t - edges.iter().rfind(|e| **e <= t + 0.5 * rise).unwrap_or(&0.0);
            let pulse = if since < 0.1 / speed { (0.5 + since / rise).min(1.0) } else { 0.0 };
            5.0 * pulse + 0.01 * mix.random.normal()
        })
        .collect();
    let whole: Vec<&[f64]> = edges.windows(2).filter(|e| e[0] > from && e[1] < to).collect();
    let counted = impacts.iter().filter(|i| i[0] > whole[0][0] && i[0] < whole[whole.len() - 1][1]).count();
    mix.note("impacts", counted as f64);
    let mut record = Record::default();
    let Ok(beam) = Beam::new(0.0, AngleOrigin::Axis) else { return record };
    let mut options = DrillOptions::new(1.0, beam, 1, Edge::Rising);
    (options.mass, options.struck_mass) = (Some(striker), Some(struck));
    let found = drill(&Slices { rate, channels: vec![&values, &reference] }, &options, None).ok();
    let found = found.as_ref();
    let after = before * (striker - r * struck) / (striker + struck);
    record.answers.push(Answer::new("speed", speed, found.map(|d| &d.speed)));
    record.answers.push(Answer::new("phase", phase, found.and_then(|d| d.phase.as_ref())));
    record.answers.push(Answer::new("velocity before", before, found.and_then(|d| d.before.as_ref())));
    record.answers.push(Answer::new("velocity after", after, found.and_then(|d| d.after.as_ref())));
    record.answers.push(Answer::new("restitution", r, found.and_then(|d| d.restitution.as_ref())));
    record
}

/// Velocity of a striker that comes back to the same place every turn: a straight line between impacts with
/// as much of a half sine as its mean needs, and a full sine.
fn velocity(impacts: &[[f64; 3]], t: f64, contact: f64, bend: f64) -> f64 {
    let next = impacts.partition_point(|i| i[0] <= t).clamp(1, impacts.len() - 1);
    let ([from, before, v0], [to, v1, after]) = (impacts[next - 1], impacts[next]);
    let u = (t - from) / (to - from);
    let free = |u: f64| v0 + (v1 - v0) * u - 0.25 * PI * (v0 + v1) * (PI * u).sin() + bend * (TAU * u).sin();
    // A half wave of the cosine through the contact, whose middle is the impact.
    let blend = |since: f64| 0.5 * (1.0 + (PI * since / contact).sin());
    if t - from < 0.5 * contact {
        let part = blend(t - from);
        return before * (1.0 - part) + free(u) * part;
    }
    if to - t < 0.5 * contact {
        let part = blend(t - to);
        return free(u) * (1.0 - part) + after * part;
    }
    free(u)
}
