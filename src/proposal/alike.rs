//! Files that are alike: a few are tried, and stand for the others where they agree.

use super::folder::Series;
use super::found::Found;
use super::trial::Trial;
use crate::analysis::{Kept, Progress};
use crate::campaign::Reading;
use crate::read::{Folder, Header};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Channels of a file that are tried.
pub(super) const CHANNELS: usize = 8;

/// Files that are tried each. Of more that are alike so many are, at even distances.
const FEW: usize = 8;

/// Files that are tried of those that are alike and do not agree: 20 s of work with functions of noise.
const MOST: usize = 256;

/// Files of one kind in a row, at least, on average: in a mixture of two kinds by chance there are two.
const IN_A_ROW: usize = 8;

/// Values that are tried side by side at most, 80 bytes each in memory: larger files are tried one after the other.
const TOGETHER: usize = 1 << 25;

/// How many files of so many values one core tries before another begins.
pub(super) fn share(values: usize) -> usize {
    if values.saturating_mul(rayon::current_num_threads()) > TOGETHER { usize::MAX } else { 1 }
}

/// What each series is, in order. Series are tried side by side, and so are their files.
pub(super) fn all(
    series: &[Series],
    (folder, reading): (&Folder, &Reading),
    kept: &Kept,
    progress: &dyn Progress,
) -> Vec<Found> {
    progress.start("looking at files", series.iter().map(|one| one.files.len()).sum());
    let untimed = reading.untimed();
    let trial = |one: &Series| Trial { folder, reading: if one.timed { &untimed } else { reading }, kept };
    let together = |one: &Series| {
        let (trial, few) = (trial(one), one.part(spread(one.files.len(), FEW)));
        let found = trial.sweep(one, &few).or_else(|| trial.drops(one, &few))?;
        one.files.iter().for_each(|_| progress.step());
        Some(found)
    };
    let share = share(series.iter().map(Series::values).max().unwrap_or(0));
    let mut found: Vec<Option<Found>> = series.par_iter().with_min_len(share).map(together).collect();
    let mut kin: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (i, one) in series.iter().enumerate().filter(|(i, _)| found[*i].is_none()) {
        kin.entry(one.kin()).or_default().push(i);
    }
    let each = |at: &Vec<usize>| {
        let of: Vec<&Series> = at.iter().map(|i| &series[*i]).collect();
        each(&of, trial(of[0]), progress)
    };
    let at: Vec<Vec<usize>> = kin.into_values().collect();
    let tried: Vec<Vec<Found>> = at.par_iter().with_min_len(share).map(each).collect();
    at.iter().flatten().zip(tried.into_iter().flatten()).for_each(|(i, one)| found[*i] = Some(one));
    let stated = |(mut found, one): (Found, &Series)| {
        found.tables.iter_mut().for_each(|table| *table = table.stated(trial(one).reading));
        found
    };
    found.into_iter().flatten().zip(series).map(stated).collect()
}

/// What series are whose files are alike.
fn each(all: &[&Series], trial: Trial<'_>, progress: &dyn Progress) -> Vec<Found> {
    let files: Vec<(&Series, &String)> =
        all.iter().flat_map(|series| series.files.iter().map(|file| (*series, file))).collect();
    let name = |k: usize| if files[k].0.files.len() > 1 { files[k].1 } else { &files[k].0.name };
    let (known, rows) = tried((files.len(), share(all[0].values())), Found::agrees, |k| {
        let (series, file) = files[k];
        let found = trial.file(&Series { files: vec![file.clone()], ..series.clone() }, name(k));
        progress.step();
        found.renamed(name(k), [""; 3])
    });
    (known.len()..files.len()).for_each(|_| progress.step());
    let nearest = |k: usize| {
        let (below, above) = (known.range(..=k).next_back()?.1, known.range(k..).next()?.1);
        ((rows || known.contains_key(&k)) && below.agrees(above)).then_some(below)
    };
    let mut first = 0;
    let of_series = |series: &&Series| {
        let own: Vec<(usize, Option<&Found>)> =
            (first..first + series.files.len()).map(|k| (k, nearest(k))).collect();
        first += own.len();
        let same = |one: &Found| own.iter().all(|(_, other)| other.is_some_and(|other| other.agrees(one)));
        if let (Some(pattern), Some(one)) = (&series.pattern, own[0].1)
            && own.len() > FEW
            && same(one)
        {
            return one.renamed("", [&series.name, pattern, &series.in_words()]);
        }
        let mut found = Found::default();
        for (k, one) in &own {
            let file = files[*k].1;
            found.add(one.map(|one| one.renamed("", [name(*k), file, file])).unwrap_or_default());
        }
        let untried: Vec<usize> = (0..own.len()).filter(|k| own[*k].1.is_none()).collect();
        if !untried.is_empty() {
            let why = format!(
                "{} files like these were tried and are of several kinds; write a table for each kind by hand, as docs/campaign.md shows",
                known.len()
            );
            found.add(Found::left(series.part(untried).in_words(), why));
        }
        found
    };
    all.iter().map(of_series).collect()
}

/// At most `few` of so many files, at even distances.
fn spread(n: usize, few: usize) -> Vec<usize> {
    if n <= few { (0..n).collect() } else { (0..few).map(|k| k * (n - 1) / (few - 1)).collect() }
}

/// Tries a few of `n` files; where they do not agree many, and where kinds stand in rows, their ends by halving: those between two that agree are
/// then like them. Says whether they are. What it tries does not depend on the number of cores.
fn tried<T: Send + Sync>(
    (n, share): (usize, usize),
    agree: impl Fn(&T, &T) -> bool,
    trial: impl Fn(usize) -> T + Sync,
) -> (BTreeMap<usize, T>, bool) {
    let more = |known: &mut BTreeMap<usize, T>, mut next: Vec<usize>| {
        next.retain(|k| !known.contains_key(k));
        known.extend(next.par_iter().with_min_len(share).map(|k| (*k, trial(*k))).collect::<Vec<_>>());
        let pairs = known.iter().zip(known.iter().skip(1));
        let differ = pairs.filter(|((_, one), (_, other))| !agree(one, other));
        differ.map(|((a, _), (b, _))| (*a, *b)).collect::<Vec<(usize, usize)>>()
    };
    let (mut known, mut rows) = (BTreeMap::new(), true);
    let mut differ = more(&mut known, spread(n, FEW));
    if !differ.is_empty() {
        differ = more(&mut known, spread(n, MOST));
        rows = differ.len() * IN_A_ROW <= known.len();
    }
    let middles = |differ: &[(usize, usize)]| -> Vec<usize> {
        let apart = differ.iter().filter(|(a, b)| rows && b - a > 1);
        apart.map(|(a, b)| usize::midpoint(*a, *b)).collect()
    };
    let mut next = middles(&differ);
    while !next.is_empty() {
        next = middles(&more(&mut known, next));
    }
    (known, rows)
}

impl Series {
    /// Some of its files, by their places.
    fn part(&self, places: Vec<usize>) -> Series {
        let pattern = self.pattern.clone().filter(|_| places.len() == self.files.len());
        Series { files: places.into_iter().map(|k| self.files[k].clone()).collect(), pattern, ..self.clone() }
    }

    /// Values of a file that are tried.
    pub(super) fn values(&self) -> usize {
        self.headers.iter().take(CHANNELS).map(|header| header.n).sum()
    }

    /// What files have in common that are probably of one kind: names but for numbers, channels, and about as many values.
    fn kin(&self) -> String {
        let channel =
            |h: &Header| format!("\n{}|{}|{}|{:?}|{}", h.name, h.unit, h.kind, h.rate, h.n.max(1).ilog2());
        let words = self.files[0].chars().filter(|c| !c.is_ascii_digit());
        let start = if self.timed { "timed\n" } else { "" };
        start.chars().chain(words).collect::<String>() + &self.headers.iter().map(channel).collect::<String>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// How many of `n` files of these kinds are tried, and those that are.
    fn tries(n: usize, kind: impl Fn(usize) -> usize + Sync) -> (usize, BTreeMap<usize, usize>, bool) {
        let count = AtomicUsize::new(0);
        let (known, rows) = tried(
            (n, 1),
            |a, b| a == b,
            |k| {
                count.fetch_add(1, Ordering::Relaxed);
                kind(k)
            },
        );
        (count.into_inner(), known, rows)
    }

    #[test]
    fn work_grows_with_the_kinds_of_files_and_not_with_their_number() {
        assert_eq!(tries(FEW, |_| 0).0, FEW);
        for n in [FEW + 1, 250, 5000, 100_000] {
            assert_eq!(tries(n, |_| 0).0, FEW, "{n}");
        }
        // Of a mixture all are tried, or a budget is spent and nothing is said of the others.
        let mixed = |k: usize| (k * k) % 7 % 2;
        assert_eq!(tries(MOST, mixed).0, MOST);
        let (n, _, rows) = tries(5000, mixed);
        assert!(n <= FEW + MOST && !rows, "{n}");
    }

    #[test]
    fn a_change_is_found_at_its_place() {
        for at in [1, 7, 249, 2500, 4999] {
            let (n, known, rows) = tries(5000, |k| usize::from(k >= at));
            // Halving 5000/255 files takes five steps.
            assert!(rows && n <= FEW + MOST + 5 && known[&(at - 1)] == 0 && known[&at] == 1, "{at}: {n}");
        }
    }
}
