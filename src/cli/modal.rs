//! `vibro modal`: natural frequencies, damping ratios and modal constants.

use super::{args, complain, print, settings};
use crate::error::{Error, Result};
use crate::measure::modal::{Measured, ModalOptions, ModalResult, modal};
use crate::report::words::{self, Voice};
use crate::report::{Output, files, pictures, tables};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    result: ModalResult,
    files: Vec<String>,
}

pub fn run(typed: &args::Modal, json: bool) -> Result<()> {
    settings::above_zero("--mass", typed.mass)?;
    let recording = settings::reader(&typed.reading)?.from_path(&typed.file)?;
    let mut functions = Measured::all(&recording.records, typed.channel.channel.as_deref())
        .map_err(|e| e.of_record(&recording.path.display().to_string()).in_file(&recording.path))?;
    if functions.len() > 1 {
        let names: Vec<&str> = functions.iter().map(|(meta, _)| meta.name.as_str()).collect();
        return Err(Error::usage(
            format!("{} frequency response functions, and none was chosen", names.len()),
            format!("--channel, one of {}", names.join(", ")),
        ));
    }
    let Some((meta, mut measured)) = functions.pop() else {
        return Err(Error::refused("no frequency response function"));
    };
    if let Some(factor) = typed.channel.calibration {
        measured.values.iter_mut().for_each(|v| *v *= factor);
    }
    if let Some(path) = &typed.coherence {
        let coherence = settings::reader(&typed.reading)?.from_path(path)?;
        measured = measured.with_coherence_of(&coherence.records).map_err(|e| e.in_file(&coherence.path))?;
    }
    let options = ModalOptions {
        band: typed.band,
        mass: typed.mass,
        least_coherence: typed.least_coherence,
        decay: meta.added_decay(),
        from_blows: meta.from_blows(),
    };
    let mut result = modal(&measured, &options)?;
    let findings = [recording.findings.as_slice(), &meta.findings].concat();
    result.warnings.splice(0..0, words::sentences(&findings, Voice::Command));
    let title = typed.file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let mut drawn = vec![("frf".to_owned(), pictures::frf(&title, &meta, &measured, &result.modes))];
        drawn.extend(pictures::nyquist(&title, &measured, &result.modes).map(|f| ("nyquist".to_owned(), f)));
        files::figures(&mut output, &drawn, &|| ())?;
        output.write("modes.csv", tables::modes([("", &result)]).csv())?;
        output.write("methods.csv", tables::modal_methods(&result).csv())?;
        written = output.written().to_vec();
    }
    if json {
        return print::json(&Answer { result, files: written });
    }
    complain::warn(&result.warnings);
    let mut text = tables::modes([("", &result)]).text();
    let _ = write!(text, "\n{}", tables::modal_methods(&result).text());
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}
