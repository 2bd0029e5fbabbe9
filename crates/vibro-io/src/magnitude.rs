//! Finds channels that hold the magnitude of a vector whose components are recorded beside them, such as the
//! absolute acceleration of a phone. A magnitude has no sign: an oscillation about zero appears at twice its
//! frequency.

use crate::held::{Contents, opening};
use vibro_record::{Finding, Record};

/// Code of the finding on such a channel.
pub const MAGNITUDE: &str = "magnitude";

/// Fewest samples for a comparison: fewer might agree by chance.
const FEW: usize = 32;

/// Largest RMS difference between a channel and the computed magnitude, over the channel's standard
/// deviation. Rounding to two decimals of a motion of one unit gives 2 %; an independent channel gives
/// about 1.
const NEAR: f64 = 3e-2;

/// Adds the finding to each trace whose first values are the magnitude of two or three other traces in a row
/// with the same unit.
pub fn mark(contents: &mut Contents) {
    let found: Vec<(usize, String)> = {
        let traces: Vec<(usize, &str, &str, &[f64])> = contents
            .records
            .iter()
            .enumerate()
            .filter_map(|(i, (record, ends))| {
                let Record::Trace(trace) = record else { return None };
                let first = ends.as_ref().map_or_else(|| opening(&trace.values), |ends| ends.opening());
                Some((i, trace.meta.name.as_str(), trace.meta.unit.symbol(), first))
            })
            .collect();
        let matched = |(i, _, unit, values): &(usize, &str, &str, &[f64])| {
            let possible = values.len() >= FEW && !values.iter().any(|v| *v < 0.0);
            let others: Vec<_> = traces
                .iter()
                .filter(|other| {
                    possible && other.0 != *i && other.2 == *unit && other.3.len() == values.len()
                })
                .collect();
            let in_a_row = [3, 2].into_iter().flat_map(|n| others.windows(n));
            let components = |row: &&[&(usize, &str, &str, &[f64])]| {
                is_length(values, &row.iter().map(|other| other.3).collect::<Vec<_>>())
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

/// Whether `values` are the magnitude of `components` and not equal to one of them. A magnitude that equals a
/// component without a change of sign doubles no frequency.
fn is_length(values: &[f64], components: &[&[f64]]) -> bool {
    let finite = |i: &usize| values[*i].is_finite() && components.iter().all(|c| c[*i].is_finite());
    let rows: Vec<usize> = (0..values.len()).filter(finite).collect();
    let mean = rows.iter().map(|i| values[*i]).sum::<f64>() / rows.len() as f64;
    let deviation = rows.iter().map(|i| (values[*i] - mean).powi(2)).sum::<f64>();
    let near = |other: &dyn Fn(usize) -> f64| {
        let mut off = 0.0;
        // Stops at the first row where the difference is too large: for most channels within a few rows.
        rows.iter().all(|i| {
            off += (values[*i] - other(*i)).powi(2);
            off <= NEAR * NEAR * deviation
        })
    };
    let length = |i: usize| components.iter().map(|c| c[i] * c[i]).sum::<f64>().sqrt();
    rows.len() >= FEW && deviation > 0.0 && near(&length) && !components.iter().any(|c| near(&|i| c[i]))
}

#[cfg(test)]
mod tests;
