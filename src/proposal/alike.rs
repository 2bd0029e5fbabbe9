//! Groups of similar files: a few are analysed, and represent the others where they agree.

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

/// Number of files analysed in a group that does not agree: 20 s of work with averaged frequency responses.
const MOST: usize = 256;

/// Least mean run length of files of one kind; a random mixture of two kinds has a mean of two.
const IN_A_ROW: usize = 8;

/// The tables of each series, in order. Series and their files are analysed in parallel.
pub(super) fn all<'a>(
    series: &'a [FileSeries],
    folder: &'a Folder,
    kept: &'a AnswerCache,
    progress: &dyn Progress,
) -> Vec<FoundTables> {
    progress.start("looking at files", series.iter().map(|one| one.files.len()).sum());
    let trial = |one: &'a FileSeries| Trial { folder, reading: &one.reading, kept };
    let together = |one: &'a FileSeries| {
        let (trial, few) = (trial(one), one.part(spread(one.files.len(), FEW)));
        let found = trial.sweep(one, &few).or_else(|| trial.drops(one, &few))?;
        one.files.iter().for_each(|_| progress.step());
        Some(found)
    };
    let share = share(series.iter().map(FileSeries::values).max().unwrap_or(0));
    let mut found: Vec<Option<FoundTables>> = series.par_iter().with_min_len(share).map(together).collect();
    let mut kin: BTreeMap<String, Vec<(usize, &String)>> = BTreeMap::new();
    for (i, one) in series.iter().enumerate().filter(|(i, _)| found[*i].is_none()) {
        kin.entry(one.kin()).or_default().extend(one.files.iter().map(|file| (i, file)));
    }
    let each = |files: &Vec<(usize, &String)>| {
        let values = series[files[0].0].values();
        let (tries, own) = tried((files.len(), self::share(values)), FoundTables::agrees, |k| {
            let (one, file) = (&series[files[k].0], files[k].1);
            let alone = FileSeries { files: vec![file.clone()], ..one.clone() };
            let found = trial(one).file(&alone, one.label(file));
            progress.step();
            found.renamed(one.label(file), [""; 3])
        });
        (tries..files.len()).for_each(|_| progress.step());
        let (mut own, of_series) = (own.into_iter(), files.chunk_by(|(i, _), (j, _)| i == j));
        let gathered = |files: &[(usize, &String)]| {
            let (i, own) = (files[0].0, own.by_ref().take(files.len()).collect::<Vec<_>>());
            (i, series[i].gathered(&own, tries))
        };
        of_series.map(gathered).collect::<Vec<_>>()
    };
    let kin: Vec<_> = kin.into_values().collect();
    let tried: Vec<_> = kin.par_iter().with_min_len(share).flat_map_iter(each).collect();
    for (i, one) in tried {
        found[i] = Some(one);
    }
    let stated = |(mut found, one): (FoundTables, &FileSeries)| {
        found.tables.iter_mut().for_each(|table| *table = table.stated(&one.reading));
        found
    };
    found.into_iter().flatten().zip(series).map(stated).collect()
}

/// At most `few` of `n` files, at even distances.
pub(super) fn spread(n: usize, few: usize) -> Vec<usize> {
    if n <= few { (0..n).collect() } else { (0..few).map(|k| k * (n - 1) / (few - 1)).collect() }
}

/// Analyses a few of `n` files. Where they do not agree it analyses more; where kinds occur in runs, it
/// finds their ends by bisection. Files between two that agree are taken as alike; in a mixture they stay
/// unknown. Gives the number of analyses, too. The choice does not depend on the number of cores.
fn tried<T: Clone + Send + Sync>(
    (n, share): (usize, usize),
    agree: impl Fn(&T, &T) -> bool,
    trial: impl Fn(usize) -> T + Sync,
) -> (usize, Vec<Option<T>>) {
    let (mut known, mut next) = (BTreeMap::new(), spread(n, FEW));
    loop {
        next.retain(|k| !known.contains_key(k));
        known.extend(next.par_iter().with_min_len(share).map(|k| (*k, trial(*k))).collect::<Vec<_>>());
        let pairs = known.iter().zip(known.iter().skip(1));
        let differ = pairs.filter(|((_, one), (_, other))| !agree(one, other));
        let differ: Vec<(usize, usize)> = differ.map(|((a, _), (b, _))| (*a, *b)).collect();
        let rows = differ.len() * IN_A_ROW <= known.len();
        let apart = differ.iter().filter(|(a, b)| rows && b - a > 1);
        next = if !differ.is_empty() && known.len() < n.min(MOST) {
            spread(n, MOST)
        } else {
            apart.map(|(a, b)| usize::midpoint(*a, *b)).collect()
        };
        if next.is_empty() {
            let nearest = |k: usize| {
                let (below, above) = (known.range(..=k).next_back()?.1, known.range(k..).next()?.1);
                ((rows || known.contains_key(&k)) && agree(below, above)).then(|| below.clone())
            };
            return (known.len(), (0..n).map(nearest).collect());
        }
    }
}

impl FileSeries {
    /// A series of some of its files, by index.
    pub(super) fn part(&self, places: Vec<usize>) -> FileSeries {
        let pattern = self.pattern.clone().filter(|_| places.len() == self.files.len());
        FileSeries {
            files: places.into_iter().map(|k| self.files[k].clone()).collect(),
            pattern,
            ..self.clone()
        }
    }

    /// The name of a file in tables.
    fn label<'a>(&'a self, file: &'a str) -> &'a str {
        if self.files.len() > 1 { file } else { &self.name }
    }

    /// The tables of all its files; each file was analysed, is like its neighbours, or is named as not
    /// tried.
    fn gathered(&self, own: &[Option<FoundTables>], tries: usize) -> FoundTables {
        if let (Some(pattern), [Some(one), more @ ..]) = (&self.pattern, own)
            && own.len() > FEW
            && more.iter().all(|other| other.as_ref().is_some_and(|other| other.agrees(one)))
        {
            return one.renamed("", [&self.name, pattern, &self.in_words()]);
        }
        let mut found = FoundTables::default();
        for (file, one) in self.files.iter().zip(own) {
            let own = one.as_ref().map(|one| one.renamed("", [self.label(file), file, file]));
            found.add(own.unwrap_or_default());
        }
        let untried: Vec<usize> = (0..own.len()).filter(|k| own[*k].is_none()).collect();
        if !untried.is_empty() {
            let why = format!(
                "{tries} files like these were tried and are of several kinds; write a table for each kind by hand, as docs/campaign.md shows"
            );
            found.add(FoundTables::left(self.part(untried).in_words(), why));
        }
        found
    }

    /// Key of files that are probably of one kind: names without numbers, channels, and approximate length.
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
        let (tries, known) = tried((n, 1), |a, b| a == b, counted);
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
        for n in [2, FEW, MOST] {
            assert_eq!(tries(n, mixed), (n, (0..n).map(|k| Some(mixed(k))).collect()));
        }
        let (n, known) = tries(5000, mixed);
        assert!(n <= FEW + MOST && known.iter().flatten().count() == n, "{n}");
    }

    #[test]
    fn a_change_is_found_at_its_place() {
        for at in [1, 7, 249, 2500, 4999] {
            let kind = |k| usize::from(k >= at);
            let (n, known) = tries(5000, kind);
            // Bisecting 5000/255 files takes five steps.
            assert!(
                n <= FEW + MOST + 5 && known == (0..5000).map(|k| Some(kind(k))).collect::<Vec<_>>(),
                "{at}: {n}"
            );
        }
    }
}
