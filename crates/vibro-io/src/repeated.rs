//! Records of one name in one file, such as those of repeated blows.

use crate::format::Format;
use crate::reader::Reader;
use std::path::Path;
use vibro_record::{Axis, Finding, Result, Trace, Traces};

/// Indices of two channels among the names of a file, and of the further records of the same two names.
pub fn repeated(names: &[&str], pair: [&str; 2]) -> Vec<[usize; 2]> {
    let numbered = |name: &str, n: usize| if n > 1 { format!("{name} #{n}") } else { name.to_owned() };
    let place = |name: &str, n: usize| names.iter().position(|other| *other == numbered(name, n));
    (1..).map_while(|n| Some([place(pair[0], n)?, place(pair[1], n)?])).collect()
}

impl Reader {
    /// As [`Reader::stream_chosen`] with a reference, in memory: the further records of the same two names
    /// follow, as those of further blows of a hammer. Where they do not belong together, in pairs of one
    /// order, rate and length, they are left out, with a finding.
    ///
    /// # Errors
    /// As [`Reader::stream_chosen`].
    pub fn stream_repeated(
        &self,
        file: impl AsRef<Path>,
        reference: &str,
        channel: Option<&str>,
        calibration: Option<f64>,
    ) -> Result<Traces> {
        let file = file.as_ref();
        let traces = self.stream_chosen(file, Some(reference), channel, calibration)?;
        let [force, response] = traces.channels() else { return Ok(traces) };
        // Records of other formats have names of their own.
        if self.entry(&self.source(file)?).map_or(true, |entry| entry.format != Format::Uff) {
            return Ok(traces);
        }
        let recording = self.from_path(file)?;
        let names: Vec<&str> = recording.records.iter().map(|record| record.meta().name.as_str()).collect();
        let pairs = repeated(&names, [&force.name, &response.name]);
        if pairs.len() < 2 {
            return Ok(traces);
        }
        let trace = |k: usize, factor| recording.trace(Some(names[k]), factor);
        let pair = |[a, b]: &[usize; 2]| Ok([trace(*a, None)?, trace(*b, calibration)?]);
        let mut all = pairs.iter().map(pair).collect::<Result<Vec<[Trace; 2]>>>()?;
        let alike = |trace: &Trace, first: &Trace| {
            (trace.rate(), trace.values.len(), &trace.meta.unit)
                == (first.rate(), first.values.len(), &first.meta.unit)
        };
        let in_order = pairs.iter().all(|[a, b]| b.wrapping_sub(*a) == pairs[0][1].wrapping_sub(pairs[0][0]));
        let joined = in_order && all.iter().all(|pair| (0..2).all(|i| alike(&pair[i], &all[0][i])));
        let found = if joined {
            Finding::note("records-joined").count("n", all.len())
        } else {
            Finding::caution("records-unused").count("n", all.len() - 1)
        };
        let found = found.name("channel", names[pairs[1][1]]).name("reference", names[pairs[1][0]]);
        let [mut force, mut response] = all.remove(0);
        for more in all.iter().filter(|_| joined) {
            force.values.extend(&more[0].values);
            response.values.extend(&more[1].values);
        }
        for trace in [&mut force, &mut response] {
            let step = trace.axis.step().unwrap_or_default();
            trace.axis = Axis::time(trace.axis.start(), step, trace.values.len());
        }
        let findings = recording.findings.into_iter().chain([found]).collect();
        Traces::of_file(traces.path().to_owned(), findings, vec![force, response])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn further_records_of_two_names_are_found_in_pairs() {
        let names = ["f", "a", "b", "f #2", "a #2", "b #2", "f #3", "a #3"];
        assert_eq!(repeated(&names, ["f", "a"]), [[0, 1], [3, 4], [6, 7]]);
        assert_eq!(repeated(&names, ["f", "b"]), [[0, 2], [3, 5]]);
        assert_eq!(repeated(&names, ["f #2", "a #2"]), [[3, 4]]);
        assert!(repeated(&names, ["f", "c"]).is_empty());
    }
}
