//! Analyses, one folder for each kind of record: its keys, its run, its figures, its tables.
//!
//! A table of a campaign and a command line fill the same keys: `[[impacts]] refractory = 0.005` and `vibro
//! impacts --refractory 0.005` run one function. A new kind of record is a folder here and a row in
//! `kinds.rs`.

pub(crate) mod answer;
mod compared_rig;
pub(crate) mod decay;
pub(crate) mod drawn;
pub(crate) mod drill;
pub(crate) mod drop;
pub(crate) mod entries;
pub(crate) mod evidence;
pub(crate) mod frf;
pub(crate) mod impacts;
mod inputs;
pub(crate) mod job;
mod kept;
pub(crate) mod kind;
pub(crate) mod kinds;
pub(crate) mod model;
mod named_file;
mod own_files;
pub(crate) mod plan;
pub(crate) mod precision;
mod progress;
pub(crate) mod pulse;
mod raw;
mod recordings;
mod run;
pub(crate) mod source;
pub(crate) mod spectrum;
pub mod study;
pub(crate) mod sweep;
pub(crate) mod tone;
mod twice;
mod unnamed;

pub(crate) mod headline;
mod page;

pub use answer::Answer;
pub use answer::LEFT_OUT;
pub(crate) use answer::unwritten;
pub use evidence::Evidence;
pub use kept::AnswerCache;
pub use kinds::{errors, files, open, open_in, parse, sections, title};
pub(crate) use own_files::OWN;
pub use own_files::{INPUTS, REPORT, RESULTS};
pub use progress::Progress;
pub use raw::{raw_sounds, raw_trace};
pub use recordings::{Recordings, recordings};
pub(crate) use recordings::{in_order, is_pattern, matching};
pub use run::{CampaignOutcome, answers, run};
pub use sweep::modelled::fit;
pub use sweep::{named, responses};
pub use unnamed::unnamed;

#[cfg(feature = "cli")]
pub(crate) use kind::FileCommand;
pub(crate) use kind::{Analysis, OfFile};
#[cfg(feature = "cli")]
pub(crate) use kinds::commands;
#[cfg(any(feature = "cli", test))]
pub(crate) use kinds::key_ranges;
pub(crate) use named_file::few;
pub(crate) use source::{Source, file_name};
pub(crate) use twice::double_use;

/// Figures of results, as data.
pub mod figures {
    pub use super::decay::figures::decay;
    pub use super::drill::figures::drill;
    pub use super::frf::figures::frf;
    pub use super::impacts::figures::{drop, drops, impacts};
    pub use super::model::figures::{
        branches, forces, ladder, orbit, phase_plane, poincare, regimes, sweep, traces,
    };
    pub use super::pulse::figures::pulse;
    pub use super::spectrum::figures::lines;
    pub use super::sweep::figures::{fit, map, overlay, receptance, response, waterfall};
}

#[cfg(test)]
mod tests;
