//! The spectra of a sweep, read together.

use super::decibel::Decibel;
use super::{Format, Reader, Recording, SweepList};
use std::path::Path;
use vibro_record::units::{Quantity, Unit};
use vibro_record::{
    Axis, Direction, Error, Finding, Meta, Place, Record, Result, Scaling, Spectrum, Sweep, SweepPoint,
    Values, Window,
};

/// What the analyser stored. What its files state themselves is believed where nothing is stated here; where both are and
/// differ, the statement here is used, with a finding.
#[derive(Debug, Clone, Default)]
pub struct SweepReader {
    /// Name of the sweep.
    pub name: String,
    /// Direction, if stated.
    pub direction: Option<Direction>,
    /// Mass, if stated.
    pub mass: Option<u8>,
    /// Unit in which responses are stored, if stated; else that of the files, else the SI unit of `quantity` is assumed, with
    /// a doubt.
    pub unit: Option<Unit>,
    /// What was stored, if stated; else what the unit says, else a displacement is assumed.
    pub quantity: Option<Quantity>,
    /// Factor on stored responses, if stated: unit per stored number, even where the files say volts.
    pub calibration: Option<f64>,
    /// Factor on stored forces, if stated: newtons per stored number, even where the files say volts.
    pub force_calibration: Option<f64>,
    /// Window, if stated: `Some(None)` says that it is unknown. Else that of the files, else Hann is assumed.
    pub window: Option<Option<Window>>,
    /// Peak or RMS, if stated; else that of the files, else peak is assumed.
    pub scaling: Option<Scaling>,
    /// How often the analyser integrated in frequency before it stored, if stated.
    pub analyser_integrated: Option<u8>,
    /// Format of the files, found out if `None`.
    pub format: Option<Format>,
}

/// What is stated of one kind of files: forces or responses.
struct Said<'a> {
    force: bool,
    unit: Option<&'a Unit>,
    quantity: Option<Quantity>,
    calibration: Option<f64>,
}

/// What is used for one file.
struct Settled {
    /// Factor from the record's values to SI peak amplitudes.
    factor: f64,
    unit: Unit,
    window: Option<Window>,
}

impl SweepReader {
    /// Reads all spectra of a list.
    ///
    /// # Errors
    /// If files are missing (all are named), cannot be read, or hold another number of lines than the list says.
    pub fn read(&self, list: &SweepList) -> Result<Sweep> {
        let reader = Reader::new().base_band(Some(list.base_band)).format(self.format);
        // One batch, so that all missing files are named at once.
        let paths: Vec<_> = list.response.iter().chain(&list.force).collect();
        let mut recordings = reader.from_paths(&paths).map_err(|e| list.missing().unwrap_or(e))?;
        let forces = recordings.split_off(list.response.len());
        let axis = Axis::frequency(0.0, list.base_band / list.lines as f64, list.lines + 1);
        let mut findings = Vec::new();
        let mut points = Vec::with_capacity(list.len());
        let mut unit: Option<Unit> = None;
        let newton = Unit::of(Quantity::Force);
        for (i, response) in recordings.into_iter().enumerate() {
            let force = match forces.get(i) {
                Some(recording) => {
                    let said = Said {
                        force: true,
                        unit: Some(&newton),
                        quantity: None,
                        calibration: self.force_calibration,
                    };
                    let settled = self.settle(recording, &said, &mut findings)?;
                    magnitudes(recording, list, &axis, settled.factor)?
                }
                None => Vec::new(),
            };
            let said = Said {
                force: false,
                unit: self.unit.as_ref(),
                quantity: self.quantity,
                calibration: self.calibration,
            };
            let settled = self.settle(&response, &said, &mut findings)?;
            let values = magnitudes(&response, list, &axis, settled.factor)?;
            match &unit {
                Some(first) if *first != settled.unit => {
                    return Err(Error::input(
                        Place::file(&response.path),
                        format!("the values of this file are in {}", settled.unit),
                        format!("{first}, as in the files before"),
                    ));
                }
                _ => unit = Some(settled.unit.clone()),
            }
            gather(&response, &mut findings);
            let mut meta = response.records.into_iter().next().map_or_else(
                || Meta::new("", settled.unit.clone()),
                |mut record| std::mem::replace(record.meta_mut(), Meta::new("", Unit::none())),
            );
            meta.unit = settled.unit;
            meta.quantity = meta.unit.quantity();
            meta.findings.clear(); // said once, for the sweep
            meta.step("calibrate", &[("factor", &settled.factor), ("unit", &meta.unit.clone())]);
            points.push(SweepPoint {
                force_path: list.force.get(i).cloned(),
                response_path: list.response[i].clone(),
                force,
                given: list.excitation.get(i).copied(),
                response: Spectrum {
                    meta,
                    axis: axis.clone(),
                    values: Values::Real(values),
                    scaling: Scaling::Peak,
                    window: settled.window,
                    enbw: settled.window.map(Window::enbw),
                },
            });
        }
        let displacement = unit.is_some_and(|u| u.quantity() == Quantity::Displacement);
        let analyser_integrated = self.analyser_integrated.unwrap_or(u8::from(displacement));
        if self.analyser_integrated.is_none() && displacement {
            findings.push(Finding::caution("analyser-integration-assumed"));
        }
        Ok(Sweep {
            name: self.name.clone(),
            direction: self.direction,
            mass: self.mass,
            axis,
            analyser_integrated,
            points,
            findings,
        })
    }

    /// Brings together what a file states and what was stated for it.
    fn settle(&self, recording: &Recording, said: &Said, findings: &mut Vec<Finding>) -> Result<Settled> {
        let Some(Record::Spectrum(spectrum)) = recording.records.first() else {
            return Err(no_spectrum(recording));
        };
        linear(&recording.path, &spectrum.meta, said, findings)?;
        let mut found = |finding: Finding| {
            if !findings.contains(&finding) {
                findings.push(finding);
            }
        };
        let scaling = match (self.scaling, spectrum.scaling) {
            (Some(stated), _) => stated,
            (None, Scaling::Unknown) => {
                found(Finding::caution("peak-assumed"));
                Scaling::Peak
            }
            (None, written) => written,
        };
        if !matches!(scaling, Scaling::Peak | Scaling::Rms) {
            return Err(Error::input(
                Place::file(&recording.path),
                format!("a spectrum scaled as {}", scaling.name()),
                "peak or RMS amplitudes",
            )
            .hint("export amplitudes; a density or a coherence has no amplitude of a single line"));
        }
        let window = match (self.window, spectrum.window) {
            (Some(stated), _) => stated,
            (None, Some(written)) => Some(written),
            (None, None) => {
                found(Finding::caution("hann-assumed"));
                Some(Window::Hann)
            }
        };
        // The reader has taken a unit that the file states to SI already.
        let written = Some(&spectrum.meta.unit).filter(|u| u.is_known());
        let (factor, unit) = match (written, said.unit) {
            (Some(written), stated) => match stated.map(Unit::quantity).or(said.quantity) {
                Some(meant) if meant != written.quantity() => match (stated, said.calibration) {
                    // What one stored number stands for is stated in full.
                    (Some(stated), Some(_)) if is_raw(written) => {
                        (stated.factor() / taken(&spectrum.meta), stated.si())
                    }
                    _ => return Err(other_quantity(&recording.path, written, meant, said)),
                },
                _ => {
                    // A factor that a person states holds for what is stored.
                    let other = stated.filter(|s| !said.force && s.factor() != taken(&spectrum.meta));
                    let factor = other.map_or(1.0, |s| s.factor() / taken(&spectrum.meta));
                    if let Some(stated) = other {
                        let differs =
                            Finding::caution("sweep-unit-overrides-files").name("used", stated.symbol());
                        let differs = differs.name("file", written.symbol());
                        found(differs.number("factor", taken(&spectrum.meta)));
                    }
                    (factor, written.clone())
                }
            },
            (None, Some(stated)) => (stated.factor(), stated.si()),
            (None, None) => {
                let unit = Unit::of(said.quantity.unwrap_or(Quantity::Displacement));
                found(Finding::caution("response-unit-assumed").name("unit", unit.symbol()));
                (1.0, unit)
            }
        };
        let peak = if scaling == Scaling::Rms { std::f64::consts::SQRT_2 } else { 1.0 };
        Ok(Settled { factor: factor * said.calibration.unwrap_or(1.0) * peak, unit, window })
    }
}

/// What to try where values are levels.
const LINEAR: &str = "export linear amplitudes; levels in decibels are not read";

/// Refuses levels in decibels, unless a linear unit is stated by a person.
fn linear(path: &Path, meta: &Meta, said: &Said, findings: &mut Vec<Finding>) -> Result<()> {
    let unit = said.unit.filter(|unit| !said.force && unit.is_known());
    let finding = match (Decibel::of(meta), unit) {
        (Some(Decibel::Stated(words)), None) => {
            let found = format!("the file says that its values are decibels: {words:?}");
            return Err(Error::input(Place::file(path), found, "linear amplitudes").hint(LINEAR));
        }
        (Some(Decibel::Stated(words)), Some(unit)) => {
            Finding::doubt("decibels-overruled").name("words", words).name("unit", unit.symbol())
        }
        (Some(Decibel::Mentioned(words)), _) => Finding::caution("decibels-mentioned").name("words", words),
        (None, _) => return Ok(()),
    };
    if !findings.iter().any(|known| known.code == finding.code) {
        findings.push(finding);
    }
    Ok(())
}

/// Volts, or parts of full scale: what a sensor gave, and no quantity of the rig.
fn is_raw(unit: &Unit) -> bool {
    matches!(unit.quantity(), Quantity::Voltage | Quantity::Ratio)
}

/// The factor by which the reader took stored numbers to SI.
fn taken(meta: &Meta) -> f64 {
    let steps = meta.history.iter().filter(|step| step.name == "to_si").flat_map(|step| &step.arguments);
    steps.filter(|(key, _)| key == "factor").filter_map(|(_, factor)| factor.parse::<f64>().ok()).product()
}

fn other_quantity(path: &Path, written: &Unit, meant: Quantity, said: &Said) -> Error {
    let hint = match (is_raw(written), said.force) {
        (true, true) => "state the calibration of the force: newtons per stored number",
        (true, false) => "state unit and calibration: what one stored number stands for",
        (false, true) => "check that these are the force files, and not the response files",
        (false, false) => {
            "leave quantity and unit out, and the file is believed; or check that this is the channel you mean"
        }
    };
    let found = format!("the file says its values are in {written}, {}", written.quantity());
    Error::input(
        Place::file(path),
        found,
        if said.force { "a force, in N".to_owned() } else { format!("{meant}, as was stated") },
    )
    .hint(hint)
    .setting(if said.force { "force_calibration" } else { "calibration" })
}

fn no_spectrum(recording: &Recording) -> Error {
    let place = Place::file(&recording.path);
    match recording.records.as_slice() {
        [Record::Trace(_)] => Error::input(place, "a time trace", "a spectrum")
            .hint("list the spectra of the analyser, not its time records"),
        [Record::Frf(_)] => Error::input(place, "a frequency response function", "a spectrum")
            .hint("name it under [[frf]] in a campaign"),
        records => {
            Error::input(place, format!("{} records in the file", records.len()), "one spectrum a file")
                .hint("convert it first, and name one file a spectrum in the list")
        }
    }
}

/// Peak magnitudes of the one spectrum in a recording.
fn magnitudes(recording: &Recording, list: &SweepList, axis: &Axis, factor: f64) -> Result<Vec<f64>> {
    let place = || Place::file(&recording.path);
    let [Record::Spectrum(spectrum)] = recording.records.as_slice() else {
        return Err(no_spectrum(recording));
    };
    if let Values::Real(values) = &spectrum.values
        && let Some(i) = values.iter().position(|v| *v < 0.0)
    {
        let at =
            if i < spectrum.axis.len() { format!(" ({} Hz)", spectrum.axis.at(i)) } else { String::new() };
        let found = format!("negative magnitudes: are these decibels? Line {i}{at} holds {}", values[i]);
        return Err(Error::input(place(), found, "linear amplitudes, 0 or more").hint(LINEAR));
    }
    let mut magnitudes = spectrum.values.magnitudes();
    if magnitudes.len() != list.lines + 1 {
        return Err(Error::input(
            place(),
            format!("the file holds {} values", magnitudes.len()),
            format!("{} (the list says {} lines, and 0 Hz counts)", list.lines + 1, list.lines),
        )
        .hint("correct the number of lines in the list; or this one file was stored with another setting"));
    }
    if let Some(step) = spectrum.axis.step() {
        let expected = axis.step().unwrap_or(step);
        if (step / expected - 1.0).abs() > 1e-6 {
            return Err(Error::input(
                place(),
                format!("the lines of this file are {step} Hz apart"),
                format!("{expected} Hz, as base band and lines of the list say"),
            ));
        }
    }
    if let Some(i) = magnitudes.iter().position(|m| !m.is_finite()) {
        return Err(Error::input(place(), format!("line {i} is missing"), "a number in every line"));
    }
    for m in &mut magnitudes {
        *m *= factor;
    }
    Ok(magnitudes)
}

/// Findings of the files, each once; what a sweep settles for itself is not repeated.
fn gather(recording: &Recording, findings: &mut Vec<Finding>) {
    const SETTLED: [&str; 4] = ["scaling-unsaid", "unit-unsaid", "axis-unit-assumed", "abscissa-unsaid"];
    for found in recording.all_findings() {
        if !SETTLED.contains(&found.code) && findings.len() < 50 && !findings.contains(&found) {
            findings.push(found);
        }
    }
}
