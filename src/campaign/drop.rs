//! What entries of drops must have, or may not have together.

use super::DropEntry;
use super::fault::{Fault, fault};
use crate::measure::restitution::Velocities;

/// Velocities after an impact: of mass 1 and of mass 2.
type After = (Option<f64>, Option<f64>);

impl DropEntry {
    /// The velocities of one impact; `None` where the entry has none.
    pub fn velocities(&self) -> Option<Velocities> {
        let before = self.before?;
        let (after1, after2) = self.after()?;
        Some(Velocities { before, after1, after2, masses: self.masses, std: self.velocity_std })
    }

    fn after(&self) -> Option<After> {
        match (self.after.as_slice(), self.after2) {
            ([one], two) => Some((Some(*one), two)),
            ([one, two], None) => Some((Some(*one), Some(*two))),
            ([], Some(two)) => Some((None, Some(two))),
            _ => None,
        }
    }

    pub(super) fn check_keys(&self) -> Result<(), Fault> {
        let typed = self.interval.is_some() || !self.intervals.is_empty();
        let moving = [
            ("after", !self.after.is_empty()),
            ("after2", self.after2.is_some()),
            ("velocity_std", self.velocity_std.is_some()),
        ];
        if self.interval.is_some() && !self.intervals.is_empty() {
            let expected = "one of them: the first of intervals is that after the fall";
            return Err(fault("intervals", "both interval and intervals", expected));
        }
        if self.record().is_some() && typed {
            let key = if self.interval.is_some() { "interval" } else { "intervals" };
            return Err(fault(key, "a file and an interval", "one of them"));
        }
        if self.interval.is_some() && self.height.is_none() {
            return Err(fault("interval", "interval without a height", "both, or flight times as intervals"));
        }
        if let Some((key, _)) = moving.iter().find(|(_, given)| *given && self.before.is_none()) {
            return Err(fault(key, format!("{key} without before"), "both"));
        }
        if self.record().is_none() && !typed && self.before.is_none() {
            let expected = "file, interval, intervals, or before and after";
            return Err(fault("", "nothing that was measured", expected));
        }
        if self.before.is_some() && self.after().is_none() {
            let found = match (self.after.len(), self.after2) {
                (0, _) => "before without velocities after the impact".to_owned(),
                (n, Some(_)) => format!("{n} velocities in after, and after2"),
                (n, None) => format!("{n} velocities in after"),
            };
            let expected = "after = [V1, V2], or after = [V1] or after2 = V2 with masses";
            return Err(fault("before", found, expected));
        }
        Ok(())
    }

    /// Entries of one name are drops of one series, whose keys are equal.
    pub(super) fn check_series(&self, earlier: &[DropEntry]) -> Result<(), Fault> {
        let Some(name) = &self.name else { return Ok(()) };
        let mut series = earlier.iter().filter(|e| e.name.as_ref() == Some(name)).peekable();
        if let Some(key) = series.peek().and_then(|first| differing(first, self)) {
            return Err(fault(
                key,
                format!("a drop of {name:?} has another {key} than the first of that name"),
                "drops of one series have equal keys: give this one another name, or the same value",
            ));
        }
        if self.before.is_some() && series.any(|e| e.before.is_some()) {
            let found = format!("two drops of {name:?} have velocities");
            return Err(fault("before", found, "one impact with velocities a name"));
        }
        Ok(())
    }
}

/// The first key of which two drops of one series have different values.
fn differing(a: &DropEntry, b: &DropEntry) -> Option<&'static str> {
    let keys = |e: &DropEntry| {
        [
            ("height", e.height),
            ("height_std", e.height_std),
            ("interval_std", e.interval_std),
            ("gravity", e.gravity),
            ("gravity_std", e.gravity_std),
            ("threshold", e.threshold),
            ("refractory", e.refractory),
            ("keep_hum", Some(f64::from(u8::from(e.keep_hum)))),
            ("masses", e.masses.map(|m| m.0)),
            ("masses", e.masses.map(|m| m.1)),
        ]
    };
    keys(a).iter().zip(keys(b)).find(|(a, b)| a.1 != b.1).map(|(a, _)| a.0)
}
