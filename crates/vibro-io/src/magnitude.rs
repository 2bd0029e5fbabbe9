//! Finds channels that are the magnitude of a vector whose components are other channels, such as the
//! absolute acceleration of a phone. A magnitude has no sign: an oscillation about zero appears at twice its
//! frequency.

use crate::held::{Contents, first_values};
use vibro_record::lanes::Extremes;
use vibro_record::{Finding, Record};

/// Code of the finding on such a channel.
pub const MAGNITUDE: &str = "magnitude";

/// Least number of samples that are compared. Fewer may agree by chance.
const LEAST_SAMPLES: usize = 32;

/// Largest RMS difference between a channel and the magnitude computed from its components, divided by the
/// channel's standard deviation. Rounding to two decimals of a motion of one unit gives 2 %; an independent
/// channel gives about 1.
const LARGEST_DIFFERENCE: f64 = 3e-2;

/// Adds the finding to each trace whose first values are the magnitude of two or three consecutive other
/// traces of the same unit.
pub fn mark(contents: &mut Contents) {
    let found: Vec<(usize, String)> = {
        let traces: Vec<(usize, &str, &str, &[f64])> = contents
            .records
            .iter()
            .enumerate()
            .filter_map(|(i, (record, summary))| {
                let Record::Trace(trace) = record else { return None };
                let first =
                    summary.as_ref().map_or_else(|| first_values(&trace.values), Extremes::first_values);
                Some((i, trace.meta.name.as_str(), trace.meta.unit.symbol(), first))
            })
            .collect();
        let matched = |(i, _, unit, values): &(usize, &str, &str, &[f64])| {
            let possible = values.len() >= LEAST_SAMPLES && !values.iter().any(|v| *v < 0.0);
            let others: Vec<_> = traces
                .iter()
                .filter(|other| {
                    possible && other.0 != *i && other.2 == *unit && other.3.len() == values.len()
                })
                .collect();
            let in_a_row = [3, 2].into_iter().flat_map(|n| others.windows(n));
            let components = |row: &&[&(usize, &str, &str, &[f64])]| {
                is_magnitude(values, &row.iter().map(|other| other.3).collect::<Vec<_>>())
            };
            let row = in_a_row.into_iter().find(components)?;
            Some((*i, row.iter().map(|other| other.1).collect::<Vec<_>>().join(", ")))
        };
        traces.iter().filter_map(matched).collect()
    };
    for (i, components) in found {
        let meta = contents.records[i].0.meta_mut();
        meta.found(Finding::caution(MAGNITUDE).name("components", components));
    }
}

/// Whether `values` are the magnitude of `components` and differ from each of them. A magnitude that equals
/// one component doubles no frequency: that component does not change its sign.
fn is_magnitude(values: &[f64], components: &[&[f64]]) -> bool {
    let finite = |i: &usize| values[*i].is_finite() && components.iter().all(|c| c[*i].is_finite());
    let rows: Vec<usize> = (0..values.len()).filter(finite).collect();
    let mean = rows.iter().map(|i| values[*i]).sum::<f64>() / rows.len() as f64;
    let deviation = rows.iter().map(|i| (values[*i] - mean).powi(2)).sum::<f64>();
    let near = |other: &dyn Fn(usize) -> f64| {
        let mut off = 0.0;
        // Stops at the first row where the summed difference is too large: usually after a few rows.
        rows.iter().all(|i| {
            off += (values[*i] - other(*i)).powi(2);
            off <= LARGEST_DIFFERENCE.powi(2) * deviation
        })
    };
    let magnitude = |i: usize| components.iter().map(|c| c[i] * c[i]).sum::<f64>().sqrt();
    rows.len() >= LEAST_SAMPLES
        && deviation > 0.0
        && near(&magnitude)
        && !components.iter().any(|c| near(&|i| c[i]))
}

#[cfg(test)]
mod tests;
