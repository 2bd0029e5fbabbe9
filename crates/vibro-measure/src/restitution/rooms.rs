//! Simulated series of drops in rooms: the restitution R found against the true one.

use super::room::{Drops, RATE, Room};
use super::*;
use crate::impacts::ImpactsOptions;
use rayon::prelude::*;
use vibro_record::units::Unit;
use vibro_record::{Axis, Meta, Trace};

/// R of a series; `None` where it is refused or doubted.
fn answer(drops: &Drops) -> Option<Restitution> {
    let (height, height_std) = drops.height;
    let drop = Drop { height, height_std: Some(height_std), ..Drop::default() };
    let train = |values: &Vec<f64>| {
        let axis = Axis::time(0.0, 1.0 / RATE, values.len());
        let trace = Trace { meta: Meta::new("sound", Unit::none()), axis, values: values.clone() };
        let how = ImpactsOptions { threshold: Some(Train::THRESHOLD), ..ImpactsOptions::default() };
        Some(Train::of(&trace, &how, drop.full_flight()).ok()?.0)
    };
    let trains: Vec<Train> = drops.records.iter().filter_map(train).collect();
    let drop = Some(drop.beginning(&trains)).filter(|_| !trains.is_empty());
    let measured =
        Measured { drop, trains, velocities: None, contact_time: drops.contact, ..Measured::default() };
    let sure = |found: &Restitution| found.findings.iter().all(|f| !f.is_doubt());
    restitution(&measured).ok().filter(sure)
}

#[test]
#[ignore = "Monte Carlo: cargo test --release -- --ignored"]
fn drops_in_rooms_are_covered_or_refused() {
    let cases = 12;
    // Bodies that hardly bounce, in the dull room, show few impacts: four of five series are answered.
    for (room, part) in [(Room::Ordinary, 0.97), (Room::Hard, 0.97), (Room::Dull, 0.8)] {
        let score = |seed: u64| {
            let drops = room.drops(seed);
            let found = answer(&drops)?.restitution;
            Some((found.value - drops.restitution) / found.std?)
        };
        let scores: Vec<f64> = (0..cases).into_par_iter().filter_map(score).collect();
        let n = scores.len();
        let inside = scores.iter().filter(|z| z.abs() < 1.96).count();
        let largest = scores.iter().fold(0.0, |most: f64, z| z.abs().max(most));
        println!("drops, {room:?} room: {n} of {cases} answered, {inside} within 1.96, largest {largest:.1}");
        // At least this fraction of the series is answered, less 2.5 standard deviations of a binomial
        // count. Of these 95 % are covered, less 2.5 standard deviations of 0.75.
        let count = cases as f64;
        let least = part * count - 2.5 * (count * part * (1.0 - part)).sqrt();
        assert!(n as f64 >= least, "{room:?}: {n}");
        assert!(
            inside as f64 >= 0.95 * n as f64 - 1.9 && largest < 4.0,
            "{room:?}: {inside} of {n}, {scores:?}"
        );
    }
}
