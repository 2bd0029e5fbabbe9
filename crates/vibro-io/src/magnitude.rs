//! Channels that are the length of a vector whose components stand beside them, as phones record the absolute
//! acceleration: it has no sign, so that an oscillation about zero shows at twice its frequency.

use crate::held::{Contents, opening};
use vibro_record::{Finding, Record};

/// Its finding.
pub const MAGNITUDE: &str = "magnitude";

/// Fewest values that are compared.
const FEW: usize = 32;

/// RMS distance from the length over the deviation of the values: two decimals beside a motion of one unit
/// make 2 %, a channel that was measured for itself differs by as much as it moves.
const NEAR: f64 = 3e-2;

/// Marks each trace that is, in its first values, the root of the sum of the squares of two or three others
/// in a row that have its unit.
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
        let of = |(i, _, unit, values): &(usize, &str, &str, &[f64])| {
            let length = values.len() >= FEW && !values.iter().any(|v| *v < 0.0);
            let others: Vec<_> = traces
                .iter()
                .filter(|other| length && other.0 != *i && other.2 == *unit && other.3.len() == values.len())
                .collect();
            let in_a_row = [3, 2].into_iter().flat_map(|n| others.windows(n));
            let components = |row: &&[&(usize, &str, &str, &[f64])]| {
                is_length(values, &row.iter().map(|other| other.3).collect::<Vec<_>>())
            };
            let row = in_a_row.into_iter().find(components)?;
            Some((*i, row.iter().map(|other| other.1).collect::<Vec<_>>().join(", ")))
        };
        traces.iter().filter_map(of).collect()
    };
    for (i, components) in found {
        let meta = contents.records[i].0.meta_mut();
        meta.found(Finding::caution(MAGNITUDE).name("components", components));
    }
}

/// Whether values are the length of a vector, and none of its components: one that keeps its sign doubles no
/// tone.
fn is_length(values: &[f64], components: &[&[f64]]) -> bool {
    let finite = |i: &usize| values[*i].is_finite() && components.iter().all(|c| c[*i].is_finite());
    let rows: Vec<usize> = (0..values.len()).filter(finite).collect();
    let mean = rows.iter().map(|i| values[*i]).sum::<f64>() / rows.len() as f64;
    let deviation = rows.iter().map(|i| (values[*i] - mean).powi(2)).sum::<f64>();
    let near = |other: &dyn Fn(usize) -> f64| {
        let mut off = 0.0;
        // Ends where it is too far: most are at the first rows.
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
