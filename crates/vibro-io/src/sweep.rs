//! Reads the spectra of a sweep together.

use crate::folder::Folder;
use crate::format::Format;
use crate::level;
use crate::reader::Reader;
use crate::recording::Recording;
use crate::sweep_list::SweepList;
use vibro_record::code;
use vibro_record::units::{Quantity, Unit};
use vibro_record::{
    Axis, Direction, Error, Finding, Meta, Place, Record, Result, Scaling, Spectrum, Sweep, SweepPoint,
    Values, Window,
};

/// Reads a sweep of spectra, with the settings of the analyser. A setting not stated here is taken from the
/// files. If both differ, the setting here is used with a finding, or the file is refused.
#[derive(Debug, Clone, Default)]
pub struct SweepReader {
    /// Name of the sweep.
    pub name: String,
    /// Direction, if stated.
    pub direction: Option<Direction>,
    /// Number of the measured mass, if stated.
    pub mass: Option<u8>,
    /// Unit in which responses are stored, if stated; else that of the files, else the SI unit of `quantity`
    /// is assumed, with a caution.
    pub unit: Option<Unit>,
    /// Quantity of the responses, if stated; else that of the unit, else a displacement is assumed.
    pub quantity: Option<Quantity>,
    /// Factor on stored responses, if stated, in `unit` per stored number, even if the files say volts.
    pub calibration: Option<f64>,
    /// Factor on stored forces, if stated, in N per stored number, even if the files say volts.
    pub force_calibration: Option<f64>,
    /// Window, if stated: `Some(None)` means unknown. Else that of the files, else Hann is assumed.
    pub window: Option<Option<Window>>,
    /// Peak or RMS, if stated; else that of the files, else peak is assumed.
    pub scaling: Option<Scaling>,
    /// Number of integrations (in frequency) that the analyser made before storing, if stated; else 1 is
    /// assumed for displacements, 0 for other responses.
    pub analyser_integrated: Option<u8>,
    /// Format of the files, detected if `None`.
    pub format: Option<Format>,
    /// Folder of the files.
    pub folder: Folder,
}

/// Factor from amplitudes of this scaling to peak amplitudes.
fn to_peak(scaling: Scaling, found: &mut impl FnMut(Finding)) -> Result<f64> {
    Ok(match scaling {
        Scaling::Peak => 1.0,
        Scaling::Rms => std::f64::consts::SQRT_2,
        Scaling::Unknown => {
            found(Finding::caution("peak-assumed"));
            1.0
        }
        other => {
            let scaled = format!("a spectrum scaled as {}", other.name());
            return Err(Error::usage(scaled, "peak or RMS amplitudes")
                .hint("export amplitudes; a density or a coherence has no amplitude of a single line"));
        }
    })
}

impl SweepReader {
    /// Reads all spectra of a list.
    ///
    /// # Errors
    /// If files are missing (all are named), cannot be read, or have another number of lines than the list
    /// states.
    pub fn read(&self, list: &SweepList) -> Result<Sweep> {
        let reader = Reader::new().within(&self.folder).base_band(Some(list.base_band)).format(self.format);
        // One batch, so that all missing files are named at once.
        let paths: Vec<_> = list.response.iter().chain(&list.force).collect();
        let mut recordings =
            reader.from_paths(&paths).map_err(|e| list.missing(&self.folder).unwrap_or(e))?;
        let mut forces = recordings.split_off(list.response.len()).into_iter();
        let axis = Axis::frequency(0.0, list.base_band / list.lines as f64, list.lines + 1);
        let (unit, calibration) = (Some(Unit::of(Quantity::Force)), self.force_calibration);
        let of_force = SweepReader { unit, quantity: None, calibration, ..self.clone() };
        let mut findings = Vec::new();
        let mut peaks = |recording: &Recording, settings: &SweepReader, force: bool| {
            settings.peaks(recording, force, &axis, &mut findings).map_err(|e| e.in_file(&recording.path))
        };
        let mut points: Vec<SweepPoint> = Vec::with_capacity(list.len());
        for (i, response) in recordings.iter().enumerate() {
            let force = forces.next().map(|force| peaks(&force, &of_force, true)).transpose()?;
            let (meta, values, window) = peaks(response, self, false)?;
            if let Some(first) = points.first().map(|p| &p.response.meta.unit).filter(|u| **u != meta.unit) {
                let found = format!("the values of this file are in {}", meta.unit);
                let expected = format!("{first}, as in the files before");
                return Err(Error::input(Place::file(&response.path), found, expected));
            }
            let (axis, enbw) = (axis.clone(), window.map(Window::enbw));
            points.push(SweepPoint {
                force_path: list.force.get(i).cloned(),
                response_path: list.response[i].clone(),
                force: force.map_or_else(Values::default, |(_, values, _)| values),
                given: list.excitation.get(i).copied(),
                response: Spectrum { meta, axis, values, scaling: Scaling::Peak, window, enbw },
            });
        }
        let displacement = points.iter().any(|p| p.response.meta.quantity == Quantity::Displacement);
        if self.analyser_integrated.is_none() && displacement {
            findings.push(Finding::caution("analyser-integration-assumed"));
        }
        Ok(Sweep {
            name: self.name.clone(),
            direction: self.direction,
            mass: self.mass,
            axis,
            analyser_integrated: self.analyser_integrated.unwrap_or(u8::from(displacement)),
            points,
            findings,
        })
    }

    /// Peak amplitudes of a response or a `force` in SI units, with metadata and window. The settings of
    /// this reader override the file's statements.
    fn peaks(
        &self,
        recording: &Recording,
        force: bool,
        axis: &Axis,
        findings: &mut Vec<Finding>,
    ) -> Result<(Meta, Values, Option<Window>)> {
        let [Record::Spectrum(spectrum)] = recording.records.as_slice() else {
            let found = match recording.records.as_slice() {
                [record] => format!("a {}", record.kind()),
                records => format!("{} records in the file", records.len()),
            };
            return Err(Error::usage(found, "one spectrum a file").hint(SPECTRA));
        };
        let mut found = |finding: Finding| {
            if !findings.contains(&finding) {
                findings.push(finding);
            }
        };
        if let Some(words) = level::decibels(&spectrum.meta) {
            let Some(unit) = self.unit.as_ref().filter(|unit| !force && unit.is_known()) else {
                let words = format!("the file says that its values are decibels: {words:?}");
                return Err(Error::usage(words, "linear amplitudes").hint(LINEAR));
            };
            let overruled = Finding::doubt("decibels-overruled").name("words", words);
            found(overruled.name("unit", unit.symbol()).without_estimate());
        }
        let scaling = self.scaling.unwrap_or(spectrum.scaling);
        let peak = to_peak(scaling, &mut found)?;
        let window = self.window.unwrap_or_else(|| {
            if spectrum.window.is_none() {
                found(Finding::caution("hann-assumed"));
            }
            spectrum.window.or(Some(Window::Hann))
        });
        let (factor, unit) = self.factor(&spectrum.meta, force, &mut found)?;
        let factor = factor * self.calibration.unwrap_or(1.0) * peak;
        let values = scaled(spectrum, axis, factor)?;
        if !force {
            gather(recording, findings);
        }
        let mut meta = spectrum.meta.clone();
        meta.findings.clear(); // reported once, for the whole sweep
        meta.step("calibrate", &[("factor", &factor), ("unit", &unit)]);
        meta.quantity = unit.quantity();
        meta.unit = unit;
        Ok((meta, values, window))
    }

    /// Factor from the values as read to SI units, and the SI unit.
    fn factor(&self, meta: &Meta, force: bool, found: &mut impl FnMut(Finding)) -> Result<(f64, Unit)> {
        // If the file states a unit, the reader has already multiplied the values by `taken`, to SI.
        let (written, taken) = (&meta.unit, meta.factor_to_si());
        let meant = self.meant();
        let raw = matches!(written.quantity(), Quantity::Voltage | Quantity::Ratio);
        let adopted = match &self.unit {
            Some(stated) if !written.is_known() => (stated.factor(), stated.si()),
            None if !written.is_known() => {
                let unit = Unit::of(self.quantity.unwrap_or(Quantity::Displacement));
                found(Finding::caution("response-unit-assumed").name("unit", unit.symbol()));
                (1.0, unit)
            }
            // The file is in volts or a ratio: a stated unit with a calibration replaces them.
            Some(stated) if meant != Some(written.quantity()) && raw && self.calibration.is_some() => {
                (stated.factor() / taken, stated.si())
            }
            _ if meant.is_some_and(|meant| meant != written.quantity()) => {
                return Err(self.other_quantity(written, raw, force));
            }
            // A stated unit is that of the stored numbers, so the conversion by `taken` is undone.
            Some(stated) if !force && stated.factor() != taken => {
                let differs = Finding::caution("sweep-unit-overrides-files").name("used", stated.symbol());
                found(differs.name("file", written.symbol()).number("factor", taken));
                (stated.factor() / taken, written.clone())
            }
            _ => (1.0, written.clone()),
        };
        Ok(adopted)
    }

    /// Quantity of the stated unit, else the stated quantity.
    fn meant(&self) -> Option<Quantity> {
        self.unit.as_ref().map(Unit::quantity).or(self.quantity)
    }

    fn other_quantity(&self, written: &Unit, raw: bool, force: bool) -> Error {
        let hint = match (raw, force) {
            (true, _) => "state unit and calibration: what one stored number stands for",
            (false, true) => "check that these are the force files, and not the response files",
            (false, false) => {
                "leave quantity and unit out to believe the file; or check that this is the channel you mean"
            }
        };
        let expected = match self.meant() {
            Some(meant) if !force => format!("{meant}, as was stated"),
            _ => "a force, in N".to_owned(),
        };
        Error::usage(format!("the file says its values are in {written}, {}", written.quantity()), expected)
            .hint(hint)
            .setting(if force { "force_calibration" } else { "calibration" })
    }
}

/// Hint for a file that holds anything but one spectrum.
const SPECTRA: &str = "list the spectra of the analyser; time records and frequency responses have tables of their own in a campaign";

/// Hint for values that are levels in dB.
const LINEAR: &str = "export linear amplitudes; levels in decibels are not read";

/// Values of a spectrum times `factor`; the spectrum must have the lines of `axis`.
fn scaled(spectrum: &Spectrum, axis: &Axis, factor: f64) -> Result<Values> {
    if let Values::Real(values) = &spectrum.values
        && let Some(i) = values.iter().position(|v| *v < 0.0)
    {
        let at =
            if i < spectrum.axis.len() { format!(" ({} Hz)", spectrum.axis.at(i)) } else { String::new() };
        let found = format!("negative magnitudes: are these decibels? Line {i}{at} holds {}", values[i]);
        return Err(Error::usage(found, "linear amplitudes, 0 or more").hint(LINEAR));
    }
    let magnitudes = spectrum.values.magnitudes();
    let n = axis.len();
    if magnitudes.len() != n {
        let expected = format!("{n} (the list says {} lines, and 0 Hz counts)", n - 1);
        return Err(Error::usage(format!("the file holds {} values", magnitudes.len()), expected).hint(
            "correct the number of lines in the list; or this one file was stored with another setting",
        ));
    }
    if let (Some(step), Some(expected)) = (spectrum.axis.step(), axis.step())
        && (step / expected - 1.0).abs() > 1e-6
    {
        let expected = format!("{expected} Hz, as base band and lines of the list say");
        return Err(Error::usage(format!("the lines of this file are {step} Hz apart"), expected));
    }
    if let Some(i) = magnitudes.iter().position(|m| !m.is_finite()) {
        return Err(Error::usage(format!("line {i} is missing"), "a number in every line"));
    }
    Ok(match &spectrum.values {
        Values::Real(_) => Values::Real(magnitudes.into_iter().map(|m| m * factor).collect()),
        Values::Complex(values) => Values::Complex(values.iter().map(|v| v * factor).collect()),
    })
}

/// Collects findings of the files, each once and at most 50. Findings on settings that the sweep decides
/// itself are dropped.
fn gather(recording: &Recording, findings: &mut Vec<Finding>) {
    const SETTLED: [&str; 4] =
        [code::SCALING_UNSAID, code::UNIT_UNSAID, code::AXIS_UNIT_ASSUMED, code::ABSCISSA_UNSAID];
    for found in recording.all_findings() {
        if !SETTLED.contains(&found.code.as_ref()) && findings.len() < 50 && !findings.contains(&found) {
            findings.push(found);
        }
    }
}
