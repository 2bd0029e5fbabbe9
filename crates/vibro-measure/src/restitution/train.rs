//! Trains of bounces in a record: which of its sounds are the impacts of one falling body.

use super::GRAVITY;
use super::pairs::{FallRecord, LEAST, Rival, SHADOW};
use super::plausible::{Plausible, plausible};
use super::untold::Untold;
use crate::Estimate;
use crate::impacts::{Choose, Detected, ImpactsOptions, Sound, chosen, detect_among, octaves};
use std::cell::{Cell, RefCell};
use vibro_record::units::notation::{counted, quantity, shortest, significant};
use vibro_record::{Error, Finding, Result, Trace};

/// Flight times of one train of bounces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Train {
    /// Times between successive impacts, in s.
    pub intervals: Vec<f64>,
    /// Standard uncertainty of one impact's time, in s, where it is known.
    pub onset_std: Option<f64>,
    /// Contact time of an impact in s, where the record shows it.
    pub contact: Option<Estimate>,
    /// Relative standard uncertainty of the sampling rate, which all intervals share.
    pub clock: f64,
}

impl Train {
    /// The train with intervals that are shorter by a time in s.
    pub(super) fn shorter_by(&self, time: f64) -> Train {
        Train { intervals: self.intervals.iter().map(|interval| interval - time).collect(), ..self.clone() }
    }

    /// Least height of a bounce that counts, over the median height of the sounds.
    pub const THRESHOLD: f64 = 0.02;

    /// Code of the error for a record with sounds of bounces that does not determine which are those of one
    /// body.
    pub const UNTOLD: &str = "bounces-untold";

    /// The bounces of a falling body, with its impacts: the most plausible train among the sounds. `full` is
    /// the flight in s that would follow the fall if R were 1, where the height is known.
    ///
    /// # Errors
    /// As [`crate::impacts::impacts`]; also if no train of two impacts is more plausible than all others.
    pub fn of(trace: &Trace, options: &ImpactsOptions, full: Option<f64>) -> Result<(Train, Detected)> {
        let untold = RefCell::new(None);
        Train::among(trace, options, full, &untold).map_err(|refused| match untold.take() {
            Some(sounds) => Untold::advise(&sounds, refused, (trace, options, full)),
            None => refused,
        })
    }

    /// As [`Train::of`], without advice; sounds that do not determine the bounces are left in `untold`.
    pub(super) fn among(
        trace: &Trace,
        options: &ImpactsOptions,
        full: Option<f64>,
        untold: &RefCell<Option<Untold>>,
    ) -> Result<(Train, Detected)> {
        let (start, rate) = (trace.axis.start(), trace.sampling_rate()?);
        let ends = (start, start + trace.values.len() as f64 / rate);
        // Stays at `usize::MAX` if the record is refused before impacts are selected, for example because it
        // rings.
        let heard = Cell::new(usize::MAX);
        let choose = |sounds: &[Sound], reach: f64, median: f64| {
            heard.set(sounds.len());
            choose(sounds, FallRecord { reach, median, ends, full, pause: options.refractory }, untold)
        };
        let mut found = detect_among(trace, options, Some(&choose));
        // Hum or slow levels at low frequency may hide the impacts.
        if found.is_err() && heard.get() < 2 && options.band.is_none() {
            found = found.or_else(|error| above_hum(trace, options, &choose).ok_or(error));
        }
        let found = found?;
        if found.times.len() < 2 {
            let few = Error::refused("one impact found: restitution from a drop needs two");
            let few = few.hint("a lower threshold, or a shorter pause between impacts");
            return Err(few.setting("threshold").setting("refractory"));
        }
        let intervals = found.times.windows(2).map(|w| w[1] - w[0]).collect();
        let (onset_std, contact, clock) = (found.onset_std, found.contact.clone(), trace.meta.clock);
        Ok((Train { intervals, onset_std, contact, clock }, found))
    }
}

/// Most sounds above a corner among which a train is searched: with more, the band holds steady noise.
const FEW: usize = 32;

/// The train of three impacts or more above a high-pass corner. The corner that shows most impacts is used;
/// among equal ones the highest, which times them best.
fn above_hum(trace: &Trace, options: &ImpactsOptions, choose: Choose<'_>) -> Option<Detected> {
    let octaves: Vec<(f64, f64)> = octaves(trace.sampling_rate().ok()?).collect();
    let high = octaves.first()?.1;
    let above = |(low, _): (f64, f64)| {
        let band = (low, high);
        let own = ImpactsOptions { band: Some(band), ..options.clone() };
        // Steady noise in a band passes for any number of sounds.
        let few = |sounds: &[Sound], reach: f64, median: f64| {
            if sounds.len() > FEW {
                Err(Error::refused("too many sounds"))
            } else {
                choose(sounds, reach, median)
            }
        };
        let mut found = detect_among(trace, &own, Some(&few)).ok().filter(|found| found.times.len() > 2)?;
        found.findings.push(chosen(band));
        Some(found)
    };
    octaves.into_iter().rev().filter_map(above).max_by_key(|found| found.times.len())
}

/// As [`selected`]. Where a hundredth or a thousandth of the stated height fits the flights, that is the
/// first thing said: a height typed in cm or mm makes any other reason wrong.
fn choose(
    sounds: &[Sound],
    heard: FallRecord,
    untold: &RefCell<Option<Untold>>,
) -> Result<(Vec<usize>, Vec<Finding>)> {
    let found = selected(sounds, heard, untold);
    match heard.full.and_then(|full| height_meant(sounds, heard, full, found.as_ref().ok())) {
        Some(error) => {
            untold.take();
            Err(error)
        }
        None => found,
    }
}

/// Error for a height that was typed in cm or mm: a hundredth or a thousandth of it is that of the fall that
/// the flights fit by themselves. The flights are those `found`, else those with this smaller height.
fn height_meant(
    sounds: &[Sound],
    heard: FallRecord,
    full: f64,
    found: Option<&(Vec<usize>, Vec<Finding>)>,
) -> Option<Error> {
    let stated = GRAVITY * full * full / 8.0;
    [(100.0, "cm"), (1000.0, "mm")].into_iter().find_map(|(factor, unit)| {
        let smaller = FallRecord { full: Some(full / f64::sqrt(factor)), ..heard };
        let with_smaller = || Some(selected(sounds, smaller, &RefCell::new(None)).ok()?.0);
        let impacts = found.map(|found| found.0.clone()).or_else(with_smaller)?;
        let [first, second, third, ..] = impacts[..] else { return None };
        let flights = [sounds[second].time - sounds[first].time, sounds[third].time - sounds[second].time];
        let (meant, fitted) = (stated / factor, fall_before(flights));
        ((fitted / meant).ln().abs() < AGREES).then(|| {
            let [meant, typed] = [meant, stated].map(shortest);
            let fitted = quantity(fitted, "m", 2);
            let why = format!(
                "a height of {typed} m: did you mean {meant} m ({typed} {unit})? The flights fit a fall of {fitted}"
            );
            Error::refused(why).hint("the height in m").set("height", meant)
        })
    })
}

/// Largest logarithm of the ratio of two heights that agree: R of one bounce scatters by 2 %, and the height
/// by four times that, twice the standard deviation on either side.
const AGREES: f64 = 0.25;

/// Height in m from which a body falls on Earth before two flights in s with one R: a fall of h precedes one
/// of 2√(2h/g) with R = 1.
fn fall_before([first, second]: [f64; 2]) -> f64 {
    GRAVITY * (first.powi(2) / second).powi(2) / 8.0
}

/// Selects the impacts among the sounds. Returns their indices, and findings on the other sounds.
fn selected(
    sounds: &[Sound],
    heard: FallRecord,
    untold: &RefCell<Option<Untold>>,
) -> Result<(Vec<usize>, Vec<Finding>)> {
    let n = sounds.len();
    let refused = |why: String, train: &Plausible| {
        untold.replace(Some(Untold { sounds: sounds.to_vec(), heard, train: train.clone() }));
        Err(Error::refused(why).coded(Train::UNTOLD))
    };
    let Some(train) = plausible(sounds, heard) else {
        let impacts = counted(n, "impact");
        let why = format!("{impacts} found, a drop has two or more: each rises at once and decays");
        let hint = "`vibro decay` measures a ringing, `vibro pulse` the force of one contact";
        return Err(Error::refused(why).hint(hint));
    };
    if train.even {
        let n = train.impacts.len();
        let why = format!("{n} sounds follow each other evenly: the flights of bounces shrink");
        // A stated height means that there was a fall, with a voice over it.
        if heard.full.is_some() {
            return refused(why, &train);
        }
        let hint = "`vibro impacts` for a machine; for a drop among voices the part with the bounces, or the height of its fall";
        return Err(Error::refused(why).hint(hint).setting("span").setting("height"));
    }
    if let Some(why) = rivalled(&train, sounds) {
        return refused(why, &train);
    }
    let before = train.impacts[0];
    let other = n - train.impacts.len() - before - train.echoes;
    let foreign = before - train.release + other;
    let flight = sounds[train.impacts[1]].time - sounds[before].time;
    if let Some(why) = unconfirmed(&train, foreign, sounds, heard.full.is_some()) {
        return refused(why, &train);
    }
    if let Some(full) = heard.full
        && flight < LEAST * full
    {
        let (r, shown) = (flight / full, quantity(flight, "s", 3));
        let by_height = format!("the stated height makes the first flight, {shown}, R = {r:.4}");
        // Two flights have an R of their own, and with it a height.
        if let Some(second) = second_flight(&train, sounds).filter(|second| *second < flight) {
            let fall = quantity(fall_before([flight, second]), "m", 3);
            let why = format!("{by_height}; the flights themselves fit a fall of {fall} on Earth");
            return Err(Error::refused(why).hint("check the height and its unit").setting("height"));
        }
        return refused(format!("{by_height}: the height may be wrong, or the second sound an echo"), &train);
    }
    let findings = on_others(&train, other, sounds);
    Ok((train.impacts, findings))
}

/// The second flight of a train in s; `None` for one flight.
fn second_flight(train: &Plausible, sounds: &[Sound]) -> Option<f64> {
    let [_, second, third, ..] = train.impacts[..] else { return None };
    Some(sounds[third].time - sounds[second].time)
}

/// Another explanation of the sounds that is as likely as the train.
fn rivalled(train: &Plausible, sounds: &[Sound]) -> Option<String> {
    let time = |i: usize| sounds[i].time;
    Some(match train.rival? {
        Rival::Fall(i, j) => {
            let [fall, begin, end] = [time(j) - time(i), time(i), time(j)].map(|time| quantity(time, "s", 3));
            format!(
                "the sounds at {begin} and {end} may be the release and the first impact: {fall} is the time of the fall from that height"
            )
        }
        Rival::Train(i, j) => {
            let (n, a, b) = (sounds.len(), train.impacts[0], train.impacts[1]);
            let [first, other] = apart([time(b) - time(a), time(j) - time(i)]);
            let [begin, later] = apart([time(a), time(i)]);
            format!(
                "{n} sounds fit two series of bounces equally well: from {begin} on with a first flight of {first}, or from {later} on with one of {other}"
            )
        }
    })
}

/// Findings on the sounds that do not belong to a train; `other` of them are neither before it nor its
/// echoes.
fn on_others(train: &Plausible, other: usize, sounds: &[Sound]) -> Vec<Finding> {
    let before = train.impacts[0];
    let of = |code, n: usize| (n > 0).then(|| Finding::note(code).count("n", n));
    let louder = sounds[..before].iter().filter(|sound| sound.height > sounds[before].height).count();
    let of_handling = (louder > 0).then(|| Finding::caution("louder-before").count("n", before));
    let of_handling =
        of_handling.map(|found| found.count("louder", louder)).or(of("handling-ignored", before));
    let one = (train.impacts.len() == 2 && train.release == 0).then(|| Finding::caution("one-flight"));
    let echoes = of("echoes-ignored", train.echoes).map(|found| found.number("delay", SHADOW));
    let findings = [of_handling, echoes, of("sounds-ignored", other), one];
    findings.into_iter().flatten().collect()
}

/// Why a train of one or two flights is not certain, with `foreign` other sounds in the record, and with or
/// without the `height` of the fall. Four impacts confirm each other.
fn unconfirmed(train: &Plausible, foreign: usize, sounds: &[Sound], height: bool) -> Option<String> {
    let flight = |pair: &[usize]| sounds[pair[1]].time - sounds[pair[0]].time;
    let shown = |time| quantity(time, "s", 3);
    if let [_, second, third] = train.impacts[..] {
        let flight = flight(&[second, third]);
        return (!height && flight < SHADOW).then(|| {
            let flight = shown(flight);
            format!("two flights, the second of {flight}: without the height of the fall the third sound may be the echo of the second")
        });
    }
    if train.impacts.len() > 3 {
        return None;
    }
    let flight = flight(&train.impacts);
    if foreign > 0 {
        let others = counted(foreign, "other sound");
        return Some(format!(
            "one flight beside {others}: no second flight shows that it is that of a bounce"
        ));
    }
    if flight < SHADOW {
        let flight = shown(flight);
        return Some(format!("one flight, of {flight}: the second sound may be the echo of the first"));
    }
    let expected = shown(train.expected?);
    Some(format!("two impacts, and the third, expected at {expected}, is not heard"))
}

/// Time in s from which on two times are compared in seconds.
const LONG: f64 = 0.1;

/// Two times in one unit, with as many digits as show that they differ, three at least.
pub(super) fn apart(times: [f64; 2]) -> [String; 2] {
    let long = times[0].max(times[1]) >= LONG;
    let one =
        |time, digits| if long { significant(time, digits) + " s" } else { quantity(time, "s", digits) };
    let shown = |digits| times.map(|time| one(time, digits));
    (3..9).map(shown).find(|[a, b]| a != b).unwrap_or_else(|| shown(3))
}
