//! A small picture of a record: the smallest and the largest value of each column.

use serde::Serialize;
use vibroimpact::record::{Axis, AxisKind, Record, Scaling, Trace, Window};
use vibroimpact::signal::spectrum::plain;

/// Smallest and largest values of a record in columns of equal width.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Picture {
    /// Abscissa at which the first column begins.
    pub from: f64,
    /// Abscissa at which the last column ends.
    pub to: f64,
    /// Smallest value of each column; `None` without a value.
    pub low: Vec<Option<f64>>,
    /// Largest value of each column.
    pub high: Vec<Option<f64>>,
}

/// Most samples of the spectrum of a trace.
const SPECTRUM: usize = 1 << 17;

impl Picture {
    /// The part of a trace from `from` to `to` in s, in at most `columns` columns.
    pub fn of_trace(trace: &Trace, from: f64, to: f64, columns: usize) -> Picture {
        Picture::of(&trace.axis.values(), &trace.values, (from, to), columns)
    }

    /// The spectrum of a part of an evenly sampled trace, of its first 131 072 samples at most; `None` of
    /// fewer than 16.
    pub fn of_spectrum(trace: &Trace, from: f64, to: f64, columns: usize) -> Option<Picture> {
        let rate = trace.rate()?;
        let place =
            |t: f64| (((t - trace.axis.at(0)) * rate).round().max(0.0) as usize).min(trace.values.len());
        let part = place(from)..place(to).min(place(from) + SPECTRUM);
        let values = trace.values.get(part).filter(|values| values.len() >= 16)?.to_vec();
        let (meta, axis) = (trace.meta.clone(), Axis::time(0.0, 1.0 / rate, values.len()));
        let spectrum = plain(&Trace { meta, axis, values }, Window::Hann, Scaling::Peak, true).ok()?;
        Some(Picture::of_record(&Record::Spectrum(spectrum), columns))
    }

    /// A whole record; magnitudes of spectra and functions are shown by their logarithms.
    pub fn of_record(record: &Record, columns: usize) -> Picture {
        let axis = record.axis();
        let x = axis.values();
        let ends = (x.first().copied().unwrap_or(0.0), x.last().copied().unwrap_or(0.0));
        // The logarithm of nothing is not finite, and not shown.
        let level = |v: f64| if axis.kind == AxisKind::Frequency { v.log10() } else { v };
        let values: Vec<f64> = match record {
            Record::Trace(trace) => trace.values.clone(),
            Record::Spectrum(spectrum) => spectrum.values.magnitudes().into_iter().map(level).collect(),
            Record::Frf(frf) => frf.values.iter().map(|v| level(v.norm())).collect(),
        };
        Picture::of(&x, &values, ends, columns)
    }

    fn of(x: &[f64], values: &[f64], (from, to): (f64, f64), columns: usize) -> Picture {
        let columns = columns.max(1);
        let (mut low, mut high) = (vec![None; columns], vec![None; columns]);
        let wide = (to - from) / columns as f64;
        // One sample beyond each end, so that the line goes on to the edge.
        let begins = x.partition_point(|t| *t < from).saturating_sub(1);
        let ends = (x.partition_point(|t| *t <= to) + 1).min(x.len());
        for (t, v) in x[begins..ends].iter().zip(&values[begins..ends]).filter(|(_, v)| v.is_finite()) {
            let column = if wide > 0.0 { ((t - from) / wide).max(0.0) as usize } else { 0 };
            let column = column.min(columns - 1);
            let of = |held: &mut Option<f64>, pick: fn(f64, f64) -> f64| {
                *held = Some(held.map_or(*v, |held| pick(held, *v)));
            };
            of(&mut low[column], f64::min);
            of(&mut high[column], f64::max);
        }
        Picture { from, to, low, high }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_column_has_its_smallest_and_its_largest_value() {
        let x: Vec<f64> = (0..8).map(f64::from).collect();
        let picture = Picture::of(&x, &[1.0, 3.0, f64::NAN, 2.0, -1.0, 0.0, 5.0, 4.0], (0.0, 8.0), 4);
        assert_eq!(picture.low, [Some(1.0), Some(2.0), Some(-1.0), Some(4.0)]);
        assert_eq!(picture.high, [Some(3.0), Some(2.0), Some(0.0), Some(5.0)]);
        let none = Picture::of(&[], &[], (0.0, 0.0), 2);
        assert_eq!(none.low, [None, None]);
    }
}
