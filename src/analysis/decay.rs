//! Free decays: `[[decay]]`, `vibro decay`.

pub mod figures;

use super::answer::Answer;
use super::headline::headline;
use super::job::Job;
#[cfg(feature = "cli")]
use super::kind::FileCommand;
use super::kind::{Analysis, OfFile, no_file};
use super::source::Source;
use crate::campaign::{Entry, KeyRange};
use crate::error::Result;
use crate::measure::decay::{DecayOptions, DecayResult, decay};
use crate::record::doubt_with_record;
use crate::record::units::notation;
use crate::report::files::Names;
use crate::report::layout::{degrees, table, titled};
use crate::report::{Cell, Table};
use serde::Deserialize;

/// Memory for the search beside the trace, as a multiple of it. With ten million samples, trace and search
/// together took 8.8 times the trace.
const BESIDE: f64 = 8.0;

/// How modes of a decay are found.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// Band in Hz in which modes are looked for [default: all lines]
    #[cfg_attr(feature = "cli", arg(value_name = "LO:HI", value_parser = crate::campaign::two::<':'>))]
    pub band: Option<(f64, f64)>,
    /// Number of modes [default: all that stand out of the noise]
    pub modes: Option<usize>,
}

impl OfFile for Keys {
    fn measure(&self, source: &Source<'_>) -> Result<Answer> {
        let mut recording = source.channels(None, BESIDE)?;
        let trace = recording.take_trace(source.channel.channel.as_deref(), source.channel.calibration)?;
        let mut found = decay(&trace, &DecayOptions { band: self.band, modes: self.modes })?;
        doubt_with_record(recording.findings.iter().chain(&trace.meta.findings), &mut found);
        let mut answer = Answer::of(&found)?;
        answer.add("", &found.findings);
        answer.add("", &recording.findings);
        answer.add("", &trace.meta.findings);
        answer.evidence.push((&found).into());
        answer.headlines.push(headline(
            "Free decays",
            &found.modes,
            &[
                ("frequency", "Hz", &|mode| Cell::from(&mode.frequency)),
                ("damping ratio", "", &|mode| Cell::from(&mode.zeta)),
            ],
        ));
        answer.table("modes", modes(source.name, &found));
        if !found.levels.is_empty() {
            answer.table("levels", levels(source.name, &found));
        }
        answer.figure("decay", figures::decay(source.name, &trace.meta, &found));
        Ok(answer)
    }
}

fn modes(name: &str, found: &DecayResult) -> Table {
    let table = table(
        titled("Modes", name),
        &found.modes,
        &[
            ("frequency", "Hz", &|mode| Cell::from(&mode.frequency)),
            ("damping ratio", "1", &|mode| Cell::from(&mode.zeta)),
            ("amplitude", unit(found), &|mode| Cell::from(&mode.amplitude)),
            ("phase", "°", &|mode| degrees(&mode.phase)),
        ],
    );
    let (start, end) = (found.start, found.end);
    let note = format!(
        "Natural frequency, of the motion without damping. Amplitude and phase at {start:.3} s; used up to {end:.3} s."
    );
    let decrement = found.decrement.as_ref().map(|ratio| {
        let ratio = notation::estimate(ratio.value, ratio.std);
        format!(" Logarithmic decrement of the strongest: damping ratio {ratio}.")
    });
    table.note(note + &decrement.unwrap_or_default())
}

/// Unit of the amplitudes.
fn unit(found: &DecayResult) -> &'static str {
    found.modes.first().map_or("", |mode| mode.amplitude.unit)
}

/// Frequency and damping of the strongest mode over its amplitude.
fn levels(name: &str, found: &DecayResult) -> Table {
    table(
        titled("Damping over amplitude", name),
        &found.levels,
        &[
            ("from", "s", &|level| level.start.into()),
            ("amplitude", unit(found), &|level| Cell::from(&level.mode.amplitude)),
            ("frequency", "Hz", &|level| Cell::from(&level.mode.frequency)),
            ("damping ratio", "1", &|level| Cell::from(&level.mode.zeta)),
        ],
    )
}

impl Analysis for Keys {
    const SECTION: &'static str = "decay";
    const TITLE: &'static str = "Free decays";
    const FILES: Names = Names::Numbered(&["modes", "levels", "decay"]);
    #[cfg(feature = "cli")]
    const COMMAND: Option<FileCommand> = Some(FileCommand::of::<Keys>(
        "decay release.csv",
        "Natural frequency and damping of each mode of a free decay",
    ));
    const RANGES: &'static [KeyRange] = &[KeyRange::count(1e3, &["modes"])];

    fn check(entry: &Entry<Keys>, _: &[Entry<Keys>]) -> Result<()> {
        entry.file.as_ref().ok_or_else(no_file).map(drop)
    }

    fn run(entries: &[Entry<Keys>], job: &mut Job<'_>) -> Result<()> {
        job.each("decays", entries, |entry, source| Ok(vec![entry.keys.measure(source)?]))
    }
}
