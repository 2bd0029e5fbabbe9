//! Groups of similar files. Up to [`PROBE_FILES`] of a group are analysed first; if their tables agree, the
//! other files get the same tables without an analysis.

use super::folder::FileSeries;
use super::found::FoundTables;
use super::trial::Trial;
use super::workload::share;
use crate::analysis::{AnswerCache, Progress};
use crate::read::{Folder, Header};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Number of files of a group that are analysed first, at even distances; all in a group of no more.
const PROBE_FILES: usize = 8;

/// Most files analysed in a group whose tables do not agree, before the bisection: about 20 s of work with
/// averaged frequency responses.
const BUDGET: usize = 256;

/// Smallest mean number of consecutive files of one kind, a run, for which the first and last file of each
/// run are searched by bisection. In a random mixture of two kinds the mean is two.
const LEAST_MEAN_RUN: usize = 8;

/// The tables of each series, in order, analysed in parallel. A series is first tried as a whole, as a sweep
/// or as drops of one body. Files of the series that are neither are analysed in groups of probably one kind.
pub(super) fn tables_of_each<'a>(
    series: &'a [FileSeries],
    folder: &'a Folder,
    kept: &'a AnswerCache,
    progress: &dyn Progress,
) -> Vec<FoundTables> {
    progress.start("looking at files", series.iter().map(|one| one.files.len()).sum());
    let trial = |one: &'a FileSeries| Trial { folder, reading: &one.reading, kept };
    let as_a_whole = |one: &'a FileSeries| {
        let (trial, probe) = (trial(one), one.part(spread(one.files.len(), PROBE_FILES)));
        probe.files.first().into_iter().for_each(|file| progress.on(file));
        let found = trial.sweep(one, &probe).or_else(|| trial.drops(one, &probe))?;
        one.files.iter().for_each(|_| progress.step());
        Some(found)
    };
    let share = share(series.iter().map(FileSeries::values).max().unwrap_or(0));
    let mut found: Vec<Option<FoundTables>> = series.par_iter().with_min_len(share).map(as_a_whole).collect();
    // Groups of files of probably one kind, each file with the index of its series.
    let mut groups: BTreeMap<String, Vec<(usize, &String)>> = BTreeMap::new();
    for (i, one) in series.iter().enumerate().filter(|(i, _)| found[*i].is_none()) {
        groups.entry(one.kind_key()).or_default().extend(one.files.iter().map(|file| (i, file)));
    }
    // The tables of each series in a group.
    let by_series = |files: &Vec<(usize, &String)>| {
        let values = series[files[0].0].values();
        let (analyses, tables) = analysed((files.len(), self::share(values)), FoundTables::agrees, |k| {
            let (one, file) = (&series[files[k].0], files[k].1);
            let single = FileSeries { files: vec![file.clone()], ..one.clone() };
            progress.on(file);
            let tables = trial(one).file(&single, one.label(file));
            progress.step();
            tables.renamed(one.label(file), [""; 3])
        });
        (analyses..files.len()).for_each(|_| progress.step());
        let (mut tables, of_series) = (tables.into_iter(), files.chunk_by(|(i, _), (j, _)| i == j));
        let gathered = |files: &[(usize, &String)]| {
            let (i, tables) = (files[0].0, tables.by_ref().take(files.len()).collect::<Vec<_>>());
            (i, series[i].gathered(&tables, analyses))
        };
        of_series.map(gathered).collect::<Vec<_>>()
    };
    let groups: Vec<_> = groups.into_values().collect();
    let by_group: Vec<_> = groups.par_iter().with_min_len(share).flat_map_iter(by_series).collect();
    for (i, tables) in by_group {
        found[i] = Some(tables);
    }
    let stated = |(mut found, one): (FoundTables, &FileSeries)| {
        found.tables.iter_mut().for_each(|table| *table = table.stated(&one.reading, one.part));
        found
    };
    found.into_iter().flatten().zip(series).map(stated).collect()
}

/// Indices of at most `most` of `n` files at even distances, with the first and the last file.
pub(super) fn spread(n: usize, most: usize) -> Vec<usize> {
    if n <= most { (0..n).collect() } else { (0..most).map(|k| k * (n - 1) / (most - 1)).collect() }
}

/// Analyses some of `n` files; returns the number of analyses and the result for each file.
///
/// Up to [`PROBE_FILES`] files are analysed first, and up to [`BUDGET`] if the results differ. If files of
/// one kind follow one another in runs, bisection finds the first and last file of each run. A file between
/// two analysed ones with the same result gets this result; in a mixture without runs its result is `None`.
/// The choice of files does not depend on the number of cores.
fn analysed<T: Clone + Send + Sync>(
    (n, share): (usize, usize),
    agree: impl Fn(&T, &T) -> bool,
    trial: impl Fn(usize) -> T + Sync,
) -> (usize, Vec<Option<T>>) {
    let (mut results, mut to_analyse) = (BTreeMap::new(), spread(n, PROBE_FILES));
    loop {
        to_analyse.retain(|k| !results.contains_key(k));
        results
            .extend(to_analyse.par_iter().with_min_len(share).map(|k| (*k, trial(*k))).collect::<Vec<_>>());
        let pairs = results.iter().zip(results.iter().skip(1));
        let changes = pairs.filter(|((_, one), (_, other))| !agree(one, other));
        let changes: Vec<(usize, usize)> = changes.map(|((a, _), (b, _))| (*a, *b)).collect();
        let in_runs = changes.len() * LEAST_MEAN_RUN <= results.len();
        let wide = changes.iter().filter(|(a, b)| in_runs && b - a > 1);
        to_analyse = if !changes.is_empty() && results.len() < n.min(BUDGET) {
            spread(n, BUDGET)
        } else {
            wide.map(|(a, b)| usize::midpoint(*a, *b)).collect()
        };
        if to_analyse.is_empty() {
            // Result of an analysed file, else of its analysed neighbours if these agree.
            let result = |k: usize| {
                let (before, after) = (results.range(..=k).next_back()?.1, results.range(k..).next()?.1);
                ((in_runs || results.contains_key(&k)) && agree(before, after)).then(|| before.clone())
            };
            return (results.len(), (0..n).map(result).collect());
        }
    }
}

impl FileSeries {
    /// The series of the files with these indices.
    pub(super) fn part(&self, places: Vec<usize>) -> FileSeries {
        let pattern = self.pattern.clone().filter(|_| places.len() == self.files.len());
        FileSeries {
            files: places.into_iter().map(|k| self.files[k].clone()).collect(),
            pattern,
            ..self.clone()
        }
    }

    /// Name of a file in tables: its path, or the name of a series that has only this file.
    fn label<'a>(&'a self, file: &'a str) -> &'a str {
        if self.files.len() > 1 { file } else { &self.name }
    }

    /// The tables of the series from the `results` of its files: common tables for more than [`PROBE_FILES`]
    /// files that agree and have a pattern, else the tables of each file. Files without a result are listed
    /// as not tried. `analyses` is the number of analysed files of the group.
    fn gathered(&self, results: &[Option<FoundTables>], analyses: usize) -> FoundTables {
        if let (Some(pattern), [Some(one), more @ ..]) = (&self.pattern, results)
            && results.len() > PROBE_FILES
            && more.iter().all(|other| other.as_ref().is_some_and(|other| other.agrees(one)))
        {
            return one.renamed("", [&self.name, pattern, &self.in_words()]);
        }
        let mut found = FoundTables::default();
        for (file, one) in self.files.iter().zip(results) {
            let tables = one.as_ref().map(|one| one.renamed("", [self.label(file), file, file]));
            found.add(tables.unwrap_or_default());
        }
        let untried: Vec<usize> = (0..results.len()).filter(|k| results[*k].is_none()).collect();
        if !untried.is_empty() {
            let why = format!(
                "{analyses} files like these were tried and are of several kinds; write a table for each kind by hand, as docs/campaign.md shows"
            );
            found.add(FoundTables::left(self.part(untried).in_words(), why));
        }
        found
    }

    /// Files with an equal key are probably of one kind. It states the settings for reading, the name without
    /// digits, the channels with their rates, and the length to within a factor of two.
    fn kind_key(&self) -> String {
        let channel =
            |h: &Header| format!("\n{}|{}|{}|{:?}|{}", h.name, h.unit, h.kind, h.rate, h.n.max(1).ilog2());
        let words = self.files[0].chars().filter(|c| !c.is_ascii_digit());
        let stated = format!("{:?}\n", self.reading.stated());
        stated.chars().chain(words).collect::<String>()
            + &self.headers.iter().map(channel).collect::<String>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Number of analyses for `n` files of these kinds, and the result for each file.
    fn tries(n: usize, kind: impl Fn(usize) -> usize + Sync) -> (usize, Vec<Option<usize>>) {
        let count = AtomicUsize::new(0);
        let counted = |k| {
            count.fetch_add(1, Ordering::Relaxed);
            kind(k)
        };
        let (tries, known) = analysed((n, 1), |a, b| a == b, counted);
        assert_eq!(tries, count.into_inner());
        (tries, known)
    }

    #[test]
    fn work_grows_with_the_kinds_of_files_and_not_with_their_number() {
        for n in [PROBE_FILES, PROBE_FILES + 1, 250, 5000, 100_000] {
            assert_eq!(tries(n, |_| 0), (PROBE_FILES, vec![Some(0); n]), "{n}");
        }
        // All files of a mixture are analysed, or the budget is spent and the others stay unknown.
        let mixed = |k: usize| (k * k) % 7 % 2;
        for n in [2, PROBE_FILES, BUDGET] {
            assert_eq!(tries(n, mixed), (n, (0..n).map(|k| Some(mixed(k))).collect()));
        }
        let (n, known) = tries(5000, mixed);
        assert!(n <= PROBE_FILES + BUDGET && known.iter().flatten().count() == n, "{n}");
    }

    #[test]
    fn a_change_is_found_at_its_place() {
        for at in [1, 7, 249, 2500, 4999] {
            let kind = |k| usize::from(k >= at);
            let (n, known) = tries(5000, kind);
            // Bisecting 5000/255 files takes five steps.
            assert!(
                n <= PROBE_FILES + BUDGET + 5
                    && known == (0..5000).map(|k| Some(kind(k))).collect::<Vec<_>>(),
                "{at}: {n}"
            );
        }
    }
}
