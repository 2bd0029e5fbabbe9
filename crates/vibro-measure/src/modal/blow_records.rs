//! The records of a hammer's blows, over which a function was averaged.

use crate::spectral::BEFORE;
use vibro_record::Frf;

/// Records of blows. What is not known of the force is that of an impulse.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BlowRecords {
    /// Time in s from the centre of the force to the end of the record.
    pub after: f64,
    /// Time in s from the first sample of the record to the centre of the force; 0 where it is not known.
    pub before: f64,
    /// Variance in s² of the force over time.
    pub variance: f64,
    /// Time in s between samples; 0 where it is not known.
    pub sample: f64,
    /// Standard deviation of one component of the force's lowest line, over the line: noise of its sensor.
    pub scatter: f64,
    /// Shortest time in s from a blow to the next, where it is known.
    pub apart: Option<f64>,
    /// Number of blows, where it is known.
    pub count: Option<f64>,
}

impl BlowRecords {
    /// Of a function that was averaged over blows.
    pub(super) fn of(frf: &Frf) -> Option<BlowRecords> {
        let of = |key| frf.meta.of_blows(key);
        let lines = frf.axis.values();
        let spacing = lines.windows(2).map(|pair| pair[1] - pair[0]).reduce(f64::min);
        let record = spacing.filter(|_| frf.meta.from_blows()).map(|step| (1.0 - 1.0 / BEFORE as f64) / step);
        let after = of("after").or(record)?;
        let whole = of("length").zip(of("sample")).map(|(length, sample)| length * sample);
        Some(BlowRecords {
            after,
            before: whole.map_or(0.0, |whole| (whole - after).max(0.0)),
            variance: of("variance").unwrap_or(0.0),
            sample: of("sample").unwrap_or(0.0),
            scatter: of("scatter").unwrap_or(0.0),
            apart: of("apart"),
            count: of("count"),
        })
    }
}
