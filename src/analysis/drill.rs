//! Hammer drills: `[[drill]]`, `vibro drill`.

pub mod cycles;
pub mod figures;
mod file;
mod joined;
mod modelled;
pub mod tables;

use super::answer::Answer;
use super::headline::headline;
use super::job::Job;
use super::kind::{Analysis, no_file};
use super::source::Source;
use crate::campaign::{Channel, Entry, KeyRange, LowPass, channel, channels};
use crate::error::{Error, Result};
use crate::measure::chain::Body;
use crate::measure::drill::{
    AngleOrigin, Beam, Cycle, Drill, DrillOptions, Edge, Slices, Smoothing, drill_each,
};
use crate::read::Header;
use crate::report::Cell;
use crate::report::files::Names;
use crate::units::notation::counted;
use file::Channels;
use serde::Deserialize;
use std::path::PathBuf;
use vibro_record::units::Quantity;
use vibro_record::{Finding, doubt_with_record};

/// Where the channels of a drill are, and how they are measured.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// Velocity channel, by name or by number from 1
    #[serde(deserialize_with = "channel")]
    pub velocity: Option<String>,
    /// Channel with the pulses of the crank [default: none, the turns come from the impacts]
    #[serde(deserialize_with = "channel")]
    pub reference: Option<String>,
    /// Velocity along the beam in m/s for one unit of the channel [default: 1 where the file says it is a
    /// velocity]
    pub sensitivity: Option<f64>,
    /// Angle of the beam in degrees
    pub beam_angle: Option<f64>,
    /// What the beam angle is counted from: normal (to the motion) or axis (of the motion)
    #[cfg_attr(feature = "cli", arg(value_parser = crate::campaign::word::<AngleOrigin>))]
    #[serde(alias = "from")]
    pub beam_from: Option<AngleOrigin>,
    /// Pulses of the reference in a turn
    pub pulses_per_turn: Option<usize>,
    /// Edge of the pulse that counts: rising or falling
    #[cfg_attr(feature = "cli", arg(value_parser = crate::campaign::word::<Edge>))]
    pub edge: Option<Edge>,
    /// Trigger level of the edge, in the unit of the reference [default: the middle of its two levels]
    pub level: Option<f64>,
    /// Name of the measured body, such as striker or bit: bodies of a campaign are joined by the crank, in
    /// the order of their tables
    #[cfg_attr(feature = "cli", arg(skip))]
    pub body: Option<String>,
    /// Measured mass in kg, for the energies
    pub mass: Option<f64>,
    /// Struck mass in kg, at rest before the impact, for the restitution
    pub struck_mass: Option<f64>,
    /// Longest contact in s [default: 0.0002]
    pub contact: Option<f64>,
    /// Duration in s of the fits before and after a contact [default: 0.0005]
    #[serde(alias = "fit")]
    pub fit_duration: Option<f64>,
    /// Longest drop-out in s that is bridged [default: 0.002]
    pub longest_dropout: Option<f64>,
    /// Channel delay to remove, in s: the velocity was recorded later than the reference [default: 0]
    pub delay: Option<f64>,
    /// Points of the average turn [default: 720]
    pub points: Option<usize>,
    /// Corner in Hz of the zero-phase low-pass for average and displacement, or `none` [default: the highest
    /// frequency that the points of the average turn resolve]
    #[cfg_attr(feature = "cli", arg(value_name = "HZ", value_parser = LowPass::typed))]
    pub low_pass: Option<LowPass>,
    /// Time constant in s of exponential smoothing instead of the low-pass
    pub smoothing: Option<f64>,
    /// Bandwidth of the instrument in Hz
    pub instrument: Option<f64>,
    /// Record of the velocity channel without motion: the noise floor
    #[serde(alias = "noise")]
    pub noise_record: Option<PathBuf>,
    /// Margin in dB of the motion above the noise [default: 10]
    pub margin: Option<f64>,
    /// Acceleration channel of a handle, up to three times: hand-arm exposure
    #[serde(deserialize_with = "channels")]
    #[cfg_attr(feature = "cli", arg(long, value_name = "CH"))]
    pub handle: Vec<String>,
    /// Acceleration in m/s² for one unit of these channels
    pub handle_sensitivity: Option<f64>,
    /// Hours a day of that exposure: A(8)
    pub exposure: Option<f64>,
}

/// Meaning of a key without a default, and an example of its value.
fn expected(key: &str) -> (&'static str, &'static str) {
    match key {
        "velocity" => ("a channel, by name or number", "1"),
        "reference" => {
            ("the channel of the crank's pulses; without one, leave out its pulses and edge, too", "2")
        }
        "beam_angle" => ("degrees between the laser beam and the axis or normal", "0"),
        "beam_from" => ("axis or normal: where the beam angle counts from", "\"axis\""),
        "pulses_per_turn" => ("reference pulses in a turn of the crank", "1"),
        "edge" => ("rising or falling: the pulse edge that counts", "\"rising\""),
        "sensitivity" => ("m/s for one unit: the file does not say that the channel is a velocity", "1"),
        _ => ("m/s² for one unit: the file does not say that the handle channels are accelerations", "1"),
    }
}

/// The value of a key that has no default, or the error that it is missing.
fn needed<T>(key: &'static str, value: Option<T>) -> Result<T> {
    value.ok_or_else(|| missing(&[key], &[]))
}

/// Error that these keys are missing; the channels of the file are listed to choose from.
fn missing(keys: &[&'static str], channels: &[Header]) -> Error {
    let described = |(i, header): (usize, &Header)| format!("{} {} [{}]", i + 1, header.name, header.unit);
    let list = channels.iter().enumerate().map(described).collect::<Vec<_>>().join(", ");
    let velocity = channels.iter().position(|header| header.quantity == "velocity").unwrap_or(0);
    let what = |key| if key == "velocity" && !channels.is_empty() { &list } else { expected(key).0 };
    let value = |key| match key {
        "velocity" => (velocity + 1).to_string(),
        "reference" if velocity == 1 => "1".to_owned(),
        _ => expected(key).1.to_owned(),
    };
    let named = keys.iter().map(|key| format!("{} ({})", key.replace('_', " "), what(*key)));
    let are = if keys.len() == 1 { "is" } else { "are" };
    let named = named.collect::<Vec<_>>().join(", ");
    let error = Error::usage(format!("{} {are} missing: {named}", counted(keys.len(), "value")), "");
    keys.iter().fold(error, |error, key| error.set(key, value(key)))
}

/// Refuses the general keys `channel` and `calibration`: a drill has keys of its own for them.
fn own_channels(channel: &Channel) -> Result<()> {
    let stated = [("channel", channel.channel.is_some()), ("calibration", channel.calibration.is_some())];
    stated.into_iter().find(|(_, stated)| *stated).map_or(Ok(()), |(key, _)| {
        Err(Error::usage(
            format!("{key} is stated for a drill"),
            "velocity, reference and sensitivity instead",
        )
        .setting(key))
    })
}

impl Keys {
    /// Checks that no key without a default is missing. In a file of several `channels` one may be the
    /// reference, so its keys are required too.
    fn complete(&self, channels: &[Header]) -> Result<()> {
        let (pulses, edge) = (self.pulses_per_turn.is_some(), self.edge.is_some());
        let reference = self.reference.is_some();
        // Whether the keys of a reference are required.
        let needs_reference =
            reference || pulses || edge || self.level.is_some() || self.delay.is_some() || channels.len() > 1;
        let stated = [
            ("velocity", self.velocity.is_some()),
            ("reference", reference || !needs_reference),
            ("beam_angle", self.beam_angle.is_some()),
            ("beam_from", self.beam_from.is_some()),
            ("pulses_per_turn", pulses || !needs_reference),
            ("edge", edge || !needs_reference),
        ];
        let keys: Vec<&'static str> = stated.iter().filter(|(_, stated)| !stated).map(|row| row.0).collect();
        if keys.is_empty() { Ok(()) } else { Err(missing(&keys, channels)) }
    }

    /// Checks that no key without a default is missing, no value is impossible, and no keys contradict.
    ///
    /// # Errors
    /// Names the key at fault.
    pub fn usable(&self) -> Result<()> {
        self.complete(&[])?;
        // Checked with a beam along the axis: an angle that sees no motion is refused with its record.
        self.options(Beam::new(0.0, AngleOrigin::Axis)?)?.check()?;
        if self.low_pass.is_some() && self.smoothing.is_some() {
            return Err(Error::usage("both low_pass and smoothing", "one of them").setting("smoothing"));
        }
        Ok(())
    }

    /// Options of the measurement. Without a sensitivity 1 is used; [`Keys::measure`] then requires a channel
    /// that is a velocity.
    fn options(&self, beam: Beam) -> Result<DrillOptions> {
        let sensitivity = self.sensitivity.unwrap_or(1.0);
        let defaults = if self.reference.is_some() {
            let pulses = needed("pulses_per_turn", self.pulses_per_turn)?;
            DrillOptions::new(sensitivity, beam, pulses, needed("edge", self.edge)?)
        } else {
            DrillOptions::of_impacts(sensitivity, beam)
        };
        Ok(DrillOptions {
            level: self.level,
            mass: self.mass,
            struck_mass: self.struck_mass,
            contact: self.contact.unwrap_or(defaults.contact),
            fit: self.fit_duration.unwrap_or(defaults.fit),
            longest_dropout: self.longest_dropout.unwrap_or(defaults.longest_dropout),
            delay: self.delay.unwrap_or(defaults.delay),
            points: self.points.unwrap_or(defaults.points),
            smoothing: match (self.low_pass, self.smoothing) {
                (Some(LowPass::Off), _) => Smoothing::Off,
                (Some(LowPass::Corner(corner)), _) => Smoothing::LowPass(corner),
                (None, Some(time)) => Smoothing::Exponential(time),
                (None, None) => Smoothing::default(),
            },
            instrument: self.instrument,
            margin: self.margin.unwrap_or(defaults.margin),
            hours: self.exposure,
            ..defaults
        })
    }

    /// Measures the drill of a record, with figures and tables. `each` is called with every turn of the
    /// average in order.
    ///
    /// # Errors
    /// If a file cannot be read, the record allows no answer, or `each` fails.
    pub fn measure(
        &self,
        source: &Source<'_>,
        each: &mut dyn FnMut(&Cycle<'_>) -> Result<()>,
    ) -> Result<Answer> {
        if self.velocity.is_none() {
            self.complete(&source.reader()?.survey(source.path)?.1)?;
        }
        self.usable()?;
        own_channels(source.channel)?;
        let options = self.options(Beam::new(
            needed("beam_angle", self.beam_angle)?,
            needed("beam_from", self.beam_from)?,
        )?)?;
        let velocity = needed("velocity", self.velocity.as_deref())?;
        let mut names = vec![velocity];
        names.extend(self.reference.as_deref());
        // Channels from here on are those of the handle.
        let first_handle = names.len();
        names.extend(self.handle.iter().map(String::as_str));
        let mut channels = Channels::read(source.reader()?, source.path, &names, source.progress)?;
        let is_velocity = channels.is(0, Quantity::Velocity);
        if !is_velocity {
            needed("sensitivity", self.sensitivity)?;
        }
        if (first_handle..names.len()).any(|channel| !channels.is(channel, Quantity::Acceleration)) {
            needed("handle_sensitivity", self.handle_sensitivity)?;
        }
        channels.scale(first_handle, self.handle_sensitivity.unwrap_or(1.0));
        let noise = source.further("noise_record", self.noise_record.as_ref())?;
        let noise =
            noise.map(|path| Channels::read(source.reader()?, &path, &[velocity], &())).transpose()?;
        if let Some(rate) = noise.as_ref().map(|s| s.rate).filter(|r| (r / channels.rate - 1.0).abs() > 1e-9)
        {
            let why = format!("the noise was sampled at {rate} Hz, the motion at {} Hz", channels.rate);
            return Err(Error::refused(why).setting("noise_record"));
        }
        let noise = noise.and_then(|s| s.values.into_iter().next());
        let record =
            Slices { rate: channels.rate, channels: channels.values.iter().map(Vec::as_slice).collect() };
        let options = DrillOptions { clock: channels.clock(), ..options };
        let mut found = drill_each(&record, &options, noise.as_deref(), each)?;
        let twice = Finding::doubt("drill-velocity-scaled-twice").number("sensitivity", options.sensitivity);
        let twice = (is_velocity && options.sensitivity != 1.0).then(|| twice.of(&mut found));
        doubt_with_record(&channels.findings, &mut found);
        found.findings.splice(..0, channels.findings.into_iter().chain(twice));
        let mut answer = answer(source.name, &found)?;
        let body = self.body.as_ref().map(|body| Body::of(source.name, body, &options, &found));
        answer.bodies.extend(body);
        Ok(answer)
    }
}

/// The answer of a measured drill, with figures and tables.
fn answer(name: &str, found: &Drill) -> Result<Answer> {
    let mut answer = Answer::of(found)?;
    answer.add("", &found.findings);
    answer.headlines.push(headline(
        "Hammer drill",
        [found],
        &[
            ("speed", "Hz", &|f| Cell::from(&f.speed)),
            ("velocity before impact", "m/s", &|f| f.before.as_ref().into()),
            ("restitution", "", &|f| f.restitution.as_ref().into()),
            ("impacts", "", &|f| Some(f.impacts.len()).filter(|n| *n > 0).into()),
        ],
    ));
    answer.tables.push(tables::drill(name, found));
    answer.figures = figures::drill(name, found);
    answer.csv("average", &tables::drill_average(found));
    answer.csv("impacts", &tables::drill_impacts(found));
    Ok(answer)
}

impl Analysis for Keys {
    const SECTION: &'static str = "drill";
    const TITLE: &'static str = "Hammer drills";
    const FILES: Names = Names::Named(&[
        "average",
        "impacts",
        "drill_average",
        "drill_trace",
        "drill_speed",
        "drill_noise",
        "drill_bandwidth",
        "drill_joined",
        "drill_chain",
        "drill_model",
        "drill_fit",
    ]);
    const RANGES: &'static [KeyRange] = &[
        KeyRange::above_zero("Hz", &["instrument"]),
        KeyRange::above_zero("s", &["smoothing"]).times(),
        KeyRange::from_zero("s", &["longest_dropout"]).times(),
        // Checked against the duration of a turn when that is known.
        KeyRange::above_zero("s", &["contact", "fit_duration"]).times().at_most(f64::MAX),
        KeyRange::above_zero("kg", &["struck_mass"]),
        KeyRange::any("", &["sensitivity", "handle_sensitivity", "level"]),
        KeyRange::any("°", &["beam_angle"]).at_most(360.0),
        KeyRange::any("dB", &["margin"]).at_most(1e3),
        KeyRange::from_zero("h", &["exposure"]).at_most(24.0),
        KeyRange::count(1e9, &["pulses_per_turn"]),
    ];

    fn check(entry: &Entry<Keys>, _: &[Entry<Keys>]) -> Result<()> {
        entry.file.as_ref().ok_or_else(no_file)?;
        own_channels(&entry.channel)?;
        entry.keys.usable()
    }

    fn channels(&self) -> Vec<(&'static str, &String)> {
        let handles = self.handle.iter().map(|name| ("handle", name));
        let others = [("velocity", &self.velocity), ("reference", &self.reference)];
        others.into_iter().filter_map(|(key, name)| Some((key, name.as_ref()?))).chain(handles).collect()
    }

    fn beside(&self) -> Option<(&'static str, &PathBuf)> {
        Some(("noise_record", self.noise_record.as_ref()?))
    }

    fn run(entries: &[Entry<Keys>], job: &mut Job<'_>) -> Result<()> {
        job.each("drill", entries, |entry, source| {
            let mut answer = entry.keys.measure(source, &mut |_| Ok(()))?;
            answer.files.iter_mut().for_each(|file| file.0.insert_str(0, "drill_"));
            Ok(vec![answer])
        })?;
        let model = job.campaign.drill_model.clone().and_then(|model| {
            let draft = job.campaign.drill_draft(&model);
            Some((model, job.found("[drill_model]", draft)?))
        });
        let (joined, apart) = joined::joined(&std::mem::take(&mut job.found.bodies), model.as_ref())?;
        for (record, finding) in &apart {
            job.found.add(record, [finding]);
        }
        let mut machines = Vec::new();
        for (number, answers) in (1..).zip(joined) {
            let mark = if number == 1 { String::new() } else { number.to_string() };
            let mut machine = job.show("joined", &mark, answers.machine);
            if let Some(model) = answers.model {
                machine.insert("model".to_owned(), job.show("model", &mark, model).into());
            }
            machines.push(machine);
        }
        if machines.is_empty() { Ok(()) } else { job.put("drill_machines", &machines) }
    }
}
