//! Coefficient of restitution: speed of separation over speed of approach.
//!
//! Each method that the data allow gives its own answer. If answers differ by more than their uncertainties,
//! the result is null and a finding reports it; nothing is averaged.

mod drop;
mod expected;
mod fit;
mod flights;
mod pairs;
mod plausible;
mod train;
mod untold;
mod velocities;

pub use drop::{Drop, GRAVITY};
pub use expected::{GuessedDrops, expected, rehearse};
pub use train::Train;
pub use velocities::Velocities;

use super::Estimate;
use crate::mean::{average, scatter, together};
use crate::residuals::widened;
use pairs::SCATTER;
use serde::Serialize;
use vibro_record::units::notation::quantity;
use vibro_record::{Doubt, Error, Finding, Result, Uncertain, uncertain};

/// One method's answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct MethodAnswer {
    /// Name of the method.
    pub method: &'static str,
    /// Its answer.
    pub restitution: Estimate,
}

uncertain!(MethodAnswer: restitution);

/// The coefficient of restitution by every method that the data allow.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Restitution {
    /// The answer with the smallest uncertainty; null where methods disagree.
    pub restitution: Estimate,
    /// All answers.
    pub by: Vec<MethodAnswer>,
    /// Whether the answers agree within their uncertainties; null for one answer alone, and where an answer
    /// without uncertainty leaves that open.
    pub agree: Option<bool>,
    /// Standard deviation of the restitution by drops over 2000 resamples of the drops with replacement
    /// (Efron 1979), from a fixed seed: the scatter of the drops alone. Null for fewer than five drops.
    pub bootstrap_std: Option<f64>,
    /// Intervals between onsets of impacts in s, one list a drop or train.
    pub intervals: Vec<Vec<f64>>,
    /// Assumptions and doubts.
    pub findings: Vec<Finding>,
}

uncertain!(Restitution: restitution, by, bootstrap_std);

/// Measurements of the impacts. All are optional; those given decide which methods answer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measured {
    /// Drops from a height, with the interval between first and second impact.
    pub drop: Option<Drop>,
    /// Trains of bounces.
    pub trains: Vec<Train>,
    /// Velocities before and after.
    pub velocities: Option<Velocities>,
    /// Contact time of an impact in s, by which intervals between onsets are longer than the flights. Where
    /// `None`, it is read from the records where all trains show it. Otherwise nothing is subtracted, and
    /// the uncertainties allow for up to 1 ms, longer than steel and most plastics touch.
    pub contact_time: Option<f64>,
    /// Standard uncertainty of a stated contact time in s; `None`: it is exact.
    pub contact_time_std: Option<f64>,
}

/// Restitution by every method that `measured` allows.
///
/// ```
/// use vibro_measure::restitution::{Drop, Measured, restitution};
/// let drop = Drop { height: 0.57, intervals: vec![0.144], ..Drop::default() };
/// let found = restitution(&Measured { drop: Some(drop), ..Measured::default() })?;
/// assert!((found.restitution.value - 0.2112).abs() < 5e-5);
/// # Ok::<(), vibro_record::Error>(())
/// ```
///
/// # Errors
/// If no measurement allows an answer, or one is impossible: a height of 0, an interval longer than the fall
/// allows, masses that do not approach.
pub fn restitution(measured: &Measured) -> Result<Restitution> {
    not_negative("a contact time", measured.contact_time)?;
    not_negative("an uncertainty of the contact time", measured.contact_time_std)?;
    if measured.contact_time_std.is_some() && measured.contact_time.is_none() {
        return Err(Error::usage("contact_time_std without contact_time", "the contact time, too")
            .setting("contact_time"));
    }
    let (mut by, mut findings) = (Vec::new(), Vec::new());
    let mut intervals: Vec<Vec<f64>> = measured.trains.iter().map(|t| t.intervals.clone()).collect();
    let (contact, contact_std) = contact(measured);
    let dropped = measured.drop.iter().flat_map(|drop| &drop.intervals);
    let shortest = intervals.iter().flatten().chain(dropped).copied().filter(|t| *t > 0.0);
    let shortest = shortest.fold(f64::INFINITY, f64::min);
    if measured.contact_time.is_some() && contact >= shortest {
        let [contact, flight] = [contact, shortest].map(|time| quantity(time, "s", 3));
        let why = format!("a contact time of {contact} is no shorter than the flight of {flight}");
        return Err(Error::refused(why).hint("check the contact time: it is in s").setting("contact_time"));
    }
    let flights =
        |intervals: &[f64]| intervals.iter().map(|interval| interval - contact).collect::<Vec<f64>>();
    let mut bootstrap_std = measured.drop.as_ref().and_then(Drop::bootstrap);
    // Relative change of R by 1 ms of contact time, one value a method.
    let mut bias = Vec::new();
    let trains: Vec<Train> = measured.trains.iter().map(|t| t.shorter_by(contact)).collect();
    let drop =
        measured.drop.as_ref().map(|drop| Drop { intervals: flights(&drop.intervals), ..drop.clone() });
    let mut of_trains = Vec::new();
    let begins = drop.as_ref().is_some_and(|d| d.begins(&trains));
    let by_flights = flights::answer(&trains, begins, &mut of_trains);
    if let Some(drop) = &drop {
        let noise = by_flights.as_ref().ok().and_then(|(_, noise)| *noise);
        by.push(drop.answer(noise, &mut findings)?);
        bias.push(1e-3 / average(&drop.intervals));
        if intervals.is_empty() {
            intervals = drop.intervals.iter().map(|d| vec![*d]).collect();
        }
    }
    findings.extend(of_trains);
    match by_flights {
        Ok((way, _)) => {
            // What the fit itself makes of a contact that is a little longer.
            let longer: Vec<Train> = trains.iter().map(|t| t.shorter_by(STEP)).collect();
            let moved = flights::answer(&longer, begins, &mut Vec::new()).ok().and_then(|(way, _)| way);
            let part = |way: &MethodAnswer, moved: &MethodAnswer| {
                1e-3 / STEP * (1.0 - moved.restitution.value / way.restitution.value)
            };
            // Without an answer by flight times no bias is added, so that `bias` and `by` have the same
            // length.
            bias.extend(way.iter().map(|way| moved.as_ref().map_or(0.0, |moved| part(way, moved))));
            by.extend(way);
        }
        // The impacts after a drop may be no train of bounces; the drop still answers.
        Err(error) if measured.drop.is_some() && error.exit_code() == 1 => {
            let doubt = grown(&trains).or(drop.as_ref().and_then(|drop| drop.unlike(&trains)));
            let doubt = doubt.map(|doubt| doubt.of(&mut [&mut by as &mut dyn Uncertain, &mut bootstrap_std]));
            findings.push(doubt.unwrap_or_else(|| Finding::caution("flight-times-ignored")));
        }
        Err(error) => return Err(error),
    }
    if contact_std > 0.0 {
        let moved = moved_by_contact(&by, &bias, contact_std);
        if measured.contact_time.is_none() {
            findings.extend(contact_not_stated(&by, &bias, (contact, contact_std), &moved));
        }
        for (way, moved) in by.iter_mut().zip(moved) {
            way.restitution.std = way.restitution.std.map(|std| std.hypot(moved));
        }
    }
    if let Some(velocities) = &measured.velocities {
        by.extend(velocities.answers()?);
    }
    let uncertainty = |way: &MethodAnswer| way.restitution.std.unwrap_or(f64::INFINITY);
    let Some(surest) = by.iter().min_by(|a, b| uncertainty(a).total_cmp(&uncertainty(b))) else {
        return Err(without_answer(measured));
    };
    let (agree, mut doubts) = agreement(&by);
    let restitution = if agree == Some(false) {
        doubts.extend(first_unheard(&by));
        Estimate::new(f64::NAN, None, "1", by.len(), "methods disagree: see `by`")
    } else {
        surest.restitution.clone()
    };
    let mut found = Restitution { restitution, by, agree, bootstrap_std, intervals, findings };
    // Which of the methods is wrong is not known.
    let doubts: Vec<Finding> = doubts.into_iter().map(|doubt| doubt.of(&mut found)).collect();
    found.findings.extend(doubts);
    Ok(found)
}

/// What one standard uncertainty of the contact time in s moves each method by. `bias` is the relative change
/// of R by 1 ms of contact.
fn moved_by_contact(by: &[MethodAnswer], bias: &[f64], contact_std: f64) -> Vec<f64> {
    by.iter().zip(bias).map(|(way, part)| 1e3 * contact_std * part * way.restitution.value).collect()
}

/// What is to be said of a contact time that is not stated: where the records show it, or where it matters.
fn contact_not_stated(
    by: &[MethodAnswer],
    bias: &[f64],
    (contact, contact_std): (f64, f64),
    moved: &[f64],
) -> Option<Finding> {
    if contact > 0.0 {
        let seen = Finding::note("contact-time-seen").number("duration", contact);
        return Some(seen.number("std", contact_std));
    }
    let matters = |(way, moved): (&MethodAnswer, &f64)| {
        way.restitution.std.is_some_and(|std| LONG_CONTACT * moved.abs() > std)
    };
    let methods: Vec<&str> = by.iter().map(|way| way.method).collect();
    let found = Finding::caution("contact-time-unsaid").numbers("parts", bias.to_vec());
    by.iter().zip(moved).any(matters).then(|| found.name("methods", methods.join(", ")))
}

/// Error for measurements from which no restitution follows.
fn without_answer(measured: &Measured) -> Error {
    let none = if measured.trains.is_empty() {
        Error::usage("nothing from which restitution follows", "what was measured of an impact")
    } else {
        Error::refused("one flight time has no ratio, from which restitution follows")
    };
    let settings = ["intervals", "height", "interval", "before"];
    let hint = "state two flight times or more, a height and an interval, or velocities before and after";
    settings.into_iter().fold(none.hint(hint), Error::setting)
}

/// Step of a contact time in s, far below every flight and far above its rounding.
const STEP: f64 = 1e-7;

/// Longest contact in s that the uncertainties allow for if no contact time is stated or measured: longer
/// than steel and most plastics touch.
pub const LONGEST: f64 = 1e-3;

/// Doubt about a drop where too many flights of a train are longer than its first.
fn grown(trains: &[Train]) -> Option<Doubt> {
    let first = |(i, train): (usize, &Train)| Some((i + 1, flights::longer(train)?));
    let (train, n) = trains.iter().enumerate().find_map(first)?;
    Some(Finding::doubt("drop-flights-grow").count("n", n).count("train", train))
}

/// A soft ball may touch this many times longer than assumed. If that would change R by more than its
/// uncertainty, a finding asks for the contact time.
const LONG_CONTACT: f64 = 5.0;

/// Contact time of an impact and its standard uncertainty in s: both as stated, else the mean over the
/// records where all show it. Else 0, with the uncertainty of a time anywhere from 0 to [`LONGEST`] with
/// equal chance.
fn contact(measured: &Measured) -> (f64, f64) {
    let seen: Option<Vec<&Estimate>> = measured.trains.iter().map(|train| train.contact.as_ref()).collect();
    let mean = |seen: &[&Estimate], of: &dyn Fn(&Estimate) -> f64| {
        average(&seen.iter().map(|contact| of(contact)).collect::<Vec<f64>>())
    };
    match (measured.contact_time, seen.filter(|seen| !seen.is_empty())) {
        (Some(stated), _) => (stated, measured.contact_time_std.unwrap_or(0.0)),
        (None, Some(seen)) => (mean(&seen, &|c| c.value), mean(&seen, &|c| c.std.unwrap_or(c.value))),
        (None, None) => (0.0, LONGEST / 3f64.sqrt()),
    }
}

/// Two answers, one without uncertainty, disagree where they differ by more than this fraction plus 1.96
/// uncertainties of the other: R scatters by 2 % from bounce to bounce, and the ratio of two by √2 of that.
const GROSS: f64 = 1.96 * std::f64::consts::SQRT_2 * SCATTER;

/// Whether every pair of answers agrees at 95 %, and a doubt for each that does not; `None` for one answer
/// alone, and where one has no uncertainty and the others agree.
/// Methods may share data, as a drop and its train do, with unknown correlation: the uncertainties of two
/// answers are added, which covers the worst case.
fn agreement(by: &[MethodAnswer]) -> (Option<bool>, Vec<Doubt>) {
    let (mut agree, mut doubts) = ((by.len() > 1).then_some(true), Vec::new());
    for (i, a) in by.iter().enumerate() {
        for b in &by[i + 1..] {
            let (first, second) = (a.restitution.value, b.restitution.value);
            let apart = (first - second).abs();
            let std = a.restitution.std.zip(b.restitution.std).map(|(u, v)| u + v);
            let known = a.restitution.std.or(b.restitution.std).unwrap_or(0.0);
            let found = match std {
                Some(std) if apart > 1.96 * std => {
                    Finding::doubt("methods-disagree").number("ratio", apart / std)
                }
                None if apart > GROSS * first.max(second) + 1.96 * known => {
                    Finding::doubt("methods-far-apart")
                }
                Some(_) => continue,
                None => {
                    agree = agree.filter(|agree| !agree);
                    continue;
                }
            };
            agree = Some(false);
            let found = found.name("first", a.method).number("first_value", first);
            doubts.push(found.name("second", b.method).number("second_value", second));
        }
    }
    (agree, doubts)
}

/// Doubt that a record begins with the second impact: its first interval is then the second one of the drop,
/// and the drop gives the square of the R by flight times.
fn first_unheard(by: &[MethodAnswer]) -> Option<Doubt> {
    let of = |method: &str| by.iter().find(|way| way.method == method).map(|way| way.restitution.value);
    let (drop, flights) = (of("drop")?, of("flight times")?);
    let is_square = (drop / flights.powi(2) - 1.0).abs() < GROSS;
    let found = Finding::doubt("first-impact-unheard").number("drop", drop);
    is_square.then(|| found.number("flights", flights))
}

/// Mean of repeated values and its standard uncertainty: the larger of their scatter (Student, from three
/// values on) and the `stated` uncertainty of one value, over √n. Two values have one only where the stated
/// one explains their scatter (95 %).
fn repeated(values: &[f64], stated: Option<f64>) -> (f64, Option<f64>) {
    let (n, mean, scatter) = (values.len() as f64, average(values), scatter(values));
    let one = if values.len() > 2 {
        Some((widened(values.len() - 1) * scatter).max(stated.unwrap_or(0.0)))
    } else {
        stated.filter(|u| n < 2.0 || scatter <= 1.96 * u)
    };
    (mean, one.map(|u| u / n.sqrt()))
}

/// Checks a number that must be finite and above 0.
fn above_zero(name: &str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::refused(format!("{name} is {value:.4}: it must be above 0")))
}

/// Checks an optional number that must be finite and not below 0.
fn not_negative(name: &str, value: Option<f64>) -> Result<()> {
    match value {
        Some(v) if !(v.is_finite() && v >= 0.0) => Err(Error::usage(format!("{name} of {v}"), "0 or more")),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod room;
#[cfg(test)]
mod rooms;
#[cfg(test)]
mod tests;
