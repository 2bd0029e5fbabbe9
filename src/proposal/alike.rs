//! Groups of similar files. A few files of a group are analysed; where their tables agree, they represent
//! the others.

use super::folder::FileSeries;
use super::found::FoundTables;
use super::trial::Trial;
use super::workload::share;
use crate::analysis::{AnswerCache, Progress};
use crate::read::{Folder, Header};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Size up to which every file of a group is analysed; of larger groups this many, at even distances.
const FEW: usize = 8;

/// Most files analysed in a group whose tables do not agree: about 20 s of work with averaged frequency
/// responses.
const BUDGET: usize = 256;

/// Least mean number of consecutive files of one kind for the ends of such runs to be searched; a random
/// mixture of two kinds has a mean of two.
const LEAST_MEAN_RUN: usize = 8;

/// The tables of each series, in order. A series is tried as a whole, as a sweep or as drops; the files of
/// the others are analysed in groups of probably one kind. Series and files are analysed in parallel.
pub(super) fn all<'a>(
    series: &'a [FileSeries],
    folder: &'a Folder,
    kept: &'a AnswerCache,
    progress: &dyn Progress,
) -> Vec<FoundTables> {
    progress.start("looking at files", series.iter().map(|one| one.files.len()).sum());
    let trial = |one: &'a FileSeries| Trial { folder, reading: &one.reading, kept };
    let as_a_whole = |one: &'a FileSeries| {
        let (trial, few) = (trial(one), one.part(spread(one.files.len(), FEW)));
        let found = trial.sweep(one, &few).or_else(|| trial.drops(one, &few))?;
        one.files.iter().for_each(|_| progress.step());
        Some(found)
    };
    let share = share(series.iter().map(FileSeries::values).max().unwrap_or(0));
    let mut found: Vec<Option<FoundTables>> = series.par_iter().with_min_len(share).map(as_a_whole).collect();
    let mut groups: BTreeMap<String, Vec<(usize, &String)>> = BTreeMap::new();
    // Groups of files of probably one kind, each file with the index of its series.
    for (i, one) in series.iter().enumerate().filter(|(i, _)| found[*i].is_none()) {
        groups.entry(one.kin()).or_default().extend(one.files.iter().map(|file| (i, file)));
    }
    // The tables of each series in a group.
    let by_series = |files: &Vec<(usize, &String)>| {
        let values = series[files[0].0].values();
        let (tries, tables) = analysed((files.len(), self::share(values)), FoundTables::agrees, |k| {
            let (one, file) = (&series[files[k].0], files[k].1);
            let alone = FileSeries { files: vec![file.clone()], ..one.clone() };
            let found = trial(one).file(&alone, one.label(file));
            progress.step();
            found.renamed(one.label(file), [""; 3])
        });
        (tries..files.len()).for_each(|_| progress.step());
        let (mut tables, of_series) = (tables.into_iter(), files.chunk_by(|(i, _), (j, _)| i == j));
        let gathered = |files: &[(usize, &String)]| {
            let (i, tables) = (files[0].0, tables.by_ref().take(files.len()).collect::<Vec<_>>());
            (i, series[i].gathered(&tables, tries))
        };
        of_series.map(gathered).collect::<Vec<_>>()
    };
    let groups: Vec<_> = groups.into_values().collect();
    let by_group: Vec<_> = groups.par_iter().with_min_len(share).flat_map_iter(by_series).collect();
    for (i, tables) in by_group {
        found[i] = Some(tables);
    }
    let stated = |(mut found, one): (FoundTables, &FileSeries)| {
        found.tables.iter_mut().for_each(|table| *table = table.stated(&one.reading));
        found
    };
    found.into_iter().flatten().zip(series).map(stated).collect()
}

/// Indices of at most `few` of `n` files, at even distances, the first and the last among them.
pub(super) fn spread(n: usize, few: usize) -> Vec<usize> {
    if n <= few { (0..n).collect() } else { (0..few).map(|k| k * (n - 1) / (few - 1)).collect() }
}

/// Analyses some of `n` files, and returns the number of analyses and the result for each file.
///
/// A few files are analysed first, and up to [`BUDGET`] if these do not agree. Where files of one kind
/// follow one another in runs, bisection finds the ends of the runs. A file between two that agree gets
/// their result; in a mixture it stays `None`. The choice of files does not depend on the number of cores.
fn analysed<T: Clone + Send + Sync>(
    (n, share): (usize, usize),
    agree: impl Fn(&T, &T) -> bool,
    trial: impl Fn(usize) -> T + Sync,
) -> (usize, Vec<Option<T>>) {
    let (mut results, mut next) = (BTreeMap::new(), spread(n, FEW));
    loop {
        next.retain(|k| !results.contains_key(k));
        results.extend(next.par_iter().with_min_len(share).map(|k| (*k, trial(*k))).collect::<Vec<_>>());
        let pairs = results.iter().zip(results.iter().skip(1));
        let changes = pairs.filter(|((_, one), (_, other))| !agree(one, other));
        let changes: Vec<(usize, usize)> = changes.map(|((a, _), (b, _))| (*a, *b)).collect();
        let in_runs = changes.len() * LEAST_MEAN_RUN <= results.len();
        let ends = changes.iter().filter(|(a, b)| in_runs && b - a > 1);
        next = if !changes.is_empty() && results.len() < n.min(BUDGET) {
            spread(n, BUDGET)
        } else {
            ends.map(|(a, b)| usize::midpoint(*a, *b)).collect()
        };
        if next.is_empty() {
            // The result of a file: its own, or that of its analysed neighbours if these agree.
            let result = |k: usize| {
                let (below, above) = (results.range(..=k).next_back()?.1, results.range(k..).next()?.1);
                ((in_runs || results.contains_key(&k)) && agree(below, above)).then(|| below.clone())
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

    /// The name of a file in tables: the file, or the name of the series where it has only one.
    fn label<'a>(&'a self, file: &'a str) -> &'a str {
        if self.files.len() > 1 { file } else { &self.name }
    }

    /// The tables of all its files, from those of each: one table for a series whose files agree, else one
    /// a file. Files without a result are named as not tried.
    fn gathered(&self, results: &[Option<FoundTables>], tries: usize) -> FoundTables {
        if let (Some(pattern), [Some(one), more @ ..]) = (&self.pattern, results)
            && results.len() > FEW
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
                "{tries} files like these were tried and are of several kinds; write a table for each kind by hand, as docs/campaign.md shows"
            );
            found.add(FoundTables::left(self.part(untried).in_words(), why));
        }
        found
    }

    /// Key of files that are probably of one kind: settings for reading, name without digits, channels with
    /// their rates, and length to within a factor of two.
    fn kin(&self) -> String {
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

    /// Number of analyses for `n` files of these kinds, and what is then known of each.
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
        for n in [FEW, FEW + 1, 250, 5000, 100_000] {
            assert_eq!(tries(n, |_| 0), (FEW, vec![Some(0); n]), "{n}");
        }
        // All files of a mixture are analysed, or the budget is spent and the others stay unknown.
        let mixed = |k: usize| (k * k) % 7 % 2;
        for n in [2, FEW, BUDGET] {
            assert_eq!(tries(n, mixed), (n, (0..n).map(|k| Some(mixed(k))).collect()));
        }
        let (n, known) = tries(5000, mixed);
        assert!(n <= FEW + BUDGET && known.iter().flatten().count() == n, "{n}");
    }

    #[test]
    fn a_change_is_found_at_its_place() {
        for at in [1, 7, 249, 2500, 4999] {
            let kind = |k| usize::from(k >= at);
            let (n, known) = tries(5000, kind);
            // Bisecting 5000/255 files takes five steps.
            assert!(
                n <= FEW + BUDGET + 5 && known == (0..5000).map(|k| Some(kind(k))).collect::<Vec<_>>(),
                "{at}: {n}"
            );
        }
    }
}
