//! Random drops of a ball that bounces on a plate, to check how often the stated uncertainty of the
//! coefficient of restitution covers the truth.

use super::disturbance::{Mix, convert, peak};
use super::record::{Answer, Kind, Record};
use super::room::{RATE, Room};
use super::trace;
use std::f64::consts::{PI, TAU};
use vibroimpact::measure::impacts::ImpactsOptions;
use vibroimpact::measure::restitution::{Drop, Measured, Restitution, Train, restitution};

/// The kinds of records drawn here.
pub const KINDS: &[Kind] = &[
    Kind { name: "drops, times", ranges: TIMES, every: 1, draw: |mix| draw(mix, train_of_times, true) },
    Kind {
        name: "drops, contact not stated",
        ranges: "as before, but nothing is said of the contact",
        every: 1,
        draw: |mix| draw(mix, train_of_times, false),
    },
    Kind {
        name: "drops, force at the plate",
        ranges: FORCES,
        every: 2,
        draw: |mix| draw(mix, train_of_forces, true),
    },
    Kind {
        name: "drops, force, contact seen",
        ranges: "as before; contact of 0.1 to 5 ms, of which nothing is said",
        every: 2,
        draw: |mix| draw(mix, train_of_forces, false),
    },
    Kind {
        name: "drops, sound",
        ranges: "as before; each impact rings at 0.8 to 4 kHz, ζ 0.01 to 0.1, found by its envelope",
        every: 2,
        draw: |mix| draw(mix, train_of_sounds, true),
    },
    Kind { name: "drops, room", ranges: ROOMS, every: 5, draw: |mix| sound_in_room(mix, Room::Ordinary) },
    Kind {
        name: "drops, hard room",
        ranges: "as before; echoes to 50 %, a voice in four of ten drops, up to as loud as the first impact",
        every: 5,
        draw: |mix| sound_in_room(mix, Room::Hard),
    },
    Kind {
        name: "drops, dull bodies",
        ranges: "as in a room; R 0.12 to 0.5, and in half of the drops the sound of the release at 3 to 60 % of the first impact",
        every: 5,
        draw: |mix| sound_in_room(mix, Room::Dull),
    },
];

/// Ranges of drops heard in a room, as text for the page.
const ROOMS: &str = "R 0.4 to 0.93, up to 1 % of scatter in half of the series, 1 to 8 drops from 0.1 to 1 m, each up to 3 to 9 impacts; contact 0.05 \
    to 1 ms, stated in half; contact noise of 0.3 to 4 ms, a plate that rings at 0.3 to 5 kHz in half, up to 4 echoes of 1 to 25 % after 1 to 40 ms, \
    reverberation to 3 %, hum to 2 %, noise to 1 %; a voice to 10 % in one drop of ten, a hand before the fall in one of seven";

/// Ranges of drops known by the times of their impacts alone.
const TIMES: &str = "R 0.5 to 0.95, 0.05 to 2 % of scatter from bounce to bounce in half of the records of four drops or more, 1 to 8 drops \
    from 0.05 to 1 m (stated with an error of 0.1 to 2 mm) with 2 to 12 impacts; contact 0.01 to 1 ms, stated; detection 1 to 200 µs off, \
    stated in half";

/// Ranges of drops with a record of the force.
const FORCES: &str = "as before, one to five drops with at least four impacts as half sines of the contact of 0.1 to 1 ms at 10 to 30 kHz; \
    noise 0.0003 to 0.01 of the peak, 1/f noise, hum, 12 bits";

/// The impacts of one drop.
struct Bounces {
    /// Time in s and speed in m/s of each impact.
    onsets: Vec<(f64, f64)>,
    /// Duration of a contact in s.
    contact: f64,
    /// Standard deviation in s of the detected impact times, for drops without a record.
    jitter: f64,
    /// Whether `jitter` is given to the estimator.
    jitter_stated: bool,
}

/// Makes the train of intervals of a drop, from its impact times or from a simulated record.
type TrainOf = fn(&mut Mix, &Bounces) -> Option<Train>;

/// Draws a series of drops of one body from one height, and compares R by all methods with the truth. If
/// `stated`, the estimator is given the duration of a contact.
fn draw(mix: &mut Mix, train_of: TrainOf, stated: bool) -> Record {
    let gravity = 9.80665;
    let (r, height) = (mix.random.between(0.5, 0.95), mix.log(0.05, 1.0));
    mix.note("R", r);
    let height_std = mix.log(1e-4, 2e-3);
    let from_times = std::ptr::fn_addr_eq(train_of, train_of_times as TrainOf);
    let shortest = if from_times { 1e-5 } else { 1e-4 };
    let longest = if from_times || stated { 1e-3 } else { 5e-3 };
    let contact = mix.log(shortest, longest);
    mix.note("contact in ms", 1e3 * contact);
    let drops = mix.random.between(1.0, if from_times { 9.0 } else { 6.0 }) as usize;
    let impacts = mix.random.between(if from_times { 2.0 } else { 4.0 }, 13.0) as usize;
    mix.note("drops", drops as f64);
    mix.note("impacts a drop", impacts as f64);
    // A few drops cannot show the scatter of R.
    let scatter = if drops < 4 { 0.0 } else { mix.some(0.5, "scatter of R", 5e-4, 0.02) };
    let jitter = if from_times { mix.some(1.0, "detection in µs", 1.0, 200.0) * 1e-6 } else { 0.0 };
    let jitter_stated = mix.chance(0.5);
    mix.note("detection stated", f64::from(u8::from(jitter_stated)));
    let mut trains = Vec::new();
    for _ in 0..drops {
        let (mut speed, mut t) = ((2.0 * gravity * height).sqrt(), mix.random.between(0.1, 0.3));
        let mut onsets = Vec::new();
        for _ in 0..impacts {
            onsets.push((t, speed));
            speed *= (r * (1.0 + scatter * mix.random.normal())).min(0.999);
            t += contact + 2.0 * speed / gravity;
        }
        trains.extend(train_of(mix, &Bounces { onsets, contact, jitter, jitter_stated }));
    }
    let stated_height = height + height_std * mix.random.normal();
    let drop = Drop { height: stated_height, height_std: Some(height_std), ..Drop::default() };
    let drop = drop.beginning(&trains);
    let trains = trains.into_iter().filter(|t| t.intervals.len() > 1).collect();
    let measured = Measured {
        drop: Some(drop),
        trains,
        velocities: None,
        contact_time: stated.then_some(contact),
        ..Measured::default()
    };
    answers(r, restitution(&measured).ok().as_ref())
}

/// The answers for R: combined, from the drop height, and from the flights.
fn answers(r: f64, found: Option<&Restitution>) -> Record {
    let by =
        |method: &str| found?.by.iter().find(|way| way.method.contains(method)).map(|way| &way.restitution);
    let mut record = Record::default();
    record.answers.push(Answer::new("R", r, found.map(|f| &f.restitution)));
    record.answers.push(Answer::new("R by drop", r, by("drop")));
    record.answers.push(Answer::new("R by flights", r, by("flight")));
    record
}

/// Draws the sound of a series of drops in a room, and compares R by all methods with the truth.
fn sound_in_room(mix: &mut Mix, room: Room) -> Record {
    let drops = room.drops((mix.random.uniform() * 2f64.powi(50)) as u64);
    mix.note("R", drops.restitution);
    mix.note("drops", drops.records.len() as f64);
    let (height, height_std) = drops.height;
    let drop = Drop { height, height_std: Some(height_std), ..Drop::default() };
    let options = ImpactsOptions { threshold: Some(Train::THRESHOLD), ..ImpactsOptions::default() };
    let records = drops.records.into_iter();
    let train = |values| Train::of(&trace("V", RATE, values), &options, drop.full_flight()).ok();
    let trains: Vec<Train> = records.filter_map(train).map(|(train, _)| train).collect();
    let drop = Some(drop.beginning(&trains)).filter(|_| !trains.is_empty());
    let measured =
        Measured { drop, trains, velocities: None, contact_time: drops.contact, ..Measured::default() };
    answers(drops.restitution, restitution(&measured).ok().as_ref())
}

/// The train of a drop whose impact times have a normally distributed error.
// An `Option`, since trains from records may be absent.
#[allow(clippy::unnecessary_wraps)]
fn train_of_times(mix: &mut Mix, bounces: &Bounces) -> Option<Train> {
    let jitter = bounces.jitter;
    let onsets: Vec<f64> = bounces.onsets.iter().map(|(t, _)| t + jitter * mix.random.normal()).collect();
    let intervals = onsets.windows(2).map(|w| w[1] - w[0]).collect();
    Some(Train { intervals, onset_std: bounces.jitter_stated.then_some(jitter), ..Train::default() })
}

/// The train found in a record of the force, in which each impact is a half sine as long as the contact.
fn train_of_forces(mix: &mut Mix, bounces: &Bounces) -> Option<Train> {
    let contact = bounces.contact;
    let shape = |t: f64| if t < contact { (PI * t / contact).sin() } else { 0.0 };
    train_in_record(mix, bounces, contact, &shape, &ImpactsOptions::default())
}

/// The train found in a record of the sound, in which each impact rings as one decaying mode.
fn train_of_sounds(mix: &mut Mix, bounces: &Bounces) -> Option<Train> {
    let (f, zeta) = (mix.log(800.0, 4000.0), mix.log(0.01, 0.1));
    let shape = move |t: f64| (-zeta * TAU * f * t).exp() * (TAU * f * t).sin();
    let options = ImpactsOptions { envelope: true, ..ImpactsOptions::default() };
    train_in_record(mix, bounces, 5.0 / (zeta * TAU * f), &shape, &options)
}

/// The train found in a simulated record: at each impact a pulse `shape(t)` of `duration` seconds, scaled
/// by the speed, with noise, hum and a converter.
fn train_in_record(
    mix: &mut Mix,
    bounces: &Bounces,
    duration: f64,
    shape: &dyn Fn(f64) -> f64,
    options: &ImpactsOptions,
) -> Option<Train> {
    let rate = mix.log(10e3, 30e3).max(3.0 / bounces.contact);
    mix.note("rate", rate);
    let end = bounces.onsets.last()?.0 + 0.2;
    let mut values = vec![0.0; (end * rate) as usize];
    for (t, speed) in &bounces.onsets {
        let first = (t * rate).ceil() as usize;
        for (i, v) in values.iter_mut().enumerate().skip(first).take((duration * rate) as usize + 1) {
            *v += speed * shape(i as f64 / rate - t);
        }
    }
    let top = peak(&values);
    let (noise, pink, hum) = (mix.log(3e-4, 0.01), mix.log(0.3, 10.0), mix.log(1e-4, 0.02));
    mix.note("white noise", noise);
    mix.add_white(&mut values, noise * top);
    if mix.chance(0.5) {
        mix.add_pink(&mut values, noise * pink * top);
    }
    if mix.chance(0.5) {
        values
            .iter_mut()
            .enumerate()
            .for_each(|(i, v)| *v += hum * top * (TAU * 50.02 * i as f64 / rate).cos());
    }
    convert(&mut values, 1.5 * top, 12);
    let unit = if options.envelope { "V" } else { "N" };
    Train::of(&trace(unit, rate, values), options, None).ok().map(|(train, _)| train)
}
