//! `vibro response`, `vibro waterfall`, `vibro excitation`: the work of the thesis' scripts sinesw3, sinesw
//! and sineswpf.

use super::question::{Asked, Question};
use super::{init, print};
use crate::analysis::AnswerCache;
use crate::analysis::sweep::{Files, Listed, StoredResponseKeys, figures, named, tables};
use crate::analysis::{self, Answer, in_order, is_pattern, matching};
use crate::campaign::Reading;
use crate::error::{Error, Result};
use crate::measure::response::{ResponseOptions, ResponsePoint};
use crate::measure::waterfall::{Waterfall, waterfall};
use crate::measure::{Estimate, excitation, legacy};
use crate::proposal::{Proposal, more_steps, of_steps};
use crate::read::{Folder, Owner, SweepList, SweepReader, plain};
use crate::record::kind::whole;
use crate::record::{Finding, Sweep, SweepPoint, shown};
use crate::report::files::Names;
use crate::report::layout::{headed, pair, table};
use crate::report::{Table, files};
use ndarray::Array2;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A stepped-sine sweep, and the settings with which its analyser stored spectra.
#[derive(Debug, clap::Args)]
pub struct SweepSource {
    /// List file, hand-over file, campaign.toml#name, a folder, or time traces: one file a step, or a
    /// pattern
    #[arg(index = 1, value_name = "SWEEP", required = true)]
    paths: Vec<String>,
    /// Repeat the thesis' script with its mistakes
    legacy: bool,
    /// Allow files outside the folder of the list
    allow_outside: bool,
    #[command(flatten)]
    stored: StoredResponseKeys,
    /// Lowest frequency used, in Hz [default: two lines or a quarter of the lowest excitation]
    fmin: Option<f64>,
}

/// How the response amplitude is taken from a spectrum.
#[derive(Debug, clap::Args)]
pub struct ResponseArgs {
    #[command(flatten)]
    sweep: SweepSource,
    /// Integrations in frequency: 1 takes velocity to displacement [default: what takes the stored quantity
    /// to displacement]
    #[arg(value_parser = whole::<i8, -2, 2>)]
    integrate: Option<i8>,
    /// Lines on both sides of the excitation that are searched for the peak
    #[arg(default_value_t = 3, value_parser = whole::<u16, 1, 1000>)]
    peak_lines: u16,
    /// Folder for figures as SVG and PNG, and tables as CSV
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
pub struct WaterfallArgs {
    #[command(flatten)]
    taken: ResponseArgs,
    /// Highest frequency drawn, in Hz [default: the last line to be seen]
    fmax: Option<f64>,
}

#[derive(Debug, clap::Args)]
pub struct ExcitationArgs {
    #[command(flatten)]
    sweep: SweepSource,
    /// Write the two hand-over files of sineswpf, with force and with response names
    #[arg(long, num_args = 2, value_names = ["FORCE", "RESPONSE"])]
    write_lists: Option<Vec<PathBuf>>,
}

/// The finding that the answer repeats a script of the thesis.
pub fn of_script(script: &str) -> Finding {
    Finding::caution("legacy-script").name("script", script)
}

impl SweepSource {
    /// A sweep of time traces: the named files, or those of the named folder.
    fn proposed(&self, folder: &Folder) -> Result<Option<Proposal>> {
        let any = folder.clone().allow_outside(true);
        let typed: Vec<&Path> = self.paths.iter().map(Path::new).collect();
        Ok(match typed.as_slice() {
            [path] if path.is_dir() => {
                let within = folder.at(*path);
                let mut proposal =
                    Proposal::of(&within, &Reading::default(), None, &AnswerCache::default(), &())?;
                proposal.tables.retain(|table| table.section == "sweep");
                proposal.left.clear();
                Some(proposal)
            }
            [one] if !is_pattern(&any, one) => None,
            all => {
                let files: Result<Vec<_>> = all.iter().map(|path| matching(&any, path)).collect();
                let mut files = files?.concat();
                // Sort by number: a shell lists step10 before step2.
                if files.is_sorted() {
                    in_order(&mut files);
                }
                Some(of_steps(&any, &files, &Reading::default())?)
            }
        })
    }

    /// The files of the sweep and their reader.
    fn listed(&self, asked: &Asked<'_>) -> Result<Listed> {
        let Asked { folder, progress } = *asked;
        let SweepPlace { path, name, campaign } = SweepPlace::of(&self.paths[0]);
        let mut listed = if let Some(proposal) = self.proposed(folder)? {
            progress.aside(&mut || init::print_tables(&proposal));
            let mut listed = named(&proposal.campaign()?, None)?;
            if let Files::Traces(steps) = &listed.files {
                listed.findings.extend(more_steps(&folder.clone().allow_outside(true), &steps.files));
            }
            listed
        } else if campaign {
            named(&analysis::open_in(folder, Path::new(path))?, name)?
        } else {
            let files = Files::Spectra(SweepList::from_path(path, folder)?);
            let reader = SweepReader { folder: folder.clone(), ..SweepReader::default() };
            Listed { files, reader, findings: Vec::new() }
        };
        let how = &mut listed.reader;
        if how.name.is_empty() {
            let stem = Path::new(path).file_stem();
            how.name = stem.map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        }
        self.stored.apply(how)?;
        Ok(listed)
    }
}

/// A sweep by its list file, or by a campaign and the sweep's name.
pub struct SweepPlace<'a> {
    pub path: &'a str,
    pub name: Option<&'a str>,
    pub campaign: bool,
}

impl SweepPlace<'_> {
    pub fn of(typed: &str) -> SweepPlace<'_> {
        let is_campaign = |path: &str| path.to_lowercase().ends_with(".toml");
        match typed.rsplit_once('#') {
            Some((path, name)) if is_campaign(path) => SweepPlace { path, name: Some(name), campaign: true },
            _ => SweepPlace { path: typed, name: None, campaign: is_campaign(typed) },
        }
    }
}

impl Question for ResponseArgs {
    fn names(&self) -> Names {
        Names::Numbered(&["response", "receptance", "force"])
    }

    fn out(&self) -> Option<&Path> {
        self.out.as_deref()
    }

    fn allow_outside(&self) -> bool {
        self.sweep.allow_outside
    }

    fn work(&self) -> &'static str {
        "spectra"
    }

    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        let listed = self.sweep.listed(asked)?;
        if self.sweep.legacy {
            return largest_lines(&listed.spectra()?.1);
        }
        let (_, found) = listed.sweep_and_response(&self.options())?;
        let all = std::slice::from_ref(&found);
        let mut answer = Answer::of(&found)?;
        answer.add("", &found.findings);
        figures::responses(&mut answer, &found.name, all);
        answer.csv("response", &tables::response(&found));
        answer.tables = vec![tables::curve(&found), tables::resonances(all), tables::jumps(all)];
        Ok(answer)
    }
}

impl ResponseArgs {
    fn options(&self) -> ResponseOptions {
        ResponseOptions {
            band: usize::from(self.peak_lines),
            integrate: self.integrate,
            fmin: self.sweep.fmin,
        }
    }
}

/// Output of the script sinesw3: frequency and amplitude of the largest line. It had no uncertainty.
fn largest_lines(sweep: &Sweep) -> Result<Answer> {
    let unit = sweep.unit().quantity().symbol();
    let points = legacy::response(sweep)?;
    let rows = points.iter().map(|(excitation, amplitude)| {
        json!({
            "excitation": excitation,
            "frequency": excitation,
            "amplitude": Estimate::new(*amplitude, None, unit, 1, "largest line, as sinesw3"),
            "harmonics": [],
            "subharmonics": [],
            "largest_elsewhere": null,
        })
    });
    let rows = rows.collect::<Vec<Value>>();
    let mut answer = Answer::of(&json!({ "points": rows, "resonances": [], "jumps": [] }))?;
    answer.add("", [of_script("sinesw3")]);
    let columns = [("excitation", "Hz"), ("amplitude", unit)];
    let rows = points.iter().map(|(excitation, amplitude)| [(*excitation).into(), (*amplitude).into()]);
    answer.table("response", rows.fold(headed("Largest lines", &columns), Table::row));
    Ok(answer)
}

impl Question for WaterfallArgs {
    fn names(&self) -> Names {
        Names::Numbered(&["waterfall", "map"])
    }

    fn out(&self) -> Option<&Path> {
        self.taken.out.as_deref()
    }

    fn allow_outside(&self) -> bool {
        self.taken.sweep.allow_outside
    }

    fn work(&self) -> &'static str {
        "spectra"
    }

    /// The matrix of spectra.
    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        let listed = self.taken.sweep.listed(asked)?;
        let matrix = if self.taken.sweep.legacy {
            let (_, sweep) = listed.spectra()?;
            let excitation = legacy::rounded(&legacy::excitation(&sweep)?);
            let rows = legacy::waterfall(&sweep);
            let shape = (excitation.len(), sweep.axis.len());
            Waterfall {
                name: sweep.name.clone(),
                frequency: sweep.axis.values(),
                excitation,
                magnitude: Array2::from_shape_fn(shape, |(i, k)| rows[i][k]),
                quantity: sweep.unit().quantity(),
                unit: sweep.unit().symbol().to_owned(),
                fmin: 0.0,
                findings: vec![of_script("sinesw")],
            }
        } else {
            let options = self.taken.options();
            let (sweep, response) = listed.sweep_and_response(&options)?;
            waterfall(&sweep, &options, &response)
        };
        let rows = matrix.magnitude.rows();
        let mut answer = Answer::of(&json!({
            "frequency": matrix.frequency,
            "excitation": matrix.excitation,
            "magnitude": rows.into_iter().map(|r| r.to_vec()).collect::<Vec<_>>(),
            "unit": matrix.unit,
            "fmin": matrix.fmin,
        }))?;
        answer.add("", &matrix.findings);
        answer.figure("waterfall", figures::waterfall(&matrix, self.fmax)?);
        answer.figure("map", figures::map(&matrix, self.fmax)?);
        answer.files.push(("waterfall.csv".to_owned(), files::matrix_csv(&matrix).into_bytes()));
        let (points, lines) = matrix.magnitude.dim();
        let shape = headed("Waterfall", &[("spectra", ""), ("lines", ""), ("quantity", ""), ("unit", "")]);
        let (quantity, unit) = (matrix.quantity.name(), matrix.unit.as_str());
        answer.tables.push(shape.row([points.into(), lines.into(), quantity.into(), unit.into()]));
        Ok(answer)
    }
}

impl Question for ExcitationArgs {
    fn names(&self) -> Names {
        Names::Named(&[])
    }

    fn out(&self) -> Option<&Path> {
        None
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![SweepPlace::of(&self.sweep.paths[0]).path.into()]
    }

    fn allow_outside(&self) -> bool {
        self.sweep.allow_outside
    }

    fn work(&self) -> &'static str {
        "spectra"
    }

    /// The excitation frequency of each point.
    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        let lists = self.lists(asked.folder)?;
        let listed = self.sweep.listed(asked)?;
        let (points, findings) = if self.sweep.legacy {
            let (_, sweep) = listed.spectra()?;
            let found = legacy::excitation(&sweep)?.into_iter().zip(&sweep.points);
            let point = |(frequency, point): (f64, &SweepPoint)| excitation::Excitation {
                file: point.name(),
                frequency,
                std: None,
                force: None,
                force_std: None,
            };
            (found.map(point).collect(), vec![of_script("sineswpf")])
        } else if let Files::Spectra(_) = listed.files {
            let (_, sweep) = listed.spectra()?;
            (excitation::excitations(&sweep, self.sweep.fmin.unwrap_or(0.0))?, sweep.findings)
        } else {
            let (sweep, found) = listed.sweep_and_response(&ResponseOptions::default())?;
            let point = |(point, step): (&ResponsePoint, &SweepPoint)| excitation::Excitation {
                file: step.name(),
                frequency: point.excitation,
                std: point.excitation_std,
                force: point.force,
                force_std: point.force_std,
            };
            (found.points.iter().zip(&sweep.points).map(point).collect(), found.findings)
        };
        let frequencies: Vec<f64> = points.iter().map(|p| p.frequency).collect();
        let written = self.hand_over(lists, &listed, &frequencies)?;
        let mut answer = Answer::of(&json!({ "points": points, "written": written }))?;
        answer.add("", findings);
        answer.tables.push(table(
            "Excitation",
            &points,
            &[
                ("file", "", &|p| p.file.as_str().into()),
                ("frequency", "Hz", &|p| pair(p.frequency, p.std)),
                ("force", "N", &|p| p.force.map(|force| pair(force, p.force_std)).into()),
            ],
        ));
        Ok(answer)
    }
}

impl ExcitationArgs {
    /// Opens the hand-over files and checks that they can be written.
    fn lists(&self, folder: &Folder) -> Result<Vec<print::File>> {
        let Some([force, response]) = self.write_lists.as_deref() else { return Ok(Vec::new()) };
        if plain(force) == plain(response) {
            let found = format!("the two lists are the same file, {}", shown(force));
            return Err(Error::usage(found, "two files").setting("write_lists"));
        }
        [force, response].map(|path| print::File::of(folder, path, Owner::Recordings)).into_iter().collect()
    }

    /// Writes the hand-over files and returns their paths.
    fn hand_over(&self, files: Vec<print::File>, listed: &Listed, excitation: &[f64]) -> Result<Vec<String>> {
        if files.is_empty() {
            return Ok(Vec::new());
        }
        let (list, _) = listed.spectra()?;
        if list.force.is_empty() {
            let found = "hand-over files of a sweep without force names";
            return Err(Error::usage(found, "a list file with them").setting("write_lists"));
        }
        // Only now is it known which spectra are read; none of them may be replaced.
        files.iter().try_for_each(print::File::expect)?;
        let folder = Path::new(SweepPlace::of(&self.sweep.paths[0]).path).parent().unwrap_or(Path::new(""));
        let write = |(file, names): (print::File, &Vec<PathBuf>)| {
            let names: Vec<_> = names.iter().map(|n| n.strip_prefix(folder).unwrap_or(n)).collect();
            file.write(legacy::hand_over(list.lines, list.base_band, excitation, &names))
        };
        files.into_iter().zip([&list.force, &list.response]).map(write).collect()
    }
}
