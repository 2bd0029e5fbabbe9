//! `vibro convert`: any readable file to UFF-58, CSV, WAV or NPY, on the way filtered and integrated.

mod change;

use super::target::{apart, write_beside};
use super::{args, complain, print};
use crate::error::{Error, Result};
use crate::record::Record;
use crate::report::words::{self, Voice};
use crate::write::{Precision, Storage, Target};
use serde::Serialize;

#[derive(Serialize)]
struct Answer {
    written: String,
    format: &'static str,
    records: usize,
    warnings: Vec<String>,
}

pub fn run(typed: &args::Convert, json: bool) -> Result<()> {
    let target = Target::of(&typed.output)?;
    apart(&typed.input, &typed.output)?;
    if (typed.binary || typed.single) && matches!(target, Target::Csv | Target::Tsv | Target::Npy) {
        return Err(Error::usage(
            format!("--binary and --single say nothing for {}", target.name()),
            "a .uff or .wav file with them",
        ));
    }
    let one = typed.channel.channel.is_some() || typed.channel.calibration.is_some();
    let reader = typed.reading.reader()?;
    let reader = if one || typed.change.wanted() { reader.rate_of_base_band() } else { reader };
    let mut recording = reader.from_path(&typed.input)?;
    if one {
        let trace = recording.trace(typed.channel.channel.as_deref(), typed.channel.calibration)?;
        recording.records = vec![Record::Trace(trace)];
    }
    let changes = typed.change.apply(&mut recording.records)?;
    let mut bytes = Vec::new();
    let precision = if typed.single { Precision::Single } else { Precision::Double };
    target.write(&recording.records, Storage { binary: typed.binary, precision }, &mut bytes)?;
    let mut warnings = words::sentences(&recording.all_findings(), Voice::Command);
    warnings.extend(changes);
    if target == Target::Npy {
        warnings.push("An array file holds values only: axis and unit are not in it.".to_owned());
    }
    let existed = typed.output.exists();
    let written = write_beside(&typed.output, &bytes)?;
    if existed {
        warnings.push(format!("{} existed and was replaced.", typed.output.display()));
    }
    if json {
        return print::json(&Answer {
            written: written.display().to_string(),
            format: target.name(),
            records: recording.records.len(),
            warnings,
        });
    }
    complain::warn(&warnings);
    print::text(&format!(
        "{}: {} record(s) as {}\n",
        written.display(),
        recording.records.len(),
        target.name()
    ))
}
