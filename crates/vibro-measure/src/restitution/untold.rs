//! Advice where the sounds do not determine which are the bounces of one body. Each advice is tried before
//! it is given.

use super::pairs::{FallRecord, Rival, SHADOW};
use super::plausible::{Plausible, alone, plausible};
use super::{GROSS, Train};
use crate::impacts::{ImpactsOptions, Sound};
use std::cell::RefCell;
use vibro_record::{Error, Trace};

/// The part of the record that is advised leaves out fewer sounds than this before a fall.
const CLAPS: usize = 4;

/// Relative difference of first flights below which two trains are the same, one with the echo of the first
/// impact in place of that impact.
const SAME: f64 = 0.05;

/// A threshold that leaves this many sounds or more is not advised: a sound as quiet as many others is no
/// clear bounce.
const FEW: usize = 32;

/// Arguments of a reading: the trace, the options, and the flight in s that would follow the fall if R were
/// 1.
type Read<'a> = (&'a Trace, &'a ImpactsOptions, Option<f64>);

/// Sounds of a fall that do not determine the bounces.
pub(super) struct Untold {
    pub sounds: Vec<Sound>,
    pub heard: FallRecord,
    /// The most plausible train of all.
    pub train: Plausible,
}

impl Untold {
    /// Adds to an error the first advice that finds the bounces when tried.
    pub fn advise(&self, refused: Error, read: Read<'_>) -> Error {
        const QUIETER: &str = "a higher threshold, which leaves out quieter sounds";
        const SOONER: &str = "a pause that joins an echo to its impact";
        let pause = self.pause(read).map(|pause| format!("{pause:.2}"));
        let threshold = self.threshold(read).map(|threshold| format!("{threshold:.2}"));
        match (threshold, pause) {
            (Some(threshold), Some(pause)) => {
                let either = refused.hint(format!("{QUIETER}; or {SOONER}"));
                return either.set("threshold", threshold).set("refractory", pause);
            }
            (Some(threshold), None) => return refused.hint(QUIETER).set("threshold", threshold),
            (None, Some(pause)) => return refused.hint(SOONER).set("refractory", pause),
            (None, None) => (),
        }
        if let Some((from, to)) = self.before_third(read) {
            return refused
                .hint("the part that ends before it, if the body was caught")
                .set("span", format!("[{from:.2}, {to:.2}]"));
        }
        if let Some((from, to)) = self.part(read) {
            return refused
                .hint("the part behind what is heard first, if that is a hand or a clap")
                .set("span", format!("[{from:.2}, {to:.2}]"));
        }
        let cut = "cut the record to the bounces, or record again in quiet";
        match self.heard.full {
            None => refused
                .hint("state the height of the fall, which tells them apart; or ".to_owned() + cut)
                .setting("height")
                .setting("span"),
            Some(_) => refused
                .hint(format!("check the height of the fall and its unit; or {cut}"))
                .setting("height")
                .setting("span"),
        }
    }

    /// Whether this reading finds the bounces: three impacts, or two where the height is known, which
    /// confirms that their flight is that of a bounce.
    fn is_told(&self, read: Read<'_>) -> bool {
        told(read).is_some_and(|train| train.intervals.len() + 1 >= self.enough())
    }

    fn enough(&self) -> usize {
        if self.heard.full.is_some() { 2 } else { 3 }
    }

    /// As [`Untold::is_told`], but from a part of the sounds without a new reading, which is faster.
    fn may_tell(&self, sounds: &[Sound]) -> Option<Plausible> {
        let told =
            |train: &Plausible| !train.even && train.rival.is_none() && train.impacts.len() >= self.enough();
        plausible(sounds, self.heard).filter(told)
    }

    /// The lowest threshold, in hundredths of the median height, that leaves one train of three impacts or
    /// more. All must be impacts of the most plausible train of all sounds: a train that appears only
    /// without the quieter sounds may be one of echoes.
    fn threshold(&self, (trace, options, full): Read<'_>) -> Option<f64> {
        self.train.rival?;
        let known = |sound: &Sound| self.train.impacts.iter().any(|k| self.sounds[*k] == *sound);
        let cures = |high: &[Sound]| {
            self.may_tell(high)
                .is_some_and(|left| left.impacts.len() > 2 && left.impacts.iter().all(|i| known(&high[*i])))
        };
        let mut lowest = None;
        for threshold in (1..100).rev().map(|hundredths| 0.01 * f64::from(hundredths)) {
            let least = threshold * self.heard.median;
            let high: Vec<Sound> = self.sounds.iter().copied().filter(|s| s.height > least).collect();
            if high.len() >= self.sounds.len().min(FEW) {
                break;
            }
            match (cures(&high), lowest) {
                (true, _) => lowest = Some(threshold),
                (false, Some(_)) => break,
                (false, None) => {}
            }
        }
        let with = |threshold| ImpactsOptions { threshold: Some(threshold), ..options.clone() };
        lowest.filter(|threshold| self.is_told((trace, &with(*threshold), full)))
    }

    /// A pause in s after each impact that finds the bounces: 1.5 times the delay of the sound that follows.
    fn pause(&self, (trace, options, full): Read<'_>) -> Option<f64> {
        let Some(Rival::Train(i, j)) = self.train.rival else { return None };
        let (a, b) = (self.train.impacts[0], self.train.impacts[1]);
        let time = |i: usize| self.sounds[i].time;
        let (flight, other) = (time(b) - time(a), time(j) - time(i));
        let delay =
            if (flight / other - 1.0).abs() < SAME { (time(i) - time(a)).abs() } else { flight.min(other) };
        let pause = (150.0 * delay).ceil() / 100.0;
        let with = ImpactsOptions { refractory: Some(pause), ..options.clone() };
        self.is_told((trace, &with, full)).then_some(pause)
    }

    /// The part of the record in s that ends before a third impact which is expected but not heard.
    fn before_third(&self, (trace, options, full): Read<'_>) -> Option<(f64, f64)> {
        let (Some(expected), None, &[_, second]) =
            (self.train.expected, self.train.rival, &self.train.impacts[..])
        else {
            return None;
        };
        // A body that is caught makes one more sound. Several more sounds may be the bounces, and the two
        // impacts not.
        if alone(&self.sounds[second..]) > 2 {
            return None;
        }
        let end = f64::midpoint(self.sounds[second].time, expected);
        let (from, to) = (hundredths(self.heard.ends.0), hundredths(end));
        let part = part(trace, from, to)?;
        self.is_told((&part, options, full)).then_some((from, to))
    }

    /// The part of the record in s after the first sounds that finds the bounces: three impacts, whose R by
    /// flights agrees with that by the height. Otherwise the first impact may have been cut off.
    fn part(&self, (trace, options, full): Read<'_>) -> Option<(f64, f64)> {
        // A sound within [`SHADOW`] after another is its echo, and is cut off with it.
        let behind = |first: &usize| {
            let gap = self.sounds[*first].time - self.sounds[*first - 1].time;
            gap > SHADOW && self.may_tell(&self.sounds[*first..]).is_some()
        };
        let first = (1..self.sounds.len().min(CLAPS)).find(behind)?;
        let between = f64::midpoint(self.sounds[first - 1].time, self.sounds[first].time);
        let (from, to) = (hundredths(between), hundredths(self.heard.ends.1));
        let train = told((&part(trace, from, to)?, options, full))?;
        let [fall, bounce, ..] = train.intervals[..] else { return None };
        let agree = full.is_none_or(|full| (bounce / fall / (fall / full) - 1.0).abs() < GROSS);
        agree.then_some((from, to))
    }
}

/// The train that this reading of a record finds, where it does.
fn told((trace, options, full): Read<'_>) -> Option<Train> {
    Train::among(trace, options, full, &RefCell::new(None)).ok().map(|(train, _)| train)
}

/// A time rounded to hundredths of a second, as it is typed.
fn hundredths(time: f64) -> f64 {
    (100.0 * time).round() / 100.0
}

/// The samples from one time to another, in s.
fn part(trace: &Trace, from: f64, to: f64) -> Option<Trace> {
    let cut = trace.axis.between(from, to);
    let values = trace.values.get(cut.clone())?.to_vec();
    Some(Trace { meta: trace.meta.clone(), axis: trace.axis.part(cut), values })
}
