//! Reads the traces of a stepped sine.

use crate::reader::Reader;
use crate::sweep::SweepReader;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use vibro_record::units::{Quantity, Unit};
use vibro_record::{Error, Result, StepTraces, Trace};

/// Traces of a stepped sine: one file for each step, or one file with a force and a response channel for
/// each step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Steps {
    /// Files, in the order of the steps.
    pub files: Vec<PathBuf>,
    /// Name of the force channel; for a single file, one name for each step.
    pub force: Vec<String>,
    /// Name of the response channel; for a single file, one name for each step.
    pub response: Vec<String>,
    /// Sampling rate in Hz, if the files do not state it.
    pub rate: Option<f64>,
}

impl SweepReader {
    /// Reads force and response of all steps in SI units, with stated calibrations. A response of unknown
    /// unit gets the stated unit. A step gets its own error if its file cannot be read or lacks a channel,
    /// if its force is no force, or if its response is no motion.
    ///
    /// # Errors
    /// If there are several files and several channels of force or response.
    pub fn steps(&self, steps: &Steps) -> Result<Vec<(PathBuf, Result<StepTraces>)>> {
        let reader = Reader::new().within(&self.folder).rate(steps.rate).format(self.format);
        let one = |file: &Path, force: &str, response: &str| {
            let recording = reader.from_path(file)?;
            let trace = |name: &str| {
                let trace = recording.trace(Some(name), None);
                trace.map_err(|e| e.hint("one of these names; all files of a sweep have the same channels"))
            };
            let (force, mut response) = (self.force(trace(force)?)?, self.response(trace(response)?)?);
            response.meta.findings.extend(recording.findings);
            Ok(StepTraces { path: file.to_owned(), force, response })
        };
        let one = |file: &PathBuf, force: &str, response: &str| {
            (file.clone(), one(file, force, response).map_err(|e: Error| e.in_file(file)))
        };
        match (steps.files.as_slice(), steps.force.as_slice(), steps.response.as_slice()) {
            (files, [force], [response]) => {
                Ok(files.par_iter().map(|file| one(file, force, response)).collect())
            }
            ([file], forces, responses) => {
                let pairs = forces.par_iter().zip(responses.par_iter());
                let pair = |(force, response): (&String, &String)| {
                    // The name of the response channel distinguishes the steps.
                    let path = PathBuf::from(format!("{}#{response}", file.display()));
                    let (_, step) = one(file, force, response);
                    (path.clone(), step.map(|step| StepTraces { path, ..step }))
                };
                Ok(pairs.map(pair).collect())
            }
            (files, forces, _) => {
                let found = format!("{} files and {} channels of force", files.len(), forces.len());
                Err(Error::usage(found, "one channel of force and one of response in each file")
                    .setting("force"))
            }
        }
    }

    fn force(&self, mut trace: Trace) -> Result<Trace> {
        if let Some(factor) = self.force_calibration {
            trace.calibrate(factor, &Unit::of(Quantity::Force))?;
        }
        if trace.meta.unit.is_known() && trace.meta.quantity != Quantity::Force {
            let found = format!("the channel {:?} is in {}", trace.meta.name, trace.meta.unit);
            let hint = "state force_calibration: newtons per stored number";
            return Err(Error::usage(found, "a force, in N")
                .hint(hint)
                .setting("force_calibration")
                .setting("force"));
        }
        Ok(trace)
    }

    fn response(&self, mut trace: Trace) -> Result<Trace> {
        let stored = trace.meta.unit.clone();
        let stated = self.unit.clone().or_else(|| self.quantity.map(Unit::of));
        match (&stated, self.calibration) {
            (Some(unit), Some(factor)) => trace.calibrate(factor, unit)?,
            (Some(unit), None) if !stored.is_known() => trace.calibrate(1.0, unit)?,
            (None, Some(factor)) => trace.calibrate(factor, &stored)?,
            _ => {}
        }
        let motion = [Quantity::Displacement, Quantity::Velocity, Quantity::Acceleration];
        let meant = stated.map(|unit| unit.quantity());
        if !motion.contains(&trace.meta.quantity) || meant.is_some_and(|meant| meant != trace.meta.quantity) {
            let found = format!("the channel {:?} is in {}", trace.meta.name, trace.meta.unit);
            let Some(meant) = meant.filter(|_| motion.contains(&trace.meta.quantity)) else {
                let error = Error::usage(found, "a displacement, velocity or acceleration");
                return Err(error.hint("another channel; or state its unit and calibration").setting("unit"));
            };
            let error = Error::usage(found, format!("the {} that was stated", meant.name()));
            return Err(error.hint("leave the unit out to use that of the file").setting("unit"));
        }
        Ok(trace)
    }
}
