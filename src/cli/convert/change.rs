//! Time traces filtered, integrated and differentiated, and the sentences that say how.

use super::super::args::Change;
use crate::campaign::above_zero;
use crate::error::{Error, Result};
use crate::record::{Record, Trace};
use crate::signal::filter::Filter;
use crate::signal::{differentiate, integrate};
use crate::units::Quantity;
use crate::units::notation::quantity;

/// Order of one pass of every filter here.
const ORDER: usize = 4;

impl Change {
    /// Whether anything is to be done.
    pub fn wanted(&self) -> bool {
        self.integrate != 0 || self.smoothing.is_some() || self.low_pass.is_some() || self.high_pass.is_some()
    }

    /// Does it to all records; gives what was done, a sentence a step.
    ///
    /// # Errors
    /// If options contradict each other, a record is no time trace, or it cannot be filtered or integrated.
    pub fn apply(&self, records: &mut [Record]) -> Result<Vec<String>> {
        let corners = [("--low-pass", self.low_pass), ("--high-pass", self.high_pass), ("--fmin", self.fmin)];
        for (name, value) in
            corners.into_iter().chain([("--excitation", self.excitation), ("--smoothing", self.smoothing)])
        {
            above_zero(name, value)?;
        }
        if self.integrate > 0 && self.fmin.is_none() {
            return Err(Error::usage(
                "--integrate in time without a cut-off",
                "--fmin HZ: below it noise and drift would be all that is seen",
            )
            .hint(
                "half the lowest frequency that matters; the answer says from where on amplitudes are right",
            ));
        }
        let alone = [
            ("--fmin", self.fmin, self.integrate == 0),
            ("--excitation", self.excitation, self.integrate < 1),
        ];
        if let Some((name, ..)) = alone.iter().find(|(_, value, idle)| value.is_some() && *idle) {
            let found = format!("{name} with --integrate {}", self.integrate);
            return Err(Error::usage(found, "an integration"));
        }
        let mut said = Vec::new();
        if self.wanted() {
            for record in records {
                let (kind, name) = (record.kind(), record.meta().name.clone());
                let Record::Trace(trace) = record else {
                    return Err(Error::refused(format!("{name:?} is a {kind}, no time trace"))
                        .hint("choose a trace with --channel; `vibro spectrum` integrates in frequency"));
                };
                self.trace(trace, &mut said).map_err(|e| e.of_record(&name))?;
            }
        }
        Ok(said)
    }

    fn trace(&self, trace: &mut Trace, said: &mut Vec<String>) -> Result<()> {
        let rate = trace
            .rate()
            .ok_or_else(|| Error::refused("the sampling rate is not known").hint("state it with --rate"))?;
        let name = trace.meta.name.clone();
        if let Some(time) = self.smoothing {
            let corner = 1.0 / (std::f64::consts::TAU * time);
            let filter = Filter::smoothing(corner, rate)?;
            if let Some(i) = trace.values.iter().position(|v| !v.is_finite()) {
                return Err(Error::refused(format!(
                    "sample {i} is missing: smoothing would lose all behind it"
                ))
                .hint("cut the record before the gap"));
            }
            if let Some(first) = trace.values.first().copied() {
                filter.settled_at(first).apply(&mut trace.values);
            }
            trace.meta.step("filter", &[("filter", &filter), ("passes", &1)]);
            said.push(format!(
                "{name}: exponential smoothing with a time constant of {time} s, corner {corner:.6} Hz: slow changes come {time} s late. A low-pass of zero phase (--low-pass) does not delay."
            ));
        }
        let mut filters = Vec::new();
        if let Some(corner) = self.low_pass {
            filters.push(Filter::low_pass(corner, ORDER, rate)?);
        }
        for corner in self.high_pass.into_iter().chain(self.fmin.filter(|_| self.integrate < 0)) {
            filters.push(Filter::high_pass(corner, ORDER, rate)?);
        }
        for filter in filters {
            trace.values = filter.zero_phase(&trace.values)?;
            trace.meta.step("filter", &[("filter", &filter), ("passes", &2)]);
            said.push(format!(
                "{name}: {filter}, forwards and backwards: no delay, half the amplitude at the corner."
            ));
        }
        if let (1.., Some(corner)) = (self.integrate, self.fmin) {
            let how = integrate::InTime {
                times: self.integrate,
                corner,
                order: ORDER,
                period: self.excitation.map(f64::recip),
            };
            let found = integrate::in_time(trace, &how)?;
            let [low, high] = found.band;
            let unit = found.trace.meta.unit.symbol();
            said.push(format!(
                "{name}: integrated {} in time, each time with a Butterworth high-pass of order {ORDER}, corner {corner} Hz, forwards and backwards. Amplitudes are right within 1 % from {low:.4} to {high:.4} Hz, but for the first and the last {:.3} s. Drift left: {}.",
                often(self.integrate),
                found.edge,
                quantity(found.drift, unit, 2)
            ));
            if let Some(f) = self.excitation {
                let what = if (low..=high).contains(&f) { "" } else { ", which lies outside of that band," };
                said.push(format!(
                    "{name}: of a sine of {f} Hz{what} high-pass and trapezoid leave {:.6} of the amplitude, by which it may be divided.",
                    how.gain(f, rate)?
                ));
            }
            *trace = renamed(found.trace, trace);
        }
        if self.integrate < 0 {
            let found = differentiate::in_time(trace, self.integrate.unsigned_abs())?;
            said.push(format!(
                "{name}: differentiated {} in time. Amplitudes are right within 1 % up to {:.4} Hz.",
                often(self.integrate),
                found.highest
            ));
            *trace = renamed(found.trace, trace);
        }
        Ok(())
    }
}

/// A channel that is named after its quantity takes the name of the new one: no displacement is called velocity.
fn renamed(mut made: Trace, from: &Trace) -> Trace {
    let (before, after) = (from.meta.quantity, made.meta.quantity);
    if Quantity::from_name(&made.meta.name) == Some(before) && after != Quantity::Other {
        after.name().clone_into(&mut made.meta.name);
    }
    made
}

fn often(times: i8) -> &'static str {
    if times.abs() == 1 { "once" } else { "twice" }
}
