//! Identifies records of unknown kind by trying one analysis after another. The first table with a
//! plausible answer is proposed: one without a doubt about the analysis, and with the evidence of its kind.
//!
//! A key of a proposed table has one of four states ([`KeyStatus`]). *found*: the files state its value.
//! *guessed*: it was inferred, with a reason. *missing*: required, a person must add it. *open*: optional,
//! a person may add it. Three methods of [`Table`] prepare it. *tried* fills in placeholders for missing
//! and open keys, so that the table can run. *stated* adds the settings for reading that the command line
//! states. *surmised* marks the kind of the files, not a key, as a guess.

use super::folder::{FileSeries, short};
use super::found::FoundTables;
use super::workload::{CHANNELS, share};
use super::{KeyStatus, Proposal, Refusal, Table};
use crate::analysis::{self, Answer, AnswerCache, Evidence};
use crate::campaign::Reading;
use crate::measure::restitution::Train;
use crate::read::{Folder, Header};
use crate::record::code::{self, READER_DOUBTS};
use crate::record::{Fact, Finding, Record};
use rayon::prelude::*;
use std::ops::Range;
use std::slice::from_ref;

/// Hint for the missing height of a drop.
const HEIGHT: &str = "height of the fall in m";

/// Longest contact in s; a longer hump is no contact pulse.
const LONGEST_CONTACT: f64 = 0.1;

/// Whether a finding is a doubt about the analysis, and not about how the file is read: that holds for every
/// analysis of the record.
fn doubts_analysis(found: &Finding) -> bool {
    found.is_doubt() && !READER_DOUBTS.contains(&&*found.code)
}

/// Codes of the doubts about a friction-damped decay, whose amplitude falls by a constant step per swing.
const FRICTION_DOUBTS: [&str; 2] = [code::DECAY_UNEXPLAINED, code::DECAY_CHANGES];

/// Least share of the rest of the record that a decay takes from its start. A shorter one may be the
/// ringing after one of several impacts.
const LEAST_DECAY_SHARE: f64 = 0.2;

/// Largest share of the record before a decay that starts at once, as after a release; before a drop there
/// is a longer rest.
const MOST_LEAD_SHARE: f64 = 0.01;

/// Square of the crest factor of a sine: 2, plus an allowance for noise; a square wave has 1.
const SINE_CREST_SQUARED: Range<f64> = 1.8..2.7;

/// Largest coefficient of restitution of a bouncing body. A train with a larger one is the ringing of a
/// structure.
const MOST_RESTITUTION: f64 = 0.99;

/// Largest relative spread of the intervals of a steady train of impacts. Those of footsteps vary by a
/// tenth, those of bounces by a half or more.
const MOST_INTERVAL_SPREAD: f64 = 0.25;

/// Parts of the names of tacho channels, in lower case.
const TACHO_WORDS: [&str; 4] = ["tach", "rpm", "crank", "drehzahl"];

/// Least number of files of a sweep: fewer points show no resonance curve.
pub(super) const LEAST_SWEEP_FILES: usize = 5;

/// Most values of a file that are analysed. Five minutes of eight channels at 51.2 kHz are 123 million:
/// minutes of work and 80 bytes of memory each.
const MOST_VALUES: usize = 1 << 27;

impl From<Option<Finding>> for Refusal {
    fn from(found: Option<Finding>) -> Refusal {
        let fact = |name: &str| match found.as_ref().and_then(|found| found.fact(name)) {
            Some(Fact::Name(text)) => text.clone(),
            _ => String::new(),
        };
        let why = Some(fact("why")).filter(|why| !why.is_empty()).unwrap_or_else(|| "no answer".to_owned());
        Refusal { why, hint: fact("hint"), code: fact("refusal") }
    }
}

/// Makes the table of one kind of analysis for a channel of a series, by its index and a name for it.
type MakeTable = fn(&FileSeries, usize, &str) -> Table;

/// Tries analyses on records.
#[derive(Clone, Copy)]
pub(super) struct Trial<'a> {
    pub folder: &'a Folder,
    pub reading: &'a Reading,
    pub kept: &'a AnswerCache,
}

impl Trial<'_> {
    /// Runs the tables as a campaign, with placeholders for keys that are not stated. Gives their answers,
    /// or the reason why there is none.
    fn answers(&self, tables: &[Table]) -> Result<Answer, Refusal> {
        let path = self.folder.root().join(Proposal::FILE);
        let text: String =
            tables.iter().map(|table| table.stated(self.reading, None).tried().toml(&[])).collect();
        let answered =
            analysis::parse(self.folder, &path, text).and_then(|c| analysis::answers(&c, self.kept, &()));
        answered.map_err(|error| Refusal { why: short(&error), ..Refusal::default() })?.map_err(Refusal::from)
    }

    /// The first table with a plausible answer; the next answering one instead if the first is a decay that
    /// fills little of the record, or a drop whose decay starts at once.
    pub(super) fn first_plausible(&self, tables: &[Table]) -> Option<Table> {
        let with_answer = |table| Some((table, self.plausible_answer(from_ref(table))?));
        let mut plausible = tables.iter().filter_map(with_answer);
        let (first, answer) = plausible.next()?;
        // Only the table of a drop with one rebound lacks a key, its height.
        let is_drop = first.lacks();
        let next = if is_brief_decay(&answer) || is_drop { plausible.next() } else { None };
        // A record at rest before its first impact is a drop; one that decays from its start is not.
        let starts_at_once = |answer: &Answer| lead_share(answer).is_some_and(|lead| lead < MOST_LEAD_SHARE);
        let next = next.filter(|(_, answer)| !is_drop || starts_at_once(answer));
        Some(next.map_or(first, |(table, _)| table).clone())
    }

    /// The first decay table whose only doubts are those of a friction-damped decay.
    fn friction_decay(&self, tables: &[Table]) -> Option<Table> {
        let only_friction_doubts = |answer: &Answer| {
            let allowed = |f: &Finding| !doubts_analysis(f) || FRICTION_DOUBTS.contains(&&*f.code);
            answer.findings.iter().all(|(_, finding)| allowed(finding))
        };
        let is_friction_decay = |table: &&Table| {
            table.section == "decay"
                && self
                    .answers(from_ref(*table))
                    .is_ok_and(|answer| only_friction_doubts(&answer) && !is_brief_decay(&answer))
        };
        tables.iter().find(is_friction_decay).cloned()
    }

    /// The answers of the tables, if they are plausible and no finding is a doubt about the analysis.
    pub(super) fn plausible_answer(&self, tables: &[Table]) -> Option<Answer> {
        let is_plausible = |answer: &Answer| {
            answer.findings.iter().all(|(_, f)| !doubts_analysis(f)) && fits_kind(tables, answer)
        };
        self.answers(tables).ok().filter(is_plausible)
    }

    /// The tables of a sweep, if a series is one: the sweep and the modes of each response without jumps.
    /// Of a long series, the `few` files are analysed first; all are analysed only if those form a sweep.
    pub fn sweep(&self, series: &FileSeries, few: &FileSeries) -> Option<FoundTables> {
        let table = series.sweep().filter(|_| series.files.len() >= LEAST_SWEEP_FILES)?;
        let answer_of = |table: &Table| self.answers(from_ref(table)).ok();
        if few.files.len() < series.files.len() {
            answer_of(&few.sweep()?).filter(|answer| enough_steps_certain(answer, 0.0))?;
        }
        let answer = answer_of(&table).filter(|answer| enough_steps_certain(answer, 0.5))?;
        let (_, responses) = series.force_and_responses().unwrap_or_default();
        let name = |k: usize| match responses.len() {
            1 => series.name.clone(),
            _ => format!("{} {}", series.name, series.channel(k).to_string().trim_matches('"')),
        };
        let jumps = |i: usize| matches!(answer.evidence.get(i), Some(Evidence::Sweep { jumps: true, .. }));
        // A response that jumps has no linear modes.
        let modes = responses.iter().enumerate().filter(|(i, _)| !jumps(*i)).map(|(_, k)| {
            let table = Table::new("frf", "its modes", &series.in_words()).found("sweep", name(*k));
            table.found("name", format!("{}, modes", name(*k)))
        });
        Some(FoundTables { tables: [table].into_iter().chain(modes).collect(), ..FoundTables::default() })
    }

    /// The tables of repeated drops of one body, if a few files of a series are drops that agree.
    pub fn drops(&self, series: &FileSeries, few: &FileSeries) -> Option<FoundTables> {
        if series.files.len() < 2 || series.headers.len() != 1 || series.values() > MOST_VALUES {
            return None;
        }
        let tables = |series: &FileSeries, table: MakeTable| {
            let of_file = |file: &String| {
                table(&FileSeries { files: vec![file.clone()], ..series.clone() }, 0, &series.name)
            };
            match series.pattern {
                Some(_) => vec![table(series, 0, &series.name)],
                None => series.files.iter().map(of_file).collect::<Vec<Table>>(),
            }
        };
        // `alike`: grouped by content, not by name; then every file must have given a drop.
        let every_file_a_drop = |answer: &Answer| {
            let all = |evidence: &Evidence| matches!(evidence, Evidence::Drops { files, .. } if *files == few.files.len());
            !few.alike || answer.evidence.first().is_some_and(all)
        };
        let agree = |table: &MakeTable| {
            self.plausible_answer(&tables(few, *table)).as_ref().is_some_and(every_file_a_drop)
        };
        let table = [FileSeries::bounces as MakeTable, FileSeries::fall].into_iter().find(agree)?;
        Some(FoundTables { tables: tables(series, table), ..FoundTables::default() })
    }

    /// The tables of one file: of a frequency response, of force and responses, of a hammer drill, or else
    /// one for each channel.
    pub fn file(&self, series: &FileSeries, name: &str) -> FoundTables {
        let file = &series.files[0];
        let mut found = FoundTables::default();
        let spectra: Vec<&Header> = series.headers.iter().filter(|h| h.kind != "trace").collect();
        if !spectra.is_empty() {
            if spectra.iter().all(|h| h.kind != "frf") {
                let why = "a spectrum; those of a sweep stand in a list file, or in [[sweep]] as force and response";
                return FoundTables::left(file, why);
            }
            let table = Table::new("frf", "a frequency response function", file);
            return self.with_answer(table.found("name", name).found("file", file));
        }
        if let Some((force, responses)) = series.force_and_responses() {
            for response in responses {
                found.add(self.frequency_response(series, name, [force, response]));
            }
            return found;
        }
        if let Some(blows) = self.repeated_blows(series, name) {
            return blows;
        }
        let (channels, values) = (series.headers.len().min(CHANNELS), series.values());
        if values > MOST_VALUES {
            let why = format!(
                "{values} values, more than the {MOST_VALUES} that are tried; write its table by hand, as docs/campaign.md shows, or: vibro spectrum {file} --channel 1"
            );
            return FoundTables::left(file, why);
        }
        let drills = self.drill(series, name);
        if !drills.is_empty() {
            return FoundTables { tables: drills, ..found };
        }
        let indices = (0..channels).into_par_iter().with_min_len(share(values));
        let by_channel = indices.map(|k| match series.components(k) {
            Some(components) => {
                let why = format!("{} is the magnitude of {components}, which are taken", series.channel(k));
                FoundTables::left(file, why)
            }
            None => self.channel(series, k, name),
        });
        by_channel.collect::<Vec<FoundTables>>().into_iter().for_each(|tables| found.add(tables));
        if let Some(first) = series.headers.get(channels) {
            let (all, name) = (series.headers.len(), &first.name);
            let why = format!(
                "channels {} to {all}, from {name:?} on: {channels} channels a file are tried",
                channels + 1
            );
            found.add(FoundTables::left(file, why));
        }
        found
    }

    /// The table of one channel: a pulse, a drop that needs more keys, another kind with a plausible
    /// answer, or else a spectrum.
    ///
    /// An undecided drop yields to a decay or steady train that explains the whole record, because bounces
    /// also look like decays and impacts.
    fn channel(&self, series: &FileSeries, k: usize, name: &str) -> FoundTables {
        let [pulse, others @ ..] = series.of_channel(k, name);
        // A pulse is the only event of its record. A doubt about the filter or the contact law does not
        // make it another kind.
        let single_pulse = |answer: Answer| {
            let is_short =
                |e: &Evidence| matches!(e, Evidence::Pulse { duration } if *duration < LONGEST_CONTACT);
            answer.evidence.first().is_some_and(is_short)
                && answer.findings.iter().all(|(_, finding)| finding.code != code::PULSE_NOT_ALONE)
        };
        if self.answers(from_ref(&pulse)).is_ok_and(single_pulse) {
            return FoundTables::table(pulse);
        }
        let plausible = self.first_plausible(&others);
        let explained = plausible.as_ref().is_some_and(|table| self.explains_whole_record(table));
        let undecided = self.undecided_drop(series, k, name).filter(|_| !explained);
        if let Some(table) = undecided.or(plausible).or_else(|| self.friction_decay(&others)) {
            return FoundTables::table(table);
        }
        let table = series.channel_table(k, name, "spectrum", "a time record");
        let what = "number of sines to fit, the strongest; gives their true amplitudes";
        self.with_answer(table.open("tones", "", what))
    }

    /// Whether a table explains the record as one motion: a decay that fills most of it and that no other
    /// event follows, or a steady train of impacts.
    fn explains_whole_record(&self, table: &Table) -> bool {
        let is_steady = |evidence: &Evidence| match evidence {
            Evidence::Impacts { spread, .. } => *spread < MOST_INTERVAL_SPREAD,
            _ => true,
        };
        let is_cut = |answer: &Answer| answer.findings.iter().any(|(_, found)| found.code == code::DECAY_CUT);
        self.answers(from_ref(table)).is_ok_and(|answer| {
            !is_brief_decay(&answer) && !is_cut(&answer) && answer.evidence.iter().all(is_steady)
        })
    }

    /// A drop table marked as refused, if the record allows several series of bounces. Its missing height can
    /// decide between them.
    fn undecided_drop(&self, series: &FileSeries, k: usize, name: &str) -> Option<Table> {
        let refusal = self.answers(&[series.bounces(k, name)]).err().filter(|r| r.code == Train::UNTOLD)?;
        let what = "height of the fall in m; it tells the bounces from the other sounds";
        let table = series.bounces(k, name).missing("height", "0.5", what);
        let rows = table.rows.into_iter().filter(|row| !matches!(row.known, KeyStatus::Open(_))).collect();
        Some(Table { rows, refused: Some(refusal), ..table })
    }

    /// The table if its analysis gives an answer, else the reason why there is none.
    pub(super) fn with_answer(&self, table: Table) -> FoundTables {
        match self.answers(from_ref(&table)) {
            Ok(_) => FoundTables::table(table),
            Err(refusal) => FoundTables::left(table.files, refusal.why),
        }
    }

    /// The tables of a hammer drill, one for each velocity channel, if another channel has two levels, as the
    /// pulses of a crank. If that channel is more likely a contact circuit beside a sine, the only table is
    /// that of its impacts.
    fn drill(&self, series: &FileSeries, name: &str) -> Vec<Table> {
        let file = &series.files[0];
        let is_velocity = |h: &Header| h.quantity == "velocity" || h.unit == "V";
        let velocities = (0..series.headers.len()).filter(|k| is_velocity(&series.headers[*k]));
        let velocities: Vec<usize> = velocities.collect();
        if series.headers.len() < 2 || velocities.is_empty() {
            return Vec::new();
        }
        let path = self.folder.root().join(file);
        let Ok(recording) = self.reading.reader().and_then(|r| r.within(self.folder).from_path(path)) else {
            return Vec::new();
        };
        let shares: Vec<f64> = recording.records.iter().map(at_two_levels).collect();
        let largest = (0..shares.len()).max_by(|a, b| shares[*a].total_cmp(&shares[*b]));
        let Some(pulses) = largest.filter(|k| shares[*k] > 0.9) else { return Vec::new() };
        // A contact circuit has two levels, too. It is assumed where the only other channel is a sine, its
        // excitation, and the name is not that of a tacho.
        let pulses_name = series.headers[pulses].name.to_lowercase();
        if !TACHO_WORDS.iter().any(|word| pulses_name.contains(word))
            && let [sine] = (0..series.headers.len()).filter(|k| *k != pulses).collect::<Vec<_>>()[..]
            && is_sine(&recording.records[sine])
        {
            let table = series.channel_table(pulses, name, "impacts", "impacts in a row").surmised();
            let table = table.guessed("reference", series.channel(sine), "the channel of a sine");
            return self.answers(from_ref(&table)).map_or_else(|_| Vec::new(), |_| vec![table]);
        }
        let table = |k: usize| {
            let header = &series.headers[k];
            let about = "a hammer drill with the pulses of its crank";
            let table = Table::new("drill", about, file).surmised();
            let table = table.found("name", format!("{name} {}", header.name)).found("file", file);
            let table =
                table.guessed("velocity", series.channel(k), "the other channel has two levels, as a tacho");
            let table = table.guessed("reference", series.channel(pulses), "two levels, as a tacho has");
            let table = table.missing("pulses_per_turn", "1", "pulses in a turn of the crank");
            let table = table.guessed("edge", "rising", "the speed is the same with falling");
            let table =
                table.missing("beam_angle", "0", "degrees between the beam and the axis of the motion");
            let table = table.guessed(
                "beam_from",
                "axis",
                "from the axis of the motion; normal: from the normal of the surface",
            );
            match header.quantity {
                "velocity" => table,
                _ => table.missing("sensitivity", "1", "m/s along the beam for one unit of the channel"),
            }
        };
        velocities.into_iter().filter(|k| *k != pulses).map(table).collect()
    }
}

impl FileSeries {
    /// The table of a train of bounces.
    fn bounces(&self, k: usize, name: &str) -> Table {
        self.channel_table(k, name, "drop", "impacts of a falling body")
            .surmised()
            .open("height", "", HEIGHT)
            .open("height_std", "", "in m; without it R from the height has no uncertainty")
    }

    /// The table of a drop with one rebound.
    fn fall(&self, k: usize, name: &str) -> Table {
        let table = self.channel_table(k, name, "drop", "a fall and one rebound").surmised();
        let table = table.missing("height", "0.5", HEIGHT);
        let table = table.missing("height_std", "0.001", "in m, as exactly as the height is known");
        table.open(
            "interval_std",
            "1e-5",
            "of the time between the impacts in s, where there are fewer than four drops",
        )
    }

    /// A table of a section for a channel, with the keys that name it and its files.
    fn channel_table(&self, k: usize, name: &str, section: &'static str, about: &'static str) -> Table {
        let file = self.pattern.as_ref().filter(|_| self.files.len() > 1).unwrap_or(&self.files[0]);
        let several = self.headers.len() > 1;
        let title = if several { format!("{name} {}", self.headers[k].name) } else { name.to_owned() };
        let table = Table::new(section, about, &self.in_words());
        let table = if self.alike {
            table.guessed("name", title, "the columns and rate of the others, and agrees with them")
        } else {
            table.found("name", title)
        };
        let table = table.found("file", file);
        if several { table.found("channel", self.channel(k)) } else { table }
    }

    /// The possible tables of one channel, a pulse first.
    fn of_channel(&self, k: usize, name: &str) -> [Table; 5] {
        let table = |section, about| self.channel_table(k, name, section, about).surmised();
        let low_pass =
            "corner of the instrument's low-pass in Hz, with order; or \"none\"; gives uncertainties";
        let pulse = table("pulse", "one contact pulse").open("low_pass", "", low_pass);
        [
            pulse.open("mass", "", "kg; gives stiffness"),
            self.bounces(k, name),
            self.fall(k, name),
            table("decay", "a free decay"),
            table("impacts", "impacts in a row").open("excitation", "", "Hz; gives impacts per cycle"),
        ]
    }
}

/// Whether the answer consists of sweeps with enough certain steps: in each, at least this share of the
/// steps and at least one has an uncertainty. Steps without one, such as clipped ones, do not make it
/// another kind.
fn enough_steps_certain(answer: &Answer, share: f64) -> bool {
    let is_certain = |evidence: &Evidence| match evidence {
        Evidence::Sweep { steps, sure, .. } => *sure as f64 >= share * *steps as f64 && *sure > 0,
        _ => false,
    };
    !answer.evidence.is_empty() && answer.evidence.iter().all(is_certain)
}

/// Share of the record before the decay begins; `None` if the answer is no decay.
fn lead_share(answer: &Answer) -> Option<f64> {
    let Some(Evidence::Decay { start, last, .. }) = answer.evidence.first() else { return None };
    Some(start / last)
}

/// Whether the answer is a decay that takes a small part of the record after its start, as the ringing
/// after one of several impacts.
fn is_brief_decay(answer: &Answer) -> bool {
    matches!(answer.evidence.first(), Some(Evidence::Decay { start, end, last }) if end - start < LEAST_DECAY_SHARE * (last - start))
}

/// Whether an answer is plausible for the kind of its tables. Impacts: three or more, at most a quarter of
/// them missed. Drops: no rebound as fast as the approach, and two impacts a file in the tables of a drop
/// with one rebound.
fn fits_kind(tables: &[Table], answer: &Answer) -> bool {
    // Of the kinds with impacts, only a drop with one rebound lacks a key, its height.
    let one_rebound = tables.iter().any(Table::lacks);
    match answer.evidence.first() {
        Some(Evidence::Impacts { n, missed, .. }) => *n >= 3 && 4 * missed <= *n,
        Some(Evidence::Drops { restitution, one_interval_each, .. }) => {
            *restitution <= MOST_RESTITUTION && (!one_rebound || *one_interval_each)
        }
        _ => true,
    }
}

/// Whether a trace may be a sine, by its squared crest factor: squared peak over mean square, both about
/// the mean.
fn is_sine(record: &Record) -> bool {
    let Record::Trace(trace) = record else { return false };
    let n = trace.values.len() as f64;
    let mean = trace.values.iter().sum::<f64>() / n;
    let peak = trace.values.iter().map(|v| (v - mean).abs()).fold(0.0, f64::max);
    let power = trace.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    peak > 0.0 && SINE_CREST_SQUARED.contains(&(peak * peak / power))
}

/// Share of the values in the lowest and highest tenth of the range; 0 unless each tenth has more than 0.5
/// % of the values.
fn at_two_levels(record: &Record) -> f64 {
    let Record::Trace(trace) = record else { return 0.0 };
    let ends = |(a, b): (f64, f64), v: &f64| (a.min(*v), b.max(*v));
    let (low, high) = trace.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    let tenth = 0.1 * (high - low);
    let count = |is: &dyn Fn(f64) -> bool| trace.values.iter().filter(|v| is(**v)).count();
    let (down, up) = (count(&|v| v < low + tenth), count(&|v| v > high - tenth));
    let least = trace.values.len() / 200;
    if down > least && up > least { (down + up) as f64 / trace.values.len() as f64 } else { 0.0 }
}
