//! What record a data set 58 becomes: kind, axis, scaling, unit, and the findings about each.

use super::abscissa;
use super::heading::Heading;
use super::kind::Kind;
use super::ordinate::Ordinate;
use super::sink::{Counted, Kept};
use super::spacing::Spacing;
use super::stated::Stated;
use super::values::Taken;
use crate::assemble::to_si;
use crate::uff::system::System;
use crate::{Header, Options, missing};
use vibro_record::units::{self, Unit};
use vibro_record::{
    Axis, AxisKind, Error, Finding, Frf, FrfKind, Grid, Meta, Record, Result, Scaling, Spectrum, Trace,
    Values, Window,
};

/// Everything about a record but its values.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Channel, unit, doubts.
    pub meta: Meta,
    kind: Kind,
    complex: bool,
    axis: AxisKind,
    start: f64,
    /// `None` where the abscissa is stored.
    step: Option<f64>,
    /// From stored abscissa values to SI.
    abscissa_factor: f64,
    /// From stored values to SI.
    factor: f64,
    window: Option<Window>,
    enbw: Option<f64>,
}

impl Plan {
    /// Finds out what a header means.
    ///
    /// # Errors
    /// If values are complex over time: no record can hold them.
    pub fn new(heading: &Heading, system: &System, options: &Options, file: &str) -> Result<Plan> {
        let mut meta = Meta::new(heading.name(), Unit::none());
        for (i, line) in heading.id.iter().enumerate().filter(|(_, line)| !line.is_empty()) {
            meta.notes.push((format!("id line {}", i + 1), line.clone()));
        }
        meta.notes.push(("record 6".to_owned(), heading.record6.clone()));
        meta.notes.push(("point".to_owned(), heading.name()));
        meta.declared_n = Some(heading.n);
        meta.step("read", &[("file", &file), ("format", &"uff"), ("case", &heading.layout.case())]);
        let coherence = matches!(heading.function, 6 | 21 | 26)
            || Stated::of(&heading.id[4]).scaling == Some(Scaling::Coherence);
        let factor = unit(heading, system, options, coherence, &mut meta);
        let (axis, abscissa_factor) = abscissa::kind_and_factor(heading, options, &mut meta);
        let complex = heading.layout.complex;
        if complex && axis == AxisKind::Time {
            return Err(Error::input(
                heading.place.clone(),
                "complex values over time",
                "complex values over frequency, or real values over time",
            )
            .hint("export real and imaginary part as two real data sets"));
        }
        let stated = Stated::of(&heading.id[4]);
        let kind = Kind::of(heading, &axis, stated.scaling, &mut meta);
        let mut plan = Plan {
            meta,
            kind,
            complex,
            axis,
            start: heading.start * abscissa_factor,
            step: heading.layout.even.then_some(heading.step * abscissa_factor),
            abscissa_factor,
            factor,
            window: stated.window,
            enbw: stated.enbw,
        };
        plan.settle_step(options);
        Ok(plan)
    }

    /// A step that is given wins; a step that is no step leaves numbered values.
    fn settle_step(&mut self, options: &Options) {
        if options.base_band.is_some() && self.axis == AxisKind::Frequency {
            self.meta.found(Finding::caution("band-unused"));
        }
        if let Some(rate) = options.rate.filter(|_| self.axis == AxisKind::Time) {
            let said = 1.0 / rate;
            let differs = |step: f64| (step / said - 1.0).abs() > 1e-5; // record 7 prints six digits
            if self.step.is_none_or(differs) {
                let found = match self.step {
                    Some(step) => Finding::caution("rate-overrides-step").number("step", step),
                    None => Finding::caution("rate-overrides-instants"),
                };
                self.meta.found(found.number("rate", rate));
            }
            self.step = Some(said);
        }
        if let Some(step) = self.step
            && !(step > 0.0 && step.is_finite() && self.start.is_finite())
        {
            self.meta.found(Finding::caution("increment-impossible").number("step", step));
            (self.axis, self.start, self.step) = (AxisKind::Index, 0.0, Some(1.0));
        }
    }

    /// Doubts that only the values bring.
    pub fn counted(&mut self, declared: usize, taken: Taken) {
        if taken.n < declared {
            let fewer = Finding::caution("fewer-values").count("declared", declared);
            self.meta.found(fewer.count("n", taken.n));
        } else if declared == 0 {
            self.meta.found(Finding::caution("no-values-declared"));
        }
        if let Some(kept) = missing::kept(taken.missing) {
            self.meta.found(kept);
        }
    }

    /// Start and step of a stored abscissa that is even within its digits. Only a trace needs them, for its rate; lines of
    /// a spectrum are used one by one and keep their frequencies.
    fn evened(&mut self, spacing: &Spacing) -> Option<(f64, f64)> {
        if self.axis != AxisKind::Time {
            return None;
        }
        let Some(step) = spacing.step() else {
            self.meta.found(Finding::caution("instants-uneven"));
            return None;
        };
        let (start, seconds) = (spacing.first() * self.abscissa_factor, step * self.abscissa_factor);
        if spacing.is_coarse(step) {
            self.meta.found(Finding::caution("instants-coarse").number("step", seconds));
        }
        Some((start, seconds))
    }

    /// The record.
    ///
    /// # Errors
    /// If a value is beyond all numbers in SI units.
    pub fn record(mut self, kept: Kept) -> Result<Record> {
        let n = kept.values.len();
        let even = self.step.map(|step| (self.start, step)).or_else(|| self.evened(&kept.spacing()));
        let grid = match even {
            Some((start, step)) => Grid::Even { start, step, n },
            None => Grid::Uneven(kept.abscissa.iter().map(|x| x * self.abscissa_factor).collect()),
        };
        let mut values = kept.values;
        to_si(&mut values, self.factor)?;
        Ok(self.build(grid, values))
    }

    /// The record's header, from a count of its values.
    ///
    /// # Errors
    /// If a value is beyond all numbers in SI units.
    pub fn header(mut self, counted: &Counted) -> Result<Header> {
        let (summary, factor) = (counted.summary, self.factor);
        if let Some((_, mut max)) = summary.max {
            units::scale([&mut max], factor)?;
        }
        let x0 = counted.spacing.first() * self.abscissa_factor;
        let max_at = counted.max_at.map(|x| x * self.abscissa_factor);
        let even = self.step.map(|step| (self.start, step)).or_else(|| self.evened(&counted.spacing));
        let grid = match even {
            Some((start, step)) => Grid::Even { start, step, n: summary.n },
            None => Grid::Uneven(Vec::new()),
        };
        let none = if self.complex { Values::Complex(Vec::new()) } else { Values::Real(Vec::new()) };
        let empty = self.build(grid, none);
        let mut header = Header::of(&empty).summed(&summary, factor, empty.axis());
        if even.is_none() {
            (header.x0, header.max_at) = (x0, max_at);
        }
        Ok(header)
    }

    fn build(self, grid: Grid, values: Values) -> Record {
        let Plan { meta, axis, .. } = self;
        let axis = Axis { kind: axis, grid };
        match (self.kind, values) {
            (Kind::Trace, Values::Real(values)) => Record::Trace(Trace { meta, axis, values }),
            (Kind::Frf, Values::Complex(values)) => {
                let kind = FrfKind::of(meta.quantity);
                Record::Frf(Frf { meta, axis, values, kind })
            }
            (kind, values) => {
                let scaling = if let Kind::Spectrum(scaling) = kind { scaling } else { Scaling::Unknown };
                Record::Spectrum(Spectrum {
                    meta,
                    axis,
                    values,
                    scaling,
                    window: self.window,
                    enbw: self.enbw,
                })
            }
        }
    }
}

/// Settles unit and quantity; gives the factor to SI.
fn unit(heading: &Heading, system: &System, options: &Options, coherence: bool, meta: &mut Meta) -> f64 {
    let Ordinate { unit, factor, written, findings } = Ordinate::of(heading, system);
    // A coherence has none, whatever that of the function beside it is.
    if let Some(said) = options.unit.as_ref().filter(|_| !coherence) {
        if unit.is_known() && (unit.dimension() != said.dimension() || factor != said.factor()) {
            let differs = Finding::caution("unit-overrides-file").name("file", written);
            meta.found(differs.name("used", said.symbol()));
        }
        return meta.adopt_unit(said.symbol());
    }
    for found in findings {
        meta.found(found);
    }
    if factor != 1.0 {
        let from = if written.is_empty() { "data set 164" } else { &written };
        meta.step("to_si", &[("from", &from), ("factor", &factor)]);
    }
    meta.quantity = unit.quantity();
    meta.unit = unit;
    factor
}
