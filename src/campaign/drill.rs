//! Hammer drills of a campaign: from keys to a file and options.

use super::{Campaign, DrillEntry, LowPass};
use crate::analysis::DrillFile;
use crate::error::Result;
use crate::measure::drill::{Beam, DrillOptions, Smoothing};

impl Campaign {
    /// The file of a drill's record and how it is measured.
    ///
    /// # Errors
    /// If a key is missing that has no default, or contradicts another; if a file leads outside the folder; if the beam sees
    /// nothing of the motion.
    pub fn drill(&self, entry: &DrillEntry, allow_outside: bool) -> Result<(DrillFile, DrillOptions)> {
        let record = entry.record();
        let wrong = |why: String| self.at(record.file.span(), why);
        let lacks = |key: &str| wrong(format!("[[drill]] needs {key}: there is no default for it"));
        let path = self.record_path(&record, allow_outside)?;
        let velocity = entry.velocity.clone().or(record.channel.clone()).ok_or_else(|| lacks("velocity"))?;
        let reference = entry.reference.clone().ok_or_else(|| lacks("reference"))?;
        let from = entry.from.ok_or_else(|| lacks("from = \"normal\" or \"axis\""))?;
        let angle = entry.beam_angle.ok_or_else(|| lacks("beam_angle"))?;
        let pulses = entry.pulses_per_turn.ok_or_else(|| lacks("pulses_per_turn"))?;
        let edge = entry.edge.ok_or_else(|| lacks("edge = \"rising\" or \"falling\""))?;
        if record.calibration.is_some() {
            return Err(wrong("a drill has no calibration but a sensitivity".to_owned()));
        }
        let smoothing = match (entry.low_pass, entry.smoothing) {
            (Some(_), Some(_)) => return Err(wrong("both low_pass and smoothing".to_owned())),
            (Some(LowPass::Corner(corner)), None) => Smoothing::LowPass(corner),
            (Some(LowPass::Off(_)), None) => Smoothing::Off,
            (None, Some(time)) => Smoothing::Exponential(time),
            (None, None) => Smoothing::default(),
        };
        let noise = entry.noise.as_ref().map(|file| self.beside(&record, file, allow_outside));
        let beam = Beam::new(angle, from).map_err(|e| e.in_file(self.path()))?;
        let plain = DrillOptions::new(entry.sensitivity.unwrap_or(f64::NAN), beam, pulses, edge);
        let options = DrillOptions {
            level: entry.level,
            mass: entry.mass,
            struck_mass: entry.struck_mass,
            contact: entry.contact.unwrap_or(plain.contact),
            fit: entry.fit.unwrap_or(plain.fit),
            smoothing,
            longest_dropout: entry.longest_dropout.unwrap_or(plain.longest_dropout),
            delay: entry.delay.unwrap_or(plain.delay),
            points: entry.points.unwrap_or(plain.points),
            margin: entry.margin.unwrap_or(plain.margin),
            instrument: entry.instrument,
            hours: entry.exposure,
            ..plain
        };
        let file = DrillFile {
            reader: record.reader(),
            path,
            velocity,
            reference,
            handle: entry.handle.clone(),
            handle_sensitivity: entry.handle_sensitivity,
            noise: noise.transpose()?,
        };
        Ok((file, options))
    }
}
