//! `vibro demo` and `vibro open`: an example with its recordings, and the page of a report.

use super::campaign::Run;
use super::print::folder_of;
use super::{complain, print, stdout};
use crate::analysis;
use crate::error::{Error, Place, Result};
use crate::proposal::Proposal;
use crate::read::Owner;
use crate::record::{nearest, shown, typed};
use crate::report::Output;
use serde_json::json;
use std::collections::btree_map::{BTreeMap, Entry};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use vibro_demo::{DEMOS, Demo as Example};

#[derive(Debug, clap::Args)]
pub struct Demo {
    /// Name of the example [default: lists them]
    #[arg(index = 1)]
    name: Option<String>,
    /// Folder for it [default: its name]
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write its files without running it
    no_run: bool,
}

#[derive(Debug, clap::Args)]
pub struct Open {
    /// Folder with a report, folder of its campaign, or report.html itself
    #[arg(index = 1, default_value = ".")]
    report: PathBuf,
}

impl super::CommandArgs for Demo {
    /// Writes the files of an example and runs it.
    fn run(&self, json: bool) -> Result<u8> {
        let Some(name) = &self.name else {
            let all: Vec<_> =
                DEMOS.iter().map(|demo| json!({ "name": demo.name, "about": demo.about })).collect();
            let lines: Vec<String> =
                DEMOS.iter().map(|demo| format!("  {:14} {}", demo.name, demo.about)).collect();
            if json {
                stdout::object(json!({ "demos": all, "warnings": [], "findings": [] }))?;
            } else {
                stdout::text(&format!("{}\nnext: vibro demo {}\n", lines.join("\n"), DEMOS[0].name))?;
            }
            return Ok(0);
        };
        let (demo, folder) = chosen(name, self.out.clone())?;
        print::busy(json, "making recordings", |_| write(demo, &folder))?;
        if self.no_run {
            let written = folder.display().to_string();
            if json {
                stdout::object(json!({ "written": written, "warnings": [], "findings": [] }))?;
            } else {
                stdout::text(&format!("wrote {written}\n"))?;
            }
            return Ok(0);
        }
        complain::line(&format!("wrote the recordings and campaign.toml into {}", shown(&folder)));
        Run::of(folder.join(Proposal::FILE)).run(json)
    }
}

/// The example of this name, and the folder for it.
fn chosen(name: &str, out: Option<PathBuf>) -> Result<(&'static Example, PathBuf)> {
    let demo = DEMOS.iter().find(|demo| demo.name == name).ok_or_else(|| {
        let known: Vec<&str> = DEMOS.iter().map(|demo| demo.name).collect();
        let near = nearest(name, known.iter().copied()).unwrap_or(DEMOS[0].name);
        let error = Error::usage(format!("no example is named {name:?}"), known.join(", "));
        error.hint(format!("vibro demo {near}"))
    })?;
    Ok((demo, out.unwrap_or_else(|| PathBuf::from(demo.name))))
}

/// Writes the example of this name with its recordings, and returns its folder.
///
/// # Errors
/// If there is no such example, or a file of it exists with other content.
pub fn written(name: &str, out: Option<PathBuf>) -> Result<PathBuf> {
    let (demo, folder) = chosen(name, out)?;
    write(demo, &folder).map(|()| folder)
}

/// Writes the files of an example, all or none. A file that exists with other content is kept and named in
/// the error.
fn write(demo: &Example, folder: &Path) -> Result<()> {
    let mut outputs: BTreeMap<PathBuf, Output> = BTreeMap::new();
    let elsewhere = format!("--out {}", typed(print::unused(folder)));
    demo.make(&mut |name, bytes| {
        let path = folder.join(name);
        let parent = folder_of(&path);
        let output = match outputs.entry(parent.to_owned()) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                new.insert(print::output(parent.into(), Owner::Recordings, elsewhere.clone())?)
            }
        };
        let name = path.file_name().map_or_else(String::new, shown);
        output.expect_bytes(&name, bytes)?;
        output.write(&name, bytes)
    })?;
    outputs.into_values().try_for_each(|output| output.commit().map(drop))
}

/// Programs that open a web page, on Linux, macOS and Windows.
const OPENERS: [&str; 3] = ["xdg-open", "open", "explorer"];

impl super::CommandArgs for Open {
    /// Opens the page in a browser.
    fn run(&self, json: bool) -> Result<u8> {
        let campaign = analysis::open(self.report.join(Proposal::FILE));
        let stated = campaign.map_or_else(|_| self.report.join("results"), |campaign| campaign.out());
        let places = [self.report.clone(), self.report.join(analysis::REPORT), stated.join(analysis::REPORT)];
        let is_page =
            |place: &&PathBuf| place.is_file() && place.extension().is_some_and(|ending| ending == "html");
        let page = places.iter().find(is_page).ok_or_else(|| {
            let shown = shown(&self.report);
            if !self.report.exists() {
                return Error::absent(format!("there is no {shown}"), Path::new(""), &self.report);
            }
            let found = "no report.html here, nor in results";
            let error = Error::input(Place::file(&self.report), found, "a folder with a report");
            error.hint(format!("vibro run {shown}"))
        })?;
        let opens = |program: &&str| {
            let quiet = Stdio::null;
            let status =
                Command::new(program).arg(page).stdin(quiet()).stdout(quiet()).stderr(quiet()).status();
            status.is_ok_and(|status| status.success())
        };
        if !OPENERS.iter().any(opens) {
            return Err(Error::refused("no program opens a page here")
                .hint(format!("open {} in a browser", shown(page))));
        }
        if json {
            stdout::object(json!({ "opened": page.display().to_string(), "warnings": [], "findings": [] }))?;
        }
        Ok(0)
    }
}
