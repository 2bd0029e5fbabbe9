//! Commands on one measurement file: `vibro spectrum`, `impacts`, `modal`, `pulse`, `restitution`, `drill`.

use super::question::{Asked, Question};
use super::sweep::{SweepPlace, of_script};
use super::{complain, print};
use crate::analysis::drill::cycles;
use crate::analysis::sweep::{Files, Listed, StoredResponseKeys, named};
use crate::analysis::{
    self, Analysis, Answer, FileCommand, OfFile, Source, drill, drop, frf, impacts, pulse, spectrum,
};
use crate::campaign::{Channel, Reading};
use crate::error::{Error, Result};
use crate::measure::drill::Cycle;
use crate::measure::response::ResponseOptions;
use crate::measure::{Estimate, legacy};
use crate::read::{Folder, Owner, SweepList, SweepReader};
use crate::record::{Finding, Trace, shown};
use crate::report::files::Names;
use crate::report::layout::{headed, table};
use clap::{ArgMatches, Args, Command, FromArgMatches as _};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Channel, reading of the file, and folder for results.
#[derive(Debug, Args)]
pub struct RecordArgs {
    #[command(flatten)]
    channel: Channel,
    #[command(flatten)]
    reading: Reading,
    /// Folder for figures as SVG and PNG, and tables as CSV
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
}

/// The file of a command that measures one.
#[derive(Debug, Args)]
pub struct MeasurementFile {
    /// Measurement file
    #[arg(index = 1)]
    file: PathBuf,
}

#[derive(Debug, Args)]
pub struct Modal {
    #[command(flatten)]
    of: MeasurementFile,
    #[command(flatten)]
    keys: frf::Keys,
    #[command(flatten)]
    record: RecordArgs,
}

#[derive(Debug, Args)]
pub struct Spectrum {
    /// Measurement file, or FILE#CHANNEL; several are compared
    #[arg(index = 1, required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    keys: spectrum::Keys,
    #[command(flatten)]
    record: RecordArgs,
}

#[derive(Debug, Args)]
pub struct Impacts {
    /// Repeat the thesis' script timeav with its mistakes
    legacy: bool,
    #[command(flatten)]
    of: MeasurementFile,
    #[command(flatten)]
    keys: impacts::Keys,
    #[command(flatten)]
    record: RecordArgs,
}

#[derive(Debug, Args)]
pub struct Drill {
    /// Write the velocity of every turn over the phase into this file
    each_cycle: Option<PathBuf>,
    #[command(flatten)]
    of: MeasurementFile,
    #[command(flatten)]
    keys: drill::Keys,
    #[command(flatten)]
    record: RecordArgs,
}

#[derive(Debug, Args)]
pub struct Pulse {
    /// Record of the acceleration (or force) of a contact
    #[arg(index = 1)]
    file: Option<PathBuf>,
    #[command(flatten)]
    keys: pulse::Keys,
    #[command(flatten)]
    record: RecordArgs,
}

#[derive(Debug, Args)]
pub struct Restitution {
    /// Traces of drops or of trains of bounces, one a drop
    #[arg(index = 1)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    keys: drop::Keys,
    #[command(flatten)]
    record: RecordArgs,
}

impl RecordArgs {
    /// Measures the record of a file.
    fn measured<T>(
        &self,
        asked: &Asked<'_>,
        file: &Path,
        measure: impl FnOnce(&Source<'_>) -> Result<T>,
    ) -> Result<T> {
        let name = match file.file_stem().map_or_else(String::new, shown) {
            pipe if pipe == "-" => "standard input".to_owned(),
            name => name,
        };
        measure(&Source {
            name: &name,
            path: file,
            folder: asked.folder,
            channel: &self.channel,
            reading: &self.reading,
            beside: &|_, file| Ok(file.to_owned()),
            progress: asked.progress,
        })
    }
}

/// Adds the options of a kind's command: the file, the keys of the kind, and how the file is read.
pub(super) fn with_file(line: Command, command: FileCommand) -> Command {
    RecordArgs::augment_args((command.options)(MeasurementFile::augment_args(line)))
}

/// The command of a kind with its typed options.
pub(super) struct OfKind {
    file: PathBuf,
    keys: Box<dyn OfFile>,
    record: RecordArgs,
    names: Names,
}

impl OfKind {
    /// Reads the typed options.
    ///
    /// # Errors
    /// If they are not those of the command.
    pub(super) fn of(
        typed: &ArgMatches,
        command: FileCommand,
        names: Names,
    ) -> std::result::Result<OfKind, clap::Error> {
        let file = MeasurementFile::from_arg_matches(typed)?.file;
        let record = RecordArgs::from_arg_matches(typed)?;
        Ok(OfKind { file, keys: (command.keys)(typed)?, record, names })
    }
}

impl Question for OfKind {
    fn names(&self) -> Names {
        self.names
    }

    fn out(&self) -> Option<&Path> {
        self.record.out.as_deref()
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.file.clone()]
    }

    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        self.record.measured(asked, &self.file, |source| self.keys.measure(source))
    }
}

impl Spectrum {
    /// A typed file, and its channel where it is `FILE#CHANNEL`.
    fn place(&self, typed: &Path) -> (PathBuf, Channel) {
        let stated = &self.record.channel;
        let text = typed.to_string_lossy();
        match spectrum::in_other_file(&text).filter(|_| !typed.exists()) {
            Some((file, channel)) => {
                (file.to_owned(), Channel { channel: Some(channel.to_owned()), ..stated.clone() })
            }
            None => (typed.to_owned(), stated.clone()),
        }
    }

    /// Checks that no channel is named in two ways, and that no record is typed twice.
    fn check(&self, places: &[(PathBuf, Channel)]) -> Result<()> {
        for (k, (typed, place)) in self.files.iter().zip(places).enumerate() {
            let named = self.record.channel.channel.as_deref().filter(|_| *typed != place.0);
            if let Some(channel) = named {
                let found = format!("{} beside the channel \"{channel}\"", shown(typed));
                return Err(
                    Error::usage(found, "FILE#CHANNEL, or a channel for all files").setting("channel")
                );
            }
            let same =
                |(file, channel): &(PathBuf, Channel)| *file == place.0 && channel.channel == place.1.channel;
            if places[..k].iter().any(same) {
                return Err(Error::usage(format!("{} twice", shown(typed)), "each record once"));
            }
        }
        Ok(())
    }

    /// Name of a typed file: the shortest of stem, file name and all that was typed that no other file has.
    fn name(&self, typed: &Path) -> String {
        let stem = |typed: &Path| self.place(typed).0.file_stem().map_or_else(String::new, shown);
        let last = |typed: &Path| typed.file_name().map_or_else(String::new, shown);
        let names: [&dyn Fn(&Path) -> String; 2] = [&stem, &last];
        let alone = |name: &&&dyn Fn(&Path) -> String| {
            self.files.iter().filter(|other| name(other) == name(typed)).count() == 1
        };
        names.iter().find(alone).map_or_else(|| shown(typed), |name| name(typed))
    }
}

impl Question for Spectrum {
    fn names(&self) -> Names {
        spectrum::Keys::FILES
    }

    fn out(&self) -> Option<&Path> {
        self.record.out.as_deref()
    }

    fn files(&self) -> Vec<PathBuf> {
        self.files.iter().map(|typed| self.place(typed).0).collect()
    }

    /// The answer of one record, or of several beside each other.
    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        let places: Vec<(PathBuf, Channel)> = self.files.iter().map(|file| self.place(file)).collect();
        self.check(&places)?;
        if let [(file, channel)] = places.as_slice() {
            return self
                .record
                .measured(asked, file, |source| self.keys.measure(&Source { channel, ..*source }));
        }
        let mut found = Vec::new();
        for (typed, (file, channel)) in self.files.iter().zip(&places) {
            let lines = self
                .record
                .measured(asked, file, |source| self.keys.lines(&Source { channel, ..*source }))?;
            found.push((self.name(typed), lines));
        }
        spectrum::compared(&found)
    }
}

impl Question for Impacts {
    fn names(&self) -> Names {
        impacts::Keys::FILES
    }

    fn out(&self) -> Option<&Path> {
        self.record.out.as_deref()
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.of.file.clone()]
    }

    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        self.record.measured(asked, &self.of.file, |source| {
            if self.legacy {
                return of_timeav(&source.trace(&source.recording()?)?);
            }
            self.keys.measure(source).map_err(|e| e.of_record(&source.path.display().to_string()))
        })
    }
}

/// Output of the script timeav: the mean interval and the times of impacts. It had no uncertainty.
fn of_timeav(trace: &Trace) -> Result<Answer> {
    let found = legacy::contact_times(trace)?;
    let n = found.times.len();
    let method = "(last − first)/(peaks − 1), as timeav";
    let mut answer = Answer::of(&json!({
        "n": n,
        "maxima": found.maxima,
        "interval": Estimate::new(found.interval, None, "s", n, method),
        "frequency": Estimate::new(found.frequency, None, "Hz", n, method),
        "median_interval": null,
        "spread": null,
        "missed": null,
        "doubled": null,
        "per_cycle": null,
        "regular": null,
        "times": found.times,
    }))?;
    answer.add("", [of_script("timeav")]);
    answer.add("", (n == 1).then(|| Finding::caution("timeav-one-peak")));
    let printed = headed("timeav", &[("maxp", ""), ("maxpeak", ""), ("diffav", "s"), ("diffreq", "Hz")]);
    let printed = printed.row([found.maxima.into(), n.into(), found.interval.into(), found.frequency.into()]);
    answer.tables.push(printed);
    answer.table("impacts", table("Peaks", &found.times, &[("peakt", "s", &|t| (**t).into())]));
    Ok(answer)
}

impl Modal {
    /// The receptance of a sweep, if the file is a list of a sweep or a campaign.
    fn sweep(&self, folder: &Folder) -> Result<Option<frf::Function>> {
        let typed = self.of.file.to_string_lossy();
        let SweepPlace { path, name, campaign } = SweepPlace::of(&typed);
        let listed = if campaign {
            named(&analysis::open_in(&folder.clone().allow_outside(false), Path::new(path))?, name)?
        } else {
            let inside = folder.clone().allow_outside(false);
            let Ok(list) = SweepList::from_path(path, &inside) else { return Ok(None) };
            let (unit, calibration) = (self.record.reading.only_unit()?, self.record.channel.calibration);
            let (name, folder) = (path.to_owned(), folder.clone());
            let mut reader = SweepReader { name, folder, ..SweepReader::default() };
            StoredResponseKeys { unit, calibration, ..StoredResponseKeys::default() }.apply(&mut reader)?;
            Listed { files: Files::Spectra(list), reader, findings: Vec::new() }
        };
        let (_, response) = listed.sweep_and_response(&ResponseOptions::default())?;
        frf::Function::of_response(&response).map(Some)
    }
}

impl Question for Modal {
    fn names(&self) -> Names {
        frf::Keys::FILES
    }

    fn out(&self) -> Option<&Path> {
        self.record.out.as_deref()
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.of.file.clone()]
    }

    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        let mut answers = match self.sweep(asked.folder)? {
            Some(function) => vec![self.keys.modes(&function.meta.name, &function)?],
            None => self.record.measured(asked, &self.of.file, |source| self.keys.measure(source))?,
        };
        if answers.len() > 1 {
            let names: Vec<&str> = answers.iter().map(|answer| answer.channel.as_str()).collect();
            let found = format!("{} frequency response functions, and none was chosen", names.len());
            let error = Error::usage(found, format!("one of {}", names.join(", ")));
            return Err(error.set("channel", format!("{:?}", names.first().unwrap_or(&"1"))));
        }
        let mut answer = answers.pop().ok_or_else(|| Error::refused("no frequency response function"))?;
        answer.refused.take().map_or(Ok(answer), Err)
    }
}

impl Question for Pulse {
    fn names(&self) -> Names {
        pulse::Keys::FILES
    }

    fn out(&self) -> Option<&Path> {
        self.record.out.as_deref()
    }

    fn files(&self) -> Vec<PathBuf> {
        self.file.iter().cloned().collect()
    }

    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        self.keys.usable(self.file.is_some())?;
        match &self.file {
            Some(file) => self.record.measured(asked, file, |source| self.keys.measure(source)),
            None => self.keys.times(""),
        }
    }
}

impl Question for Restitution {
    fn names(&self) -> Names {
        drop::Keys::FILES
    }

    fn out(&self) -> Option<&Path> {
        self.record.out.as_deref()
    }

    fn files(&self) -> Vec<PathBuf> {
        self.files.clone()
    }

    /// The restitution by every method that the data allow.
    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        self.keys.usable(!self.files.is_empty())?;
        let mut series = drop::Series::new(&self.keys);
        series.add_numbers(&self.keys);
        for file in &self.files {
            let added = self.record.measured(asked, file, |source| series.add_record(&self.keys, source));
            added.or_else(|error| series.leave_out(file, error))?;
        }
        series.answer("")
    }
}

impl Question for Drill {
    fn names(&self) -> Names {
        drill::Keys::FILES
    }

    fn out(&self) -> Option<&Path> {
        self.record.out.as_deref()
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.of.file.clone()]
    }

    /// Speed, impacts and the average turn; every turn goes into a file of its own if one is named.
    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        let of_cycles = |path: &PathBuf| print::File::of(asked.folder, path, Owner::Results);
        let file = self.each_cycle.as_ref().map(of_cycles).transpose()?;
        let mut turns = String::new();
        let mut each = |cycle: &Cycle<'_>| -> Result<()> {
            if file.is_some() {
                if turns.is_empty() {
                    turns = cycles::head(cycle.velocity.len());
                }
                turns += &cycles::row(cycle);
            }
            Ok(())
        };
        let mut answer =
            self.record.measured(asked, &self.of.file, |source| self.keys.measure(source, &mut each))?;
        if let Some(file) = file {
            let written = file.write(turns)?;
            complain::line(&format!("wrote {written}"));
            answer.result.insert("each_cycle".to_owned(), written.into());
        }
        Ok(answer)
    }
}
