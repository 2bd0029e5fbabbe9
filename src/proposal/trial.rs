//! Identifies records by trying one analysis after another.

use super::folder::{FileSeries, short};
use super::found::FoundTables;
use super::workload::{CHANNELS, share};
use super::{KeyStatus, Proposal, Refusal, Table};
use crate::analysis::{self, Answer, AnswerCache, Evidence};
use crate::campaign::Reading;
use crate::measure::restitution::Train;
use crate::read::{Folder, Header};
use crate::record::{Fact, Finding, Record, Severity, code};
use rayon::prelude::*;
use std::ops::Range;
use std::slice::from_ref;

/// Hint for the missing height of a drop.
const HEIGHT: &str = "height of the fall in m";

/// Longest contact in s; a longer hump is no contact pulse.
const LONGEST_CONTACT: f64 = 0.1;

/// Findings of a decay with friction, whose amplitude falls by a constant step per swing.
const FRICTION: [&str; 2] = [code::DECAY_UNEXPLAINED, code::DECAY_CHANGES];

/// Least number of segments for a frequency response, and the samples of a segment that are sufficient.
const AVERAGES: usize = 4;
const LONG: usize = 8192;

/// Least share of the record after its start that a decay must take, where a train of impacts is also
/// possible.
const MOSTLY: f64 = 0.2;

/// Largest share of the record before a decay that starts at once.
const AT_ONCE: f64 = 0.01;

/// Square of the crest factor of a sine: 2, plus an allowance for noise; a square wave has 1.
const SINE: Range<f64> = 1.8..2.7;

/// Restitution above which a body does not bounce: it rings.
const LOSSLESS: f64 = 0.99;

/// Largest relative spread of the intervals of a train of impacts. Machines jitter, footsteps vary by a
/// tenth, while intervals of bouncing spread by a half or more.
const STEADY: f64 = 0.25;

/// Words in the names of channels with crank pulses.
const TACHO: [&str; 4] = ["tach", "rpm", "crank", "drehzahl"];

/// Number of files from which a series may be a sweep.
pub(super) const STEPS: usize = 5;

/// Most values of a file that are analysed. Five minutes of eight channels at 51.2 kHz are 123 million:
/// minutes of work and 80 bytes of memory each.
const VALUES: usize = 1 << 27;

impl From<Option<Finding>> for Refusal {
    fn from(found: Option<Finding>) -> Refusal {
        let said = |name: &str| match found.as_ref().and_then(|found| found.fact(name)) {
            Some(Fact::Name(said)) => said.clone(),
            _ => String::new(),
        };
        let why = Some(said("why")).filter(|why| !why.is_empty()).unwrap_or_else(|| "no answer".to_owned());
        Refusal { why, hint: said("hint"), code: said("refusal") }
    }
}

/// Makes the table for a channel of a series.
type Kind = fn(&FileSeries, usize, &str) -> Table;

/// Tries analyses on records.
#[derive(Clone, Copy)]
pub(super) struct Trial<'a> {
    pub folder: &'a Folder,
    pub reading: &'a Reading,
    pub kept: &'a AnswerCache,
}

impl Trial<'_> {
    /// The answers of tables, or the reason why there is none.
    fn answers(&self, tables: &[Table]) -> Result<Answer, Refusal> {
        let path = self.folder.root().join(Proposal::FILE);
        let text: String = tables.iter().map(|table| table.stated(self.reading).tried().toml(&[])).collect();
        let answered =
            analysis::parse(self.folder, &path, text).and_then(|c| analysis::answers(&c, self.kept, &()));
        answered.map_err(|error| Refusal { why: short(&error), ..Refusal::default() })?.map_err(Refusal::from)
    }

    /// The first table with a plausible answer and no doubt.
    fn first(&self, tables: &[Table]) -> Option<Table> {
        let sure = |table| Some((table, self.sensibly(from_ref(table))?));
        let mut answering = tables.iter().filter_map(sure);
        let (first, heard) = answering.next()?;
        let other = if is_brief(&heard) || first.lacks() { answering.next() } else { None };
        // A record at rest before its first impact is a drop; one that decays from its start is not.
        let other =
            other.filter(|(_, heard)| !first.lacks() || begins(heard).is_some_and(|part| part < AT_ONCE));
        Some(other.map_or(first, |(table, _)| table).clone())
    }

    /// A decay without a modal fit, such as one with friction.
    fn unexplained(&self, tables: &[Table]) -> Option<Table> {
        let friction = |table: &&Table| {
            let doubts = |heard: &Answer| {
                heard
                    .findings
                    .iter()
                    .all(|(_, f)| f.severity < Severity::Doubt || FRICTION.contains(&&*f.code))
            };
            table.section == "decay"
                && self.answers(from_ref(*table)).is_ok_and(|h| doubts(&h) && !is_brief(&h))
        };
        tables.iter().find(friction).cloned()
    }

    /// The answers of the tables, if they are plausible and without a doubt.
    fn sensibly(&self, tables: &[Table]) -> Option<Answer> {
        let sure = |heard: &Answer| {
            heard.findings.iter().all(|(_, f)| f.severity < Severity::Doubt) && sensible(tables, heard)
        };
        self.answers(tables).ok().filter(sure)
    }

    /// The tables of a sweep, if a series is one; a few files decide whether all are read.
    pub fn sweep(&self, series: &FileSeries, few: &FileSeries) -> Option<FoundTables> {
        let table = series.sweep().filter(|_| series.files.len() >= STEPS)?;
        let answer = |table: &Table| self.answers(from_ref(table)).ok();
        if few.files.len() < series.files.len() {
            answer(&few.sweep()?).filter(|heard| settled(heard, 0.0))?;
        }
        let heard = answer(&table).filter(|heard| settled(heard, 0.5))?;
        let (_, responses) = series.force_and_responses().unwrap_or_default();
        let name = |k: usize| match responses.len() {
            1 => series.name.clone(),
            _ => format!("{} {}", series.name, series.channel(k).to_string().trim_matches('"')),
        };
        let jumps = |i: usize| matches!(heard.evidence.get(i), Some(Evidence::Sweep { jumps: true, .. }));
        // A response that jumps has no linear modes.
        let modes = responses.iter().enumerate().filter(|(i, _)| !jumps(*i)).map(|(_, k)| {
            let table = Table::new("frf", "its modes", &series.in_words()).found("sweep", name(*k));
            table.found("name", format!("{}, modes", name(*k)))
        });
        Some(FoundTables { tables: [table].into_iter().chain(modes).collect(), ..FoundTables::default() })
    }

    /// The tables of repeated drops, if a few files of a series are drops.
    pub fn drops(&self, series: &FileSeries, few: &FileSeries) -> Option<FoundTables> {
        if series.files.len() < 2 || series.headers.len() != 1 || series.values() > VALUES {
            return None;
        }
        let drops = |series: &FileSeries, table: Kind| {
            let one = |file: &String| {
                table(&FileSeries { files: vec![file.clone()], ..series.clone() }, 0, &series.name)
            };
            match series.pattern {
                Some(_) => vec![table(series, 0, &series.name)],
                None => series.files.iter().map(one).collect::<Vec<Table>>(),
            }
        };
        // Repeated drops of one body agree. Where names do not group them, each must be a drop by itself.
        let each = |heard: &Answer| {
            let of = |evidence: &Evidence| matches!(evidence, Evidence::Drops { files, .. } if *files == few.files.len());
            !few.alike || heard.evidence.first().is_some_and(of)
        };
        let agree = |kind: &Kind| self.sensibly(&drops(few, *kind)).as_ref().is_some_and(each);
        let kind = [FileSeries::bounces as Kind, FileSeries::fall].into_iter().find(agree)?;
        Some(FoundTables { tables: drops(series, kind), ..FoundTables::default() })
    }

    /// The tables of one file.
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
            return self.answering(table.found("name", name).found("file", file));
        }
        if let Some((force, responses)) = series.force_and_responses() {
            for response in responses {
                found.add(self.function(series, name, [force, response]));
            }
            return found;
        }
        let (channels, values) = (series.headers.len().min(CHANNELS), series.values());
        if values > VALUES {
            let why = format!(
                "{values} values, more than the {VALUES} that are tried; write its table by hand, as docs/campaign.md shows, or: vibro spectrum {file} --channel 1"
            );
            return FoundTables::left(file, why);
        }
        let drills = self.drill(series, name);
        if !drills.is_empty() {
            return FoundTables { tables: drills, ..found };
        }
        let each = (0..channels).into_par_iter().with_min_len(share(values));
        let each = each.map(|k| match series.components(k) {
            Some(of) => {
                let why = format!("{} is the magnitude of {of}, which are taken", series.channel(k));
                FoundTables::left(file, why)
            }
            None => self.channel(series, k, name),
        });
        each.collect::<Vec<FoundTables>>().into_iter().for_each(|one| found.add(one));
        found
    }

    /// The table of one channel.
    fn channel(&self, series: &FileSeries, k: usize, name: &str) -> FoundTables {
        let [pulse, others @ ..] = series.of_channel(k, name);
        // A pulse is the only event of its record. A doubt about the filter or the contact law does not make
        // it another kind.
        let alone = |heard: Answer| {
            let short =
                |e: &Evidence| matches!(e, Evidence::Pulse { duration } if *duration < LONGEST_CONTACT);
            heard.evidence.first().is_some_and(short)
                && heard.findings.iter().all(|(_, finding)| finding.code != code::PULSE_NOT_ALONE)
        };
        if self.answers(from_ref(&pulse)).is_ok_and(alone) {
            return FoundTables::table(pulse);
        }
        let first = self.first(&others);
        let untold = self.untold(series, k, name).filter(|_| !first.as_ref().is_some_and(|t| self.is_one(t)));
        if let Some(table) = untold.or(first).or_else(|| self.unexplained(&others)) {
            return FoundTables::table(table);
        }
        let table = series.channel_table(k, name, "spectrum", "a time record");
        let what = "sines to fit, strongest first; gives their true amplitudes";
        self.answering(table.open("tones", "", what))
    }

    /// Whether a table explains the record as one motion: a decay that fills most of it and that no other
    /// event follows, or a steady train of impacts. Each bounce rings down, and bounces are impacts in a row.
    fn is_one(&self, table: &Table) -> bool {
        let one = |of: &Evidence| match of {
            Evidence::Impacts { spread, .. } => *spread < STEADY,
            _ => true,
        };
        let alone = |heard: &Answer| !heard.findings.iter().any(|(_, found)| found.code == code::DECAY_CUT);
        self.answers(from_ref(table))
            .is_ok_and(|heard| !is_brief(&heard) && alone(&heard) && heard.evidence.iter().all(one))
    }

    /// The table of a drop whose bounces cannot be told from other sounds yet, with the reason and a hint.
    fn untold(&self, series: &FileSeries, k: usize, name: &str) -> Option<Table> {
        let refusal = self.answers(&[series.bounces(k, name)]).err().filter(|r| r.code == Train::UNTOLD)?;
        let table = series.bounces(k, name).missing("height", "0.5", HEIGHT);
        let rows = table.rows.into_iter().filter(|row| !matches!(row.known, KeyStatus::Open(_))).collect();
        Some(Table { rows, refused: Some(refusal), ..table })
    }

    /// The table if it gives an answer, else the reason.
    fn answering(&self, table: Table) -> FoundTables {
        match self.answers(from_ref(&table)) {
            Ok(_) => FoundTables::table(table),
            Err(refusal) => FoundTables::left(table.files, refusal.why),
        }
    }

    /// The frequency response between two channels: of noise, else of hammer blows.
    fn function(&self, series: &FileSeries, name: &str, [force, response]: [usize; 2]) -> FoundTables {
        let file = &series.files[0];
        let called = format!("{name} {}", series.headers[response].name);
        let table = |about| {
            let table = Table::new("frf", about, file).found("name", &called).found("file", file);
            let table = table.found("channel", series.channel(response));
            table.guessed("reference", series.channel(force), "the channel in N")
        };
        let steady = table("force and response");
        let steady = match series.headers[response].n / AVERAGES {
            few if few < LONG => steady.guessed(
                "segment",
                1 << few.max(1).ilog2(),
                "seven averages of half-overlapping segments",
            ),
            _ => steady,
        };
        let blows = table("a hammer test").guessed("hammer", true, "the force is zero between blows");
        match self.first(&[steady.clone(), blows]) {
            Some(table) => FoundTables::table(table),
            None => self.answering(steady),
        }
    }

    /// A hammer drill: velocities beside a two-level channel, the pulses of its crank.
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
        let most = (0..shares.len()).max_by(|a, b| shares[*a].total_cmp(&shares[*b]));
        let Some(pulses) = most.filter(|k| shares[*k] > 0.9) else { return Vec::new() };
        // A two-level contact circuit beside the channel of its excitation.
        let called = series.headers[pulses].name.to_lowercase();
        if !TACHO.iter().any(|word| called.contains(word))
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
                "beam_angle counts from the axis; the other choice is normal",
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
            .open("height_std", "", "its standard uncertainty in m")
    }

    /// The table of a drop with one rebound.
    fn fall(&self, k: usize, name: &str) -> Table {
        let table = self.channel_table(k, name, "drop", "a fall and one rebound").surmised();
        let table = table.missing("height", "0.5", HEIGHT);
        let table = table.missing("height_std", "0.001", "its standard uncertainty in m");
        table.open(
            "interval_std",
            "1e-5",
            "of the time between the impacts in s, where there are fewer than four drops",
        )
    }

    fn channel_table(&self, k: usize, name: &str, section: &'static str, about: &'static str) -> Table {
        let file = self.pattern.as_ref().filter(|_| self.files.len() > 1).unwrap_or(&self.files[0]);
        let several = self.headers.len() > 1;
        let called = if several { format!("{name} {}", self.headers[k].name) } else { name.to_owned() };
        let table = Table::new(section, about, &self.in_words());
        let table = if self.alike {
            table.guessed("name", called, "the columns and rate of the others, and agrees with them")
        } else {
            table.found("name", called)
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

/// Whether at least this share of the steps of each sweep, and one step, has an uncertainty: a clipped step
/// does not make it another kind.
fn settled(heard: &Answer, share: f64) -> bool {
    let most = |of: &Evidence| match of {
        Evidence::Sweep { steps, sure, .. } => *sure as f64 >= share * *steps as f64 && *sure > 0,
        _ => false,
    };
    !heard.evidence.is_empty() && heard.evidence.iter().all(most)
}

/// Share of the record before a decay begins; `None` if the answer is no decay.
fn begins(heard: &Answer) -> Option<f64> {
    let Some(Evidence::Decay { start, last, .. }) = heard.evidence.first() else { return None };
    Some(start / last)
}

/// Whether the answer is a decay that takes a small part of its record, as the ringing of one of several
/// impacts.
fn is_brief(heard: &Answer) -> bool {
    matches!(heard.evidence.first(), Some(Evidence::Decay { start, end, last }) if end - start < MOSTLY * (last - start))
}

/// Whether impacts are plausible for their tables: three or more in a row with few missed, or two in a drop
/// with one rebound, and no rebound as fast as the approach.
fn sensible(tables: &[Table], heard: &Answer) -> bool {
    let rebound = tables.iter().any(Table::lacks);
    match heard.evidence.first() {
        Some(Evidence::Impacts { n, missed, .. }) => *n >= 3 && 4 * missed <= *n,
        Some(Evidence::Drops { restitution, one_interval_each, .. }) => {
            *restitution <= LOSSLESS && (!rebound || *one_interval_each)
        }
        _ => true,
    }
}

/// Whether the peak of a trace is that of a sine of the same power, noise included.
fn is_sine(record: &Record) -> bool {
    let Record::Trace(trace) = record else { return false };
    let n = trace.values.len() as f64;
    let mean = trace.values.iter().sum::<f64>() / n;
    let reach = trace.values.iter().map(|v| (v - mean).abs()).fold(0.0, f64::max);
    let power = trace.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    reach > 0.0 && SINE.contains(&(reach * reach / power))
}

/// Share of values in the lowest and highest tenth of the range, if both have some.
fn at_two_levels(record: &Record) -> f64 {
    let Record::Trace(trace) = record else { return 0.0 };
    let ends = |(a, b): (f64, f64), v: &f64| (a.min(*v), b.max(*v));
    let (low, high) = trace.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    let tenth = 0.1 * (high - low);
    let count = |is: &dyn Fn(f64) -> bool| trace.values.iter().filter(|v| is(**v)).count();
    let (down, up) = (count(&|v| v < low + tenth), count(&|v| v > high - tenth));
    let some = trace.values.len() / 200;
    if down > some && up > some { (down + up) as f64 / trace.values.len() as f64 } else { 0.0 }
}
