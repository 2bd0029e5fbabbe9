//! `vibro drill`: speed, impacts and the average turn of a hammer drill.

use super::{args, complain, print, progress, settings};
use crate::analysis::DrillFile;
use crate::error::{Error, Result};
use crate::measure::drill::{Beam, Cycle, Drill, DrillOptions, Edge, From, Smoothing};
use crate::report::words::{Voice, sentences};
use crate::report::{Growing, Output, files, pictures, tables};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    drill: Drill,
    files: Vec<String>,
}

pub fn run(typed: &args::Drill, json: bool) -> Result<()> {
    let options = options(typed)?;
    let file = DrillFile {
        reader: settings::reader(&typed.reading)?,
        path: typed.file.clone(),
        velocity: typed.velocity.clone(),
        reference: typed.reference.clone(),
        handle: typed.handle.clone(),
        handle_sensitivity: typed.handle_sensitivity,
        noise: typed.noise.clone(),
    };
    let bar = progress::bar(json);
    bar.set_message("samples, three passes");
    let mut cycles = typed.each_cycle.as_deref().map(Cycles::new).transpose()?;
    let found = file.measure_each(
        &options,
        &|done, all| {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
        },
        &mut |cycle| cycles.as_mut().map_or(Ok(()), |c| c.push(cycle)),
    );
    bar.finish_and_clear();
    let drill = found?;
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let name = typed.file.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        files::figures(&mut output, &pictures::drill(&name, &drill), &|| ())?;
        output.write("average.csv", tables::drill_average(&drill).csv())?;
        output.write("impacts.csv", tables::drill_impacts(&drill).csv())?;
        written = output.written().to_vec();
    }
    if let Some((path, cycles)) = typed.each_cycle.as_ref().zip(cycles) {
        let (folder, name) = apart(path)?;
        Output::new(folder)?.write(&name, tables::drill_impacts(&drill).csv())?;
        written.push(path.display().to_string());
        written.extend(cycles.finish()?);
    }
    if json {
        return print::json(&Answer { drill, files: written });
    }
    complain::warn(&sentences(&drill.findings, Voice::Command));
    let mut text = tables::drill(std::slice::from_ref(&("", &drill))).text();
    text.push_str("\neach impact and the average turn: --json, or files with --out\n");
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}

/// Folder and name of a file.
fn apart(path: &Path) -> Result<(&Path, String)> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned());
    Ok((folder, name.ok_or_else(|| Error::usage("--each-cycle without a file name", "a file, NAME.csv"))?))
}

/// The table of turns over the phase, written as they come, beside the table of impacts.
struct Cycles {
    output: Output,
    /// Made with the first turn, so that a record that allows no answer leaves nothing.
    file: Option<Growing>,
    name: String,
}

impl Cycles {
    fn new(path: &Path) -> Result<Cycles> {
        let (beside, name) = apart(path)?;
        let stem =
            Path::new(&name).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        Ok(Cycles { output: Output::new(beside)?, file: None, name: format!("{stem}_velocity.csv") })
    }

    fn push(&mut self, cycle: &Cycle<'_>) -> Result<()> {
        let mut file = if let Some(file) = self.file.take() {
            file
        } else {
            let mut file = self.output.growing(&self.name)?;
            file.push(&tables::drill_cycles_head(cycle.velocity.len()))?;
            file
        };
        file.push(&tables::drill_cycles_row(cycle))?;
        self.file = Some(file);
        Ok(())
    }

    /// Path of the file; `None` where there was no turn.
    fn finish(mut self) -> Result<Option<String>> {
        let Some(file) = self.file else { return Ok(None) };
        let path = self.output.finish(file)?;
        Ok(Some(path.display().to_string()))
    }
}

fn options(typed: &args::Drill) -> Result<DrillOptions> {
    let from = match typed.from {
        args::From::Normal => From::Normal,
        args::From::Axis => From::Axis,
    };
    let edge = match typed.edge {
        args::Edge::Rising => Edge::Rising,
        args::Edge::Falling => Edge::Falling,
    };
    if let Some(bad) = typed.sensitivity.filter(|s| !s.is_finite()) {
        return Err(Error::usage(format!("a sensitivity of {bad}"), "m/s a unit, not 0"));
    }
    let beam = Beam::new(typed.beam_angle, from)?;
    // Without a number the file must say that the channel is a velocity.
    let sensitivity = typed.sensitivity.unwrap_or(f64::NAN);
    let smoothing = match (typed.low_pass, typed.smoothing) {
        (Some(args::LowPass::Off), _) => Smoothing::Off,
        (Some(args::LowPass::Corner(corner)), _) => Smoothing::LowPass(corner),
        (None, Some(time)) => Smoothing::Exponential(time),
        (None, None) => Smoothing::default(),
    };
    Ok(DrillOptions {
        level: typed.level,
        mass: typed.mass,
        struck_mass: typed.struck_mass,
        contact: typed.contact,
        fit: typed.fit,
        longest_dropout: typed.longest_dropout,
        delay: typed.delay,
        points: typed.points,
        smoothing,
        instrument: typed.instrument,
        margin: typed.margin,
        hours: typed.exposure,
        ..DrillOptions::new(sensitivity, beam, typed.pulses_per_turn, edge)
    })
}
