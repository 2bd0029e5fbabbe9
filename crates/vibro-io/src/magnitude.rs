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
mod tests {
    use super::*;
    use crate::Reader;
    use vibro_record::Fact;

    /// Findings on the four channels of a phone record: three axes, and what `last` computes from them.
    /// Values are printed with `decimals` decimals.
    fn marked(decimals: usize, last: impl Fn([f64; 3]) -> f64) -> Vec<Vec<Finding>> {
        let row = |i: i32| {
            let t = f64::from(i) / 200.0;
            let [x, y, z] = [(58.0 * t).sin(), 0.3 * (58.0 * t).cos(), 0.2 * (91.0 * t).sin()];
            format!("{t},{x:.decimals$},{y:.decimals$},{z:.decimals$},{:.decimals$}\n", last([x, y, z]))
        };
        let text = "t (s),x (g),y (g),z (g),a (g)\n".to_owned() + &(0..900).map(row).collect::<String>();
        let (reader, path) = (Reader::new(), "x.csv");
        let source = crate::Source::memory(path, text.as_bytes()).unwrap();
        let read = reader.read(&source).unwrap().records;
        let read: Vec<Vec<Finding>> = read.iter().map(|record| record.meta().findings.clone()).collect();
        let surveyed: Vec<_> = reader.headers(&source).unwrap().1.into_iter().map(|h| h.findings).collect();
        assert_eq!(read, surveyed);
        read
    }

    /// Channels: a counter, a small component, a large component, their magnitude.
    #[test]
    fn the_channel_to_name_is_the_component_that_moves_most() {
        let row = |i: i32| {
            let (x, y) = ((0.3 * f64::from(i)).sin() / 8.0, (0.3 * f64::from(i)).sin());
            format!("{},{i},{x},{y},{}\n", f64::from(i) / 200.0, x.hypot(y))
        };
        let text = "t (s),beat (g),x (g),y (g),a (g)\n".to_owned() + &(0..200).map(row).collect::<String>();
        let read = Reader::new().from_reader("x.csv", text.as_bytes()).unwrap();
        let said = read.trace(None, None).unwrap_err().to_string();
        assert!(said.contains("channel = \"y\""), "{said}");
    }

    #[test]
    fn the_length_of_a_vector_is_told_from_what_is_measured() {
        let length = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let caution = Finding::caution("magnitude").name("components", "x, y, z");
        for decimals in [2, 5, 12] {
            let found = marked(decimals, length);
            assert_eq!(found, [vec![], vec![], vec![], vec![caution.clone()]], "{decimals}");
        }
        assert_eq!(
            marked(5, |[x, y, _]| x.hypot(y))[3][0].fact("components"),
            Some(&Fact::Name("x, y".into()))
        );
        // A copy, a rectified channel, and a magnitude with an error of 5 %.
        for other in [|v: [f64; 3]| v[0], |v: [f64; 3]| v[0].abs(), |v: [f64; 3]| 1.05 * v[0].hypot(v[1])] {
            assert_eq!(marked(5, other), vec![vec![]; 4]);
        }
    }
}
