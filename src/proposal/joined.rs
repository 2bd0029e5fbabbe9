//! Joins files of one folder that belong together despite their names: steps of one sweep, drops of one
//! series.

use super::alike::spread;
use super::folder::{FileSeries, columns, name, named_alike};
use super::trial::{LEAST_SWEEP_FILES, Trial};
use crate::analysis::sweep::order::same;
use crate::analysis::tone::Strongest;
use crate::analysis::{self, AnswerCache, file_name, in_order};
use crate::campaign::Reading;
use crate::read::{Folder, Header, plain};
use crate::record::{Finding, Record, sort_by_number};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Largest relative difference in number of samples between records of one sweep. A person or a timer stops
/// each of them.
const LENGTH_TOLERANCE: f64 = 0.01;
/// Smallest share of the strongest sine in the power of the force, for a file to count as a sweep step. A
/// shaker distorts at resonance, but the sine stays the larger part.
const LEAST_SINE_SHARE: f64 = 0.5;
/// Number of files probed, at even distances. The rest are read only if these look like steps of one sweep,
/// or drops of one series.
const PROBE_FILES: usize = 8;
/// Most single files with unrelated names that are compared as drops: each takes an analysis.
const MOST_DROPS: usize = 64;

/// Merges series that belong together although their names differ; returns the others unchanged.
pub(super) fn join_all(series: Vec<FileSeries>, folder: &Folder, kept: &AnswerCache) -> Vec<FileSeries> {
    let mut families: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (i, series) in series.iter().enumerate() {
        families.entry(series.family()).or_default().push(i);
    }
    // Merged series of a family, each with the indices of the series in it.
    let merged_in = |family: &Vec<usize>| {
        let members: Vec<&FileSeries> = family.iter().map(|i| &series[*i]).collect();
        let trial = Trial { folder, reading: &members[0].reading, kept };
        let merged = match members[0].force_and_responses() {
            _ if members.len() < 2 => Vec::new(),
            Some((force, _)) => sweeps(&trial, &members, force),
            None => drops(&trial, &members).into_iter().collect(),
        };
        let with_series_indices = |(indices, merged): (Vec<usize>, FileSeries)| {
            (indices.into_iter().map(|k| family[k]).collect::<Vec<_>>(), merged)
        };
        merged.into_iter().map(with_series_indices).collect::<Vec<_>>()
    };
    let merged: Vec<(Vec<usize>, FileSeries)> = families.values().flat_map(merged_in).collect();
    let mut result: Vec<Option<FileSeries>> = series.into_iter().map(Some).collect();
    for (indices, merged) in merged {
        let first = indices[0];
        for i in indices {
            result[i] = None;
        }
        result[first] = Some(merged);
    }
    result.into_iter().flatten().collect()
}

/// Merges series of steps into sweeps; returns each sweep with the indices of its series in `members`.
/// `force` is the index of the force channel.
///
/// Only series whose records are as long as those of the longest series, and whose force is mostly a sine,
/// are considered, those with most files first. A series of [`LEAST_SWEEP_FILES`] or more with most of its
/// frequencies already in a sweep repeats that sweep and begins another one. Any other is added to the only
/// sweep in its direction; if several sweeps could take it, it is added to none.
fn sweeps(trial: &Trial<'_>, members: &[&FileSeries], force: usize) -> Vec<(Vec<usize>, FileSeries)> {
    let count = |k: usize| members[k].files.len();
    let Some(longest) = (0..members.len()).rev().max_by_key(|k| count(*k)) else { return Vec::new() };
    let samples = |k: usize| members[k].headers[force].n as f64;
    let mut same_length: Vec<usize> = (0..members.len())
        .filter(|k| (samples(*k) / samples(longest) - 1.0).abs() <= LENGTH_TOLERANCE)
        .collect();
    same_length.sort_by_key(|k| std::cmp::Reverse(count(*k)));
    let files: Vec<&String> = same_length.iter().flat_map(|k| &members[*k].files).collect();
    let probed: Vec<&String> = spread(files.len(), PROBE_FILES).into_iter().map(|k| files[k]).collect();
    let tones = |files: &[&String]| trial.frequencies(force, files);
    if files.len() < LEAST_SWEEP_FILES || 2 * tones(&probed).iter().flatten().count() < probed.len() {
        return Vec::new();
    }
    let frequency: BTreeMap<&String, f64> =
        files.iter().zip(tones(&files)).filter_map(|(file, f)| Some((*file, f?))).collect();
    let frequencies = |k: usize| members[k].files.iter().filter_map(|file| frequency.get(file).copied());
    let mut sweeps: Vec<Vec<usize>> = Vec::new();
    for k in same_length.into_iter().filter(|k| 2 * frequencies(*k).count() >= count(*k)) {
        let repeats = |sweep: &Vec<usize>| {
            let covered = |f: f64| sweep.iter().any(|m| frequencies(*m).any(|other| same(f, other)));
            count(k) >= LEAST_SWEEP_FILES && 2 * frequencies(k).filter(|f| covered(*f)).count() > count(k)
        };
        let fits =
            |sweep: &Vec<usize>| members[sweep[0]].direction() == members[k].direction() && !repeats(sweep);
        let fitting: Vec<usize> = (0..sweeps.len()).filter(|i| fits(&sweeps[*i])).collect();
        match fitting[..] {
            [] => sweeps.push(vec![k]),
            [only] => sweeps[only].push(k),
            [..] => {}
        }
    }
    let merged = |sweep: Vec<usize>| {
        let mut series = FileSeries::merged(&sweep.iter().map(|k| members[*k]).collect::<Vec<_>>());
        let frequency = |file: &String| frequency.get(file).copied().unwrap_or(f64::INFINITY);
        sort_by_number(&mut series.files, |a| frequency(a));
        if series.direction().as_deref() == Some("down") {
            series.files.reverse();
        }
        (sweep, series)
    };
    let of_several = sweeps.into_iter().filter(|sweep| sweep.len() > 1).map(merged);
    of_several.filter(|(_, series)| series.files.len() >= LEAST_SWEEP_FILES).collect()
}

/// Joins single files of drops to the one numbered series if their restitutions agree ([`Trial::drops`]).
/// Without a numbered series, joins the single files if all agree. Returns the indices of the joined series
/// in `members` and the merged series; `None` with two or more numbered series, whose names separate them.
fn drops(trial: &Trial<'_>, members: &[&FileSeries]) -> Option<(Vec<usize>, FileSeries)> {
    let (numbered, single): (Vec<usize>, Vec<usize>) =
        (0..members.len()).partition(|k| members[*k].files.len() > 1);
    let merged =
        |indices: &[usize]| FileSeries::merged(&indices.iter().map(|k| members[*k]).collect::<Vec<_>>());
    let agree = |series: &FileSeries| trial.drops(series, series).is_some();
    let indices = match numbered[..] {
        [base] if single.len() <= MOST_DROPS => {
            let base_probe = members[base].part(spread(members[base].files.len(), PROBE_FILES));
            agree(&base_probe).then_some(())?;
            let agrees_with_base = |k: &usize| {
                let base_file = members[base].part(vec![0]);
                agree(&FileSeries::merged(&[&base_file, members[*k]]))
            };
            [base].into_iter().chain(single.into_iter().filter(agrees_with_base)).collect::<Vec<_>>()
        }
        [] if single.len() <= MOST_DROPS => agree(&merged(&single)).then_some(single)?,
        _ => return None,
    };
    (indices.len() > 1).then(|| (indices.clone(), merged(&indices)))
}

impl Trial<'_> {
    /// Force frequency of each file in Hz; `None` for a force that is no sine ([`LEAST_SINE_SHARE`]).
    fn frequencies(&self, force: usize, files: &[&String]) -> Vec<Option<f64>> {
        let Ok(reader) = self.reading.reader() else { return vec![None; files.len()] };
        let reader = reader.within(self.folder);
        let frequency = |file: &&String| {
            let recording = reader.from_path(self.folder.root().join(file)).ok()?;
            let Some(Record::Trace(trace)) = recording.records.get(force) else { return None };
            Strongest::of(trace).filter(|tone| tone.share >= LEAST_SINE_SHARE).map(|tone| tone.frequency)
        };
        files.par_iter().map(frequency).collect()
    }
}

impl FileSeries {
    /// Files with an equal key may form a series whatever their names. It states the folder, settings for
    /// reading, columns and sampling rate.
    fn family(&self) -> String {
        let folder = Path::new(&self.files[0]).parent();
        format!("{folder:?}\n{:?}\n{}", self.reading.stated(), columns(&self.headers))
    }

    /// Direction of a sweep, `up` or `down`, if the name of its first file has this word.
    pub(super) fn direction(&self) -> Option<String> {
        let name = self.files[0].rsplit('/').next().unwrap_or_default().to_lowercase();
        let mut words = name.split(|c: char| !c.is_alphanumeric());
        words.find(|word| ["up", "down"].contains(word)).map(str::to_owned)
    }

    /// Merges several series into one. It has the name of the longest, or the common part of the file names
    /// if each has one file.
    fn merged(members: &[&FileSeries]) -> FileSeries {
        let headers = named_alike(&members.iter().map(|one| one.headers.as_slice()).collect::<Vec<_>>());
        let mut files: Vec<PathBuf> = members.iter().flat_map(|one| &one.files).map(PathBuf::from).collect();
        in_order(&mut files);
        let files: Vec<String> = files.iter().map(|file| file.to_string_lossy().into_owned()).collect();
        let longest = members.iter().rev().max_by_key(|one| one.files.len());
        let common = longest.filter(|one| one.files.len() > 1).map(|one| one.name.clone());
        let name = common.unwrap_or_else(|| name(&files));
        let (reading, part) = (members[0].reading.clone(), members[0].part);
        FileSeries { name, files, headers, pattern: None, alike: true, reading, part }
    }
}

/// A note on files in the folder of a sweep, not in its list, that look like further steps: they have its
/// channels and a sine as force. `None` without any of these.
pub fn more_steps(within: &Folder, files: &[PathBuf]) -> Option<Finding> {
    let first = files.first()?;
    let parent = first.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (folder, reading) = (within.at(parent), Reading::default());
    let reader = reading.reader().ok()?.within(&folder);
    let headers = |path: &PathBuf| reader.survey(path).ok().map(|(_, headers, _)| headers);
    let channels: Vec<Header> = headers(first)?;
    let named: BTreeSet<PathBuf> = files.iter().map(|file| plain(file)).collect();
    // Files of a much different size are skipped without opening them.
    let sizes = files.iter().filter_map(|file| Some(folder.stamp(file)?.0));
    let (least, most) = sizes.fold((u64::MAX, 0), |(a, b), size| (a.min(size), b.max(size)));
    let similar_in_size = |path: &PathBuf| {
        let size = folder.stamp(path).map_or(0, |stamp| stamp.0);
        plain(path).parent() == plain(first).parent()
            && !named.contains(&plain(path))
            && (least / 2..=most.saturating_mul(2)).contains(&size)
    };
    let others: Vec<PathBuf> =
        analysis::recordings(&folder).ok()?.files.into_iter().filter(similar_in_size).collect();
    let is_alike = |path: &&PathBuf| headers(path).is_some_and(|other| columns(&other) == columns(&channels));
    let alike: Vec<String> = others.par_iter().filter(is_alike).map(|path| file_name(path)).collect();
    let names = vec![String::new()];
    let series = FileSeries {
        name: String::new(),
        files: names,
        headers: channels,
        pattern: None,
        alike: true,
        reading,
        part: None,
    };
    let (force, _) = series.force_and_responses()?;
    let trial = Trial { folder: &folder, reading: &series.reading, kept: &AnswerCache::default() };
    let tones = |files: &[&String]| trial.frequencies(force, files);
    let probed: Vec<&String> = spread(alike.len(), PROBE_FILES).into_iter().map(|k| &alike[k]).collect();
    tones(&probed).iter().flatten().next()?;
    let all: Vec<&String> = alike.iter().collect();
    let more = all.iter().zip(tones(&all)).filter(|(_, f)| f.is_some()).map(|(file, _)| file.as_str());
    let more: Vec<&str> = more.collect();
    Some(Finding::note("sweep-more-steps").count("n", more.len()).name("files", analysis::few(&more)))
}
