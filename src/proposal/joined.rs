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
use crate::record::{Finding, Record};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Largest relative difference in length between the records of one sweep, each stopped by a person or a
/// timer.
const LENGTH_TOLERANCE: f64 = 0.01;
/// Least share of the strongest sine in the power of the force of a sweep step. A shaker distorts at
/// resonance, but the sine stays the larger part.
const LEAST_SINE_SHARE: f64 = 0.5;
/// Number of files that are read first; they decide whether the others are read.
const FEW: usize = 8;
/// Most drops with unrelated names that are read one by one: each takes an analysis.
const MOST_DROPS: usize = 64;

/// Joins the series that belong together but for their names; the others stay.
pub(super) fn all(series: Vec<FileSeries>, folder: &Folder, kept: &AnswerCache) -> Vec<FileSeries> {
    let mut families: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (i, series) in series.iter().enumerate() {
        families.entry(series.family()).or_default().push(i);
    }
    let sets = |places: &Vec<usize>| {
        let members: Vec<&FileSeries> = places.iter().map(|i| &series[*i]).collect();
        let trial = Trial { folder, reading: &members[0].reading, kept };
        let sets = match members[0].force_and_responses() {
            _ if members.len() < 2 => Vec::new(),
            Some((force, _)) => sweeps(&trial, &members, force),
            None => drops(&trial, &members).into_iter().collect(),
        };
        let in_folder = |(set, joined): (Vec<usize>, FileSeries)| {
            (set.into_iter().map(|k| places[k]).collect::<Vec<_>>(), joined)
        };
        sets.into_iter().map(in_folder).collect::<Vec<_>>()
    };
    let joined: Vec<(Vec<usize>, FileSeries)> = families.values().flat_map(sets).collect();
    let mut all: Vec<Option<FileSeries>> = series.into_iter().map(Some).collect();
    for (places, merged) in joined {
        let first = places[0];
        for place in places {
            all[place] = None;
        }
        all[first] = Some(merged);
    }
    all.into_iter().flatten().collect()
}

/// Sweeps made of several series of steps, each with the indices of its members. Frequencies decide: a
/// series that covers the frequencies of a sweep again is a sweep of its own. One with other frequencies,
/// or with a few files, belongs to the sweep. `force` is the index of the force channel.
fn sweeps(trial: &Trial<'_>, members: &[&FileSeries], force: usize) -> Vec<(Vec<usize>, FileSeries)> {
    let count = |k: usize| members[k].files.len();
    let Some(longest) = (0..members.len()).rev().max_by_key(|k| count(*k)) else { return Vec::new() };
    let samples = |k: usize| members[k].headers[force].n as f64;
    let mut alike: Vec<usize> = (0..members.len())
        .filter(|k| (samples(*k) / samples(longest) - 1.0).abs() <= LENGTH_TOLERANCE)
        .collect();
    alike.sort_by_key(|k| std::cmp::Reverse(count(*k)));
    let files: Vec<&String> = alike.iter().flat_map(|k| &members[*k].files).collect();
    let few: Vec<&String> = spread(files.len(), FEW).into_iter().map(|k| files[k]).collect();
    let tones = |files: &[&String]| trial.frequencies(force, files);
    if files.len() < LEAST_SWEEP_FILES || 2 * tones(&few).iter().flatten().count() < few.len() {
        return Vec::new();
    }
    let frequency: BTreeMap<&String, f64> =
        files.iter().zip(tones(&files)).filter_map(|(file, f)| Some((*file, f?))).collect();
    let frequencies = |k: usize| members[k].files.iter().filter_map(|file| frequency.get(file).copied());
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for k in alike.into_iter().filter(|k| 2 * frequencies(*k).count() >= count(*k)) {
        let repeats = |set: &Vec<usize>| {
            let covered = |f: f64| set.iter().any(|m| frequencies(*m).any(|other| same(f, other)));
            count(k) >= LEAST_SWEEP_FILES && 2 * frequencies(k).filter(|f| covered(*f)).count() > count(k)
        };
        let fits = |set: &Vec<usize>| members[set[0]].way() == members[k].way() && !repeats(set);
        let fitting: Vec<usize> = (0..sets.len()).filter(|i| fits(&sets[*i])).collect();
        match fitting[..] {
            [] => sets.push(vec![k]),
            [only] => sets[only].push(k),
            // A step that could belong to several sweeps is joined to none.
            [..] => {}
        }
    }
    let joined = |set: Vec<usize>| {
        let mut series = FileSeries::of_all(&set.iter().map(|k| members[*k]).collect::<Vec<_>>());
        let at = |file: &String| frequency.get(file).copied().unwrap_or(f64::INFINITY);
        series.files.sort_by(|a, b| at(a).total_cmp(&at(b)));
        if series.way().as_deref() == Some("down") {
            series.files.reverse();
        }
        (set, series)
    };
    let several = sets.into_iter().filter(|set| set.len() > 1).map(joined);
    several.filter(|(_, series)| series.files.len() >= LEAST_SWEEP_FILES).collect()
}

/// A numbered series of drops with the drops under other names that agree with it, and the indices of these
/// members; or drops under unrelated names that all agree. Where two series are numbered, their names keep
/// them apart: `None`.
fn drops(trial: &Trial<'_>, members: &[&FileSeries]) -> Option<(Vec<usize>, FileSeries)> {
    let (several, alone): (Vec<usize>, Vec<usize>) =
        (0..members.len()).partition(|k| members[*k].files.len() > 1);
    let joined = |set: &[usize]| FileSeries::of_all(&set.iter().map(|k| members[*k]).collect::<Vec<_>>());
    let agree = |series: &FileSeries| trial.drops(series, series).is_some();
    let set = match several[..] {
        [base] if alone.len() <= MOST_DROPS => {
            let base_few = members[base].part(spread(members[base].files.len(), FEW));
            agree(&base_few).then_some(())?;
            let agrees_with_base = |k: &usize| {
                let pair = members[base].part(vec![0]);
                agree(&FileSeries::of_all(&[&pair, members[*k]]))
            };
            [base].into_iter().chain(alone.into_iter().filter(agrees_with_base)).collect::<Vec<_>>()
        }
        [] if alone.len() <= MOST_DROPS => agree(&joined(&alone)).then_some(alone)?,
        _ => return None,
    };
    (set.len() > 1).then(|| (set.clone(), joined(&set)))
}

impl Trial<'_> {
    /// Force frequency of each file in Hz, if the force is a sine.
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
    /// Key of files that may form a series whatever their names: folder, settings for reading, columns and
    /// sampling rate.
    fn family(&self) -> String {
        let folder = Path::new(&self.files[0]).parent();
        format!("{folder:?}\n{:?}\n{}", self.reading.stated(), columns(&self.headers))
    }

    /// Direction of a sweep, if the name of its first file has the word `up` or `down`.
    pub(super) fn way(&self) -> Option<String> {
        let name = self.files[0].rsplit('/').next().unwrap_or_default().to_lowercase();
        let mut words = name.split(|c: char| !c.is_alphanumeric());
        words.find(|word| ["up", "down"].contains(word)).map(str::to_owned)
    }

    /// Several series merged into one.
    fn of_all(members: &[&FileSeries]) -> FileSeries {
        let headers = named_alike(&members.iter().map(|one| one.headers.as_slice()).collect::<Vec<_>>());
        let mut files: Vec<PathBuf> = members.iter().flat_map(|one| &one.files).map(PathBuf::from).collect();
        in_order(&mut files);
        let files: Vec<String> = files.iter().map(|file| file.to_string_lossy().into_owned()).collect();
        let longest = members.iter().rev().max_by_key(|one| one.files.len());
        let common = longest.filter(|one| one.files.len() > 1).map(|one| one.name.clone());
        let name = common.unwrap_or_else(|| name(&files));
        FileSeries { name, files, headers, pattern: None, alike: true, reading: members[0].reading.clone() }
    }
}

/// A note on the files beside those of a sweep that look like further steps: they have its channels and a
/// sine as force. `None` without such files.
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
    };
    let (force, _) = series.force_and_responses()?;
    let trial = Trial { folder: &folder, reading: &series.reading, kept: &AnswerCache::default() };
    let tones = |files: &[&String]| trial.frequencies(force, files);
    let few: Vec<&String> = spread(alike.len(), FEW).into_iter().map(|k| &alike[k]).collect();
    tones(&few).iter().flatten().next()?;
    let all: Vec<&String> = alike.iter().collect();
    let more = all.iter().zip(tones(&all)).filter(|(_, f)| f.is_some()).map(|(file, _)| file.as_str());
    let more: Vec<&str> = more.collect();
    Some(Finding::note("sweep-more-steps").count("n", more.len()).name("files", analysis::few(&more)))
}
