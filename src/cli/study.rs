//! Parts of a study: `--shard I/N`, which computes one, and `vibro merge`, which joins all.

use super::campaign::Compare;
use super::campaigns::Campaigns;
use super::print;
use super::{CommandArgs, complain, stdout};
use crate::analysis::model::map::{self, Map};
use crate::analysis::model::response::{self, Draws};
use crate::analysis::precision::Benchmark;
use crate::analysis::study::{self, PartHead, Parts, Shard, Study, WrittenPart, part_in_memory, write_part};
use crate::analysis::sweep::PairDraws;
use crate::analysis::{Answer, Progress};
use crate::error::{Error, Result};
use crate::read::Folder;
use crate::record::shown;
use crate::report::files::Names;
use clap::Args;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::{Path, PathBuf};

/// The studies that are computed in parts. A part states its study in its first line.
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "of", rename_all = "kebab-case")]
pub enum Shared {
    /// The cells of a map.
    Map(Map),
    /// The draws of a Monte Carlo.
    Response(Draws),
    /// The draws of an overlay.
    Compare(PairDraws),
    /// The scenes of the benchmark.
    Precision(Benchmark),
    /// Campaigns.
    Run(Campaigns),
}

impl Shared {
    fn study(&self) -> &dyn Study {
        match self {
            Shared::Map(map) => map,
            Shared::Response(draws) => draws,
            Shared::Compare(draws) => draws,
            Shared::Precision(benchmark) => benchmark,
            Shared::Run(campaigns) => campaigns,
        }
    }

    /// Names of the files in its answer.
    fn names(&self) -> Names {
        match self {
            Shared::Map(_) => map::Keys::FILES,
            Shared::Response(_) => response::Keys::FILES,
            Shared::Compare(_) => Compare::FILES,
            Shared::Precision(_) => Benchmark::FILES,
            Shared::Run(_) => Campaigns::FILES,
        }
    }

    /// The study whose parts have this head; its files are read through `folder`.
    ///
    /// # Errors
    /// If this version knows no such study, or computes it otherwise; if a file cannot be read, or changed.
    fn of(head: &PartHead, folder: &Folder) -> Result<Shared> {
        let unknown = |found: String| Error::usage(found, "parts of this version of vibro");
        let study: Shared = serde_json::from_value(head.study.clone())
            .map_err(|e| unknown(format!("the study of these parts is unknown: {e}")))?;
        if let Shared::Compare(draws) = &study {
            draws.load(folder)?;
        }
        match head.difference(&study.head(head.shard)?) {
            None => Ok(study),
            Some(difference) => Err(unknown(format!("these parts cannot be merged here: {difference}"))),
        }
    }

    /// The head of one of its parts.
    fn head(&self, shard: Shard) -> Result<PartHead> {
        let study = serde_json::to_value(self).map_err(crate::analysis::unwritten)?;
        PartHead::of(study, self.study().cells(), shard)
    }

    /// Computes a part into a folder, prints what was computed, and gives the exit code: 1 if a cell has no
    /// answer.
    ///
    /// # Errors
    /// As [`write_part`]; if there is no folder.
    pub fn printed(&self, shard: Shard, out: Option<&Path>, json: bool) -> Result<u8> {
        let folder = out.ok_or_else(|| {
            Error::usage("a part without a folder", "a folder for the parts").set("out", "parts")
        })?;
        let head = self.head(shard)?;
        let work = |bar: &indicatif::ProgressBar| write_part(folder, self.study(), &head, bar);
        let part = print::busy(json, self.study().what(), work)?;
        let (cells, file) = (head.cells(), head.file());
        let WrittenPart { path, kept, cut, complaints } = part;
        if json {
            let PartHead { shard, fingerprint, .. } = head;
            stdout::object(json!({
                "warnings": [],
                "shard": shard,
                "cells": cells,
                "kept": kept,
                "cut": cut,
                "unanswered": complaints,
                "fingerprint": fingerprint,
                "files": [file],
            }))?;
        } else {
            if kept > 0 {
                complain::line(&format!("{kept} of {cells} cells were there"));
            }
            if cut > 0 {
                complain::line(&format!(
                    "{cut} bytes behind them were damaged or half a cell: computed anew"
                ));
            }
            for said in &complaints {
                complain::line(said);
            }
            stdout::text(&format!("{cells} of {} cells in {}\n", head.all, shown(&path)))?;
        }
        Ok(u8::from(!complaints.is_empty()))
    }

    /// The answer, all cells computed here.
    ///
    /// # Errors
    /// Those of the study.
    pub fn whole(&self, progress: &dyn Progress) -> Result<Answer> {
        study::whole(self.study(), progress)
    }

    /// A part, such as `3/16`, as the bytes of its file.
    ///
    /// # Errors
    /// If there is no such part; as [`part_in_memory`].
    pub fn part(&self, shard: &str, progress: &dyn Progress) -> Result<Vec<u8>> {
        part_in_memory(self.study(), &self.head(shard.parse()?)?, progress)
    }

    /// The answer of parts in memory.
    ///
    /// # Errors
    /// As [`Parts::of_bytes`]; if parts are missing.
    pub fn merged(parts: Vec<Vec<u8>>) -> Result<Answer> {
        let parts = Parts::of_bytes(parts)?;
        Shared::of(&parts.head, &Folder::default())?.study().answer(&mut parts.cells()?)
    }
}

/// Joins parts: the result is that of one run, byte for byte.
#[derive(Debug, Args)]
pub struct Merge {
    /// Folders with the parts
    #[arg(index = 1, required = true)]
    folders: Vec<PathBuf>,
    /// Print which parts are missing or lack cells, as an option of sbatch; exit code 1 if all are there
    missing: bool,
    /// Folder for figures as SVG and PNG, and tables as CSV and NPY
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
}

impl CommandArgs for Merge {
    fn run(&self, json: bool) -> Result<u8> {
        let parts = print::busy(json, "parts", |bar| Parts::of_folders(&self.folders, bar))?;
        if self.missing {
            return missing(&parts, json);
        }
        let folder = Folder::default();
        let mut cells = parts.cells()?;
        let shared = Shared::of(&parts.head, &folder)?;
        let study = shared.study();
        let output = print::results(&folder, self.out.as_deref(), shared.names())?;
        let mut unanswered = false;
        let mut watched = cells.by_ref().inspect(|cell| {
            unanswered |= cell.as_ref().is_ok_and(|cell| study.complaint(cell).is_some());
        });
        let answer = study.answer(&mut watched)?;
        Ok(print::answer(answer, output, json)?.max(u8::from(unanswered)))
    }
}

/// Prints the numbers of the parts that are missing; the exit code is 1 if there are none.
fn missing(parts: &Parts, json: bool) -> Result<u8> {
    let (missing, of) = (parts.missing(), parts.head.shard.of);
    let list = Parts::listed(&missing);
    if json {
        let fingerprint = &parts.head.fingerprint;
        let said = json!({ "warnings": [], "missing": missing, "array": list, "of": of, "fingerprint": fingerprint });
        stdout::object(said)?;
    } else if missing.is_empty() {
        complain::line(&format!("no part of {of} is missing"));
    } else {
        stdout::text(&format!("--array={list}\n"))?;
    }
    Ok(u8::from(missing.is_empty()))
}
