//! The spectra of a sweep, read together.

use super::{Format, Reader, Recording, SweepList};
use crate::error::{Error, Place, Result};
use crate::record::{Axis, Direction, Record, Scaling, Spectrum, Sweep, SweepPoint, Values, Window};
use crate::units::{Quantity, Unit};

/// What the analyser stored, as far as its files do not say.
#[derive(Debug, Clone)]
pub struct SweepReader {
    /// Name of the sweep.
    pub name: String,
    /// Direction, if stated.
    pub direction: Option<Direction>,
    /// Mass, if stated.
    pub mass: Option<u8>,
    /// Unit in which responses are stored.
    pub unit: Unit,
    /// Factor on stored responses: unit per stored number.
    pub calibration: f64,
    /// Factor on stored forces: newtons per stored number.
    pub force_calibration: f64,
    /// Window, `None` if unknown and not to be assumed.
    pub window: Option<Window>,
    /// Whether the window was assumed rather than stated.
    pub window_assumed: bool,
    /// Peak or RMS.
    pub scaling: Scaling,
    /// Whether the scaling was assumed rather than stated.
    pub scaling_assumed: bool,
    /// How often the analyser integrated in frequency before it stored; `None` if not stated.
    pub analyser_integrated: Option<u8>,
    /// Format of the files, found out if `None`.
    pub format: Option<Format>,
}

impl Default for SweepReader {
    /// Displacement in m, Hann window and peak amplitudes, both assumed.
    fn default() -> Self {
        SweepReader {
            name: String::new(),
            direction: None,
            mass: None,
            unit: Unit::of(Quantity::Displacement),
            calibration: 1.0,
            force_calibration: 1.0,
            window: Some(Window::Hann),
            window_assumed: true,
            scaling: Scaling::Peak,
            scaling_assumed: true,
            analyser_integrated: None,
            format: None,
        }
    }
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
        let mut recordings = reader.from_paths(&paths)?;
        let forces = recordings.split_off(list.response.len());
        let axis = Axis::frequency(0.0, list.base_band / list.lines as f64, list.lines + 1);
        let mut doubts = Vec::new();
        if self.window_assumed {
            doubts.push("The files do not name their window: Hann is assumed.".to_owned());
        }
        if self.scaling_assumed {
            doubts.push("The files do not name their scaling: peak amplitudes are assumed.".to_owned());
        }
        let displacement = self.unit.quantity() == Quantity::Displacement;
        let analyser_integrated = self.analyser_integrated.unwrap_or(u8::from(displacement));
        if self.analyser_integrated.is_none() && displacement {
            doubts.push(
                "The files do not say how the displacement was measured: one integration of a velocity in the analyser is assumed."
                    .to_owned(),
            );
        }
        let mut points = Vec::with_capacity(list.len());
        for (i, response) in recordings.into_iter().enumerate() {
            let force = match forces.get(i) {
                Some(recording) => {
                    self.spectrum(recording, list, &axis, self.force_calibration, &mut doubts)?
                }
                None => Vec::new(),
            };
            let calibration = self.calibration * self.unit.factor();
            let values = self.spectrum(&response, list, &axis, calibration, &mut doubts)?;
            let mut meta = response.records.into_iter().next().map_or_else(
                || crate::record::Meta::new("", self.unit.si()),
                |mut record| std::mem::replace(record.meta_mut(), crate::record::Meta::new("", Unit::none())),
            );
            meta.unit = self.unit.si();
            meta.quantity = meta.unit.quantity();
            meta.doubts.clear(); // said once, for the sweep
            meta.step("calibrate", &[("factor", &calibration), ("unit", &meta.unit.clone())]);
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
                    window: self.window,
                    enbw: self.window.map(Window::enbw),
                },
            });
        }
        Ok(Sweep {
            name: self.name.clone(),
            direction: self.direction,
            mass: self.mass,
            axis,
            analyser_integrated,
            points,
            doubts,
        })
    }

    /// Peak magnitudes of the one spectrum in a recording.
    fn spectrum(
        &self,
        recording: &Recording,
        list: &SweepList,
        axis: &Axis,
        calibration: f64,
        doubts: &mut Vec<String>,
    ) -> Result<Vec<f64>> {
        let place = || Place::file(&recording.path);
        let [record] = recording.records.as_slice() else {
            return Err(Error::input(
                place(),
                format!("{} records in the file", recording.records.len()),
                "one spectrum a file",
            )
            .hint("convert it first, and name one file a spectrum in the list"));
        };
        let mut magnitudes = match record {
            Record::Spectrum(s) => s.values.magnitudes(),
            Record::Frf(f) => f.values.iter().map(|v| v.norm()).collect(),
            Record::Trace(_) => {
                return Err(Error::input(place(), "a time trace", "a spectrum")
                    .hint("list the spectra of the analyser, not its time records"));
            }
        };
        if magnitudes.len() != list.lines + 1 {
            return Err(Error::input(
                place(),
                format!("the file holds {} values", magnitudes.len()),
                format!("{} (the list says {} lines, and 0 Hz counts)", list.lines + 1, list.lines),
            )
            .hint(
                "correct the number of lines in the list; or this one file was stored with another setting",
            ));
        }
        if let Some(step) = record.axis().step() {
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
        let factor = match self.scaling {
            Scaling::Rms => calibration * std::f64::consts::SQRT_2,
            _ => calibration,
        };
        if factor != 1.0 {
            for m in &mut magnitudes {
                *m *= factor;
            }
        }
        for doubt in recording.all_doubts() {
            let scaling = doubt.starts_with("The file does not say how its spectrum is scaled");
            if !scaling && doubts.len() < 50 && !doubts.contains(&doubt) {
                doubts.push(doubt);
            }
        }
        Ok(magnitudes)
    }
}
