//! What `vibro spectrum` says.

use crate::measure::spectral::SpectralResult;
use crate::report::tables;
use crate::units::notation::{estimate, significant};
use serde::Serialize;
use std::fmt::Write as _;

/// Most lines that a terminal shows.
const SHOWN: usize = 12;

#[derive(Serialize)]
pub struct Answer {
    #[serde(flatten)]
    pub result: SpectralResult,
    pub files: Vec<String>,
}

impl Answer {
    /// The largest lines, for a terminal.
    pub fn text(&self) -> String {
        let found = &self.result;
        let mut text = format!(
            "{}: {} lines, {} [{}], window {}, ENBW {:.4} lines, detrend {}, {} average(s)\n",
            found.name,
            found.frequency.len(),
            found.scaling,
            found.unit,
            found.window,
            found.enbw,
            found.detrend,
            found.averages
        );
        if let Some(unit) = &found.level_unit {
            let _ = writeln!(text, "levels in {unit}");
        }
        text.push_str("largest peaks (all lines: --json or --out):\n");
        for k in found.peaks(SHOWN) {
            let value = estimate(found.value[k], Some(found.value_std[k]));
            let _ = write!(text, "{:>12} Hz  {value:<24}", significant(found.frequency[k], 6));
            if let Some(level) = found.level.get(k) {
                let _ = write!(text, " {level:>8.2} dB");
            }
            if let Some(r) = &found.response {
                let _ = write!(text, " {:>8.2}° γ² {:.4}", r.phase[k], r.coherence[k]);
            }
            text.push('\n');
        }
        if !found.tones.is_empty() {
            let _ = write!(text, "\n{}", tables::tones(&[("", found)]).text());
        }
        for file in &self.files {
            let _ = writeln!(text, "wrote {file}");
        }
        text
    }
}
