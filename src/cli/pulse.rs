//! `vibro pulse`: damping ratio and frequency of a contact.

use super::{args, complain, print, settings};
use crate::error::{Error, Result};
use crate::measure::pulse::{Instrument, PulseOptions, PulseResult, pulse, two_times};
use crate::report::{Output, files, pictures, tables};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    result: PulseResult,
    warnings: Vec<String>,
    files: Vec<String>,
}

pub fn run(typed: &args::Pulse, json: bool) -> Result<()> {
    settings::above_zero("--mass", typed.mass)?;
    let mut warnings = Vec::new();
    let (title, result) = match (&typed.file, typed.time_to_peak, typed.duration) {
        (Some(file), ..) => {
            let (trace, doubts) = settings::trace(file, &typed.reading, &typed.channel)?;
            let instrument = Instrument::stated(typed.low_pass.map(args::LowPass::corner), typed.order)?;
            let result = pulse(&trace, &PulseOptions { instrument, mass: typed.mass })?;
            warnings = doubts;
            (file.file_stem().unwrap_or_default().to_string_lossy().into_owned(), result)
        }
        (None, Some(peak), Some(duration)) => {
            (String::new(), two_times(peak, duration, typed.std, typed.mass)?)
        }
        _ => {
            return Err(Error::usage(
                "neither a file nor two times",
                "FILE, or --time-to-peak and --duration",
            ));
        }
    };
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        if let Some(figure) = pictures::pulse(&title, &result) {
            files::figures(&mut output, &[("pulse".to_owned(), figure)], &|| ())?;
        }
        output.write("pulse.csv", tables::pulse(&title, &result).csv())?;
        output.write("pulse_fits.csv", tables::pulse_fits(&title, &result).csv())?;
        written = output.written().to_vec();
    }
    if json {
        return print::json(&Answer { result, warnings, files: written });
    }
    complain::warn(&warnings);
    complain::found(&result.findings);
    let mut text = tables::pulse(&title, &result).text();
    if !result.fits.is_empty() {
        let _ = write!(text, "\n{}", tables::pulse_fits(&title, &result).text());
    }
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}
