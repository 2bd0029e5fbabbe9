//! Tables of one kind of record in a campaign, such as all of `[[impacts]]`.

use super::kind::{Analysis, name_of};
use super::recordings::{is_pattern, matching};
use crate::campaign::{Campaign, Entry, Fault};
use crate::error::{Error, Result};
use crate::record::shown;
use std::collections::BTreeSet;
use std::path::PathBuf;

/// All tables of a kind of record, each with the result of its check. A table with a pattern gives one table
/// for each matching file.
fn expanded<A: Analysis>(campaign: &Campaign) -> Result<Vec<(Entry<A>, Result<()>)>> {
    let folder = campaign.within();
    let expand = |(entry, checked): (Entry<A>, Result<()>)| {
        let pattern = entry.file.clone().filter(|file| checked.is_ok() && is_pattern(folder, file));
        let Some(pattern) = pattern else { return vec![(entry, checked)] };
        let files = match matching(folder, &pattern) {
            Ok(files) => files,
            Err(error) => {
                let error = campaign.fault(&entry, error.setting("file"));
                return vec![(entry, Err(error))];
            }
        };
        let entry_of_file = |file: PathBuf| {
            let entry_name = |name: &String| {
                if A::TOGETHER { name.clone() } else { format!("{name}, {}", shown(&file)) }
            };
            let mut one = entry.clone();
            one.name = entry.name.as_ref().map(entry_name);
            one.file = Some(file);
            (one, Ok(()))
        };
        files.into_iter().map(entry_of_file).collect()
    };
    Ok(campaign.entries(A::SECTION, A::OF_FILES, A::RANGES)?.into_iter().flat_map(expand).collect())
}

/// The faultless tables of a kind of record. A table with a pattern gives one table for each matching
/// file.
///
/// # Errors
/// As [`Campaign::entries`].
pub(crate) fn entries<A: Analysis>(campaign: &Campaign) -> Result<Vec<Entry<A>>> {
    let faults: BTreeSet<_> = campaign.faults().iter().map(|fault| &fault.place).collect();
    let all = expanded::<A>(campaign)?.into_iter().map(|(entry, _)| entry);
    Ok(all.filter(|entry| !faults.contains(&entry.place())).collect())
}

/// As [`entries`], but no table may have a fault.
///
/// # Errors
/// The error of the first table with a fault.
pub(crate) fn all_entries<A: Analysis>(campaign: &Campaign) -> Result<Vec<Entry<A>>> {
    check::<A>(campaign)?.into_iter().next().map_or(Ok(()), |fault| Err(fault.error))?;
    entries(campaign)
}

/// The faults in the tables of a kind of record.
///
/// # Errors
/// As [`Campaign::entries`].
pub(crate) fn check<A: Analysis>(campaign: &Campaign) -> Result<Vec<Fault>> {
    let (mut usable, mut faults): (Vec<Entry<A>>, Vec<Fault>) = (Vec::new(), Vec::new());
    for (entry, checked) in expanded::<A>(campaign)? {
        let reading_key = entry.reads().filter(|_| A::OF_FILES && entry.file.is_none());
        let without =
            |key| Error::usage(format!("{key} without a file"), "file, too, or leave it out").setting(key);
        let checked = checked.and_then(|()| match reading_key {
            Some(key) => Err(campaign.fault(&entry, without(key))),
            None => (entry.reading.reader().and_then(|_| A::check(&entry, &usable)))
                .map_err(|e| campaign.fault(&entry, e)),
        });
        match checked {
            Ok(()) => usable.push(entry),
            Err(error) => {
                let (section, name, place) = (A::SECTION, name_of(&entry), entry.place());
                faults.push(Fault { section, name, place, error });
            }
        }
    }
    Ok(faults)
}
