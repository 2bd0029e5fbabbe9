//! `vibro convert`: any readable file to UFF-58, CSV, WAV or NPY, on the way filtered and integrated.

mod change;

use super::{Run, print};
use crate::analysis::Answer;
use crate::campaign::{Channel, Reading};
use crate::error::{Error, Result};
use crate::record::{Finding, Record};
use crate::report::Output;
use crate::report::layout::headed;
use crate::write::{Precision, Storage, Target};
use change::Change;
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Convert {
    /// File to read
    #[arg(index = 1)]
    input: PathBuf,
    /// File to write: .uff .unv (UFF-58), .csv .tsv, .wav, .npy
    #[arg(index = 2)]
    output: PathBuf,
    /// Write UFF-58 as binary (58b)
    binary: bool,
    /// Write single instead of double precision, where the format has both
    single: bool,
    #[command(flatten)]
    change: Change,
    #[command(flatten)]
    channel: Channel,
    #[command(flatten)]
    reading: Reading,
}

impl Run for Convert {
    /// Writes the file and prints what is in it.
    fn run(&self, json: bool) -> Result<u8> {
        let target = Target::of(&self.output)?;
        apart(&self.input, &self.output)?;
        let one = self.channel.channel.is_some() || self.channel.calibration.is_some();
        let reader = self.reading.reader()?;
        let reader = if one || self.change.wanted() { reader.rate_of_base_band() } else { reader };
        let mut recording = reader.from_path(&self.input)?;
        if one {
            let trace = recording.trace(self.channel.channel.as_deref(), self.channel.calibration)?;
            recording.records = vec![Record::Trace(trace)];
        }
        let changes = self.change.apply(&mut recording.records)?;
        let mut bytes = Vec::new();
        let precision = if self.single { Precision::Single } else { Precision::Double };
        target.write(&recording.records, Storage { binary: self.binary, precision }, &mut bytes)?;
        let existed = self.output.exists();
        write_beside(&self.output, &bytes)?;
        let written = self.output.display().to_string();
        let (format, records) = (target.name(), recording.records.len());
        let mut answer = Answer::of(&json!({ "written": written, "format": format, "records": records }))?;
        answer.add("", recording.all_findings());
        answer.add("", changes);
        answer.add("", (target == Target::Npy).then(|| Finding::caution("values-only")));
        answer.add("", existed.then(|| Finding::caution("file-replaced").name("file", &*written)));
        let done = headed("", &[("written", ""), ("records", ""), ("format", "")]);
        answer.tables.push(done.row([written.into(), records.into(), format.into()]));
        print::answer(answer, None, json)
    }
}

/// Refuses two names of one file: what is read must not be written.
pub fn apart(a: &Path, b: &Path) -> Result<()> {
    let same = match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    };
    let found = || format!("{} and {} are the same file", a.display(), b.display());
    if same { Err(Error::usage(found(), "two files").hint("name another file to write")) } else { Ok(()) }
}

/// The folder of a file to write, which must exist.
pub fn folder_of(path: &Path) -> Result<&Path> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let found = || format!("the folder {} does not exist", folder.display());
    folder.is_dir().then_some(folder).ok_or_else(|| Error::usage(found(), "an existing folder"))
}

/// Writes a file whole.
pub fn write_beside(path: &Path, bytes: impl AsRef<[u8]>) -> Result<()> {
    let name = path
        .file_name()
        .ok_or_else(|| Error::usage(format!("{} is no file name", path.display()), "a file"))?;
    let folder = folder_of(path)?;
    let mut output = Output::new(folder)?;
    output.write(&name.to_string_lossy(), bytes)?;
    output.commit().map(drop)
}
