//! Entries of a campaign.

use crate::read::SweepReader;
use crate::record::{Direction, Scaling, Window};
use crate::units::{Quantity, Unit};
use serde::Deserialize;
use std::ops::Range;
use std::path::PathBuf;
use toml::Spanned;

/// What drives mass 1 in all sweeps.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// `sine`.
    #[serde(default)]
    pub kind: DriveKind,
    /// Force amplitude in N; left out, the measured force is taken.
    pub force: Option<f64>,
}

/// Kinds of excitation of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DriveKind {
    /// Harmonic force.
    #[default]
    Sine,
}

/// One stepped-sine sweep of one mass.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepEntry {
    /// Name, unique in the campaign.
    pub name: Spanned<String>,
    /// `up` or `down`.
    pub direction: Option<Direction>,
    /// 1 excited mass, 2 passive mass.
    pub mass: Option<Spanned<u8>>,
    /// List file or hand-over file.
    pub list: Option<Spanned<PathBuf>>,
    /// Force files, instead of a list.
    #[serde(default)]
    pub force: Vec<PathBuf>,
    /// Response files, instead of a list.
    #[serde(default)]
    pub response: Vec<PathBuf>,
    /// Spectral lines, instead of a list.
    pub lines: Option<usize>,
    /// Base band in Hz, instead of a list.
    pub base_band: Option<f64>,
    /// What the analyser stored: displacement, velocity or acceleration. Default displacement.
    pub quantity: Option<Spanned<String>>,
    /// Unit in which it was stored. Default SI, with a warning.
    pub unit: Option<Spanned<String>>,
    /// Factor on stored responses. Default 1.
    pub calibration: Option<Spanned<f64>>,
    /// Factor on stored forces, to newtons. Default 1.
    pub force_calibration: Option<Spanned<f64>>,
    /// Window of the analyser, or `unknown`. Default Hann, with a warning.
    pub window: Option<Spanned<String>>,
    /// `peak` or `rms`. Default peak, with a warning.
    pub scaling: Option<Scaling>,
    /// How often the analyser integrated before it stored. Default once for a displacement.
    pub analyser_integrated: Option<Spanned<u8>>,
}

/// A value that cannot be, and where it stands.
pub(super) struct Complaint {
    pub span: Range<usize>,
    pub found: String,
    pub hint: String,
}

fn complaint(span: Range<usize>, found: impl Into<String>, hint: impl Into<String>) -> Complaint {
    Complaint { span, found: found.into(), hint: hint.into() }
}

impl SweepEntry {
    pub(super) fn check(&self) -> Result<(), Complaint> {
        let written = !self.response.is_empty();
        if self.list.is_some() == written {
            let found =
                if written { "both a list and response files" } else { "neither a list nor response files" };
            return Err(complaint(
                self.name.span(),
                found,
                "give list = \"…\", or force, response, lines and base_band",
            ));
        }
        if let (Some(list), true) = (&self.list, self.lines.is_some() || self.base_band.is_some()) {
            let found = "lines or base_band beside a list, which says both itself";
            return Err(complaint(list.span(), found, "correct the list, or leave the keys out"));
        }
        if written {
            let band = self.base_band.is_some_and(|b| b.is_finite() && b > 0.0);
            if !band || self.lines.is_none_or(|l| l == 0) || self.force.len() != self.response.len() {
                let said = |value: Option<String>| value.unwrap_or_else(|| "left out".to_owned());
                let found = format!(
                    "{} force and {} response files, lines {}, base_band {}",
                    self.force.len(),
                    self.response.len(),
                    said(self.lines.map(|n| n.to_string())),
                    said(self.base_band.map(|b| b.to_string()))
                );
                return Err(complaint(
                    self.name.span(),
                    found,
                    "as many force as response files, and both numbers above 0",
                ));
            }
        }
        if let Some(mass) = self.mass.as_ref().filter(|m| !matches!(m.get_ref(), 1 | 2)) {
            return Err(complaint(
                mass.span(),
                format!("mass = {}", mass.get_ref()),
                "1 (excited) or 2 (passive)",
            ));
        }
        for (name, factor) in
            [("calibration", &self.calibration), ("force_calibration", &self.force_calibration)]
        {
            if let Some(bad) = factor.as_ref().filter(|f| !(f.get_ref().is_finite() && *f.get_ref() > 0.0)) {
                return Err(complaint(
                    bad.span(),
                    format!("{name} = {}", bad.get_ref()),
                    "a finite number above 0",
                ));
            }
        }
        if let Some(many) = self.analyser_integrated.as_ref().filter(|n| *n.get_ref() > 2) {
            return Err(complaint(
                many.span(),
                format!("analyser_integrated = {}", many.get_ref()),
                "0, 1 or 2",
            ));
        }
        if let Some(scaling) = self.scaling.filter(|s| !matches!(s, Scaling::Peak | Scaling::Rms)) {
            return Err(complaint(self.name.span(), format!("scaling = {}", scaling.name()), "peak or rms"));
        }
        self.check_names()
    }

    fn check_names(&self) -> Result<(), Complaint> {
        if let Some(window) = self.window.as_ref()
            && !window.get_ref().eq_ignore_ascii_case("unknown")
            && Window::from_name(window.get_ref()).is_none()
        {
            let names: Vec<_> = Window::ALL.iter().map(|w| w.name()).collect();
            let found = format!("the window {:?} is not known", window.get_ref());
            return Err(complaint(window.span(), found, format!("{} or unknown", names.join(", "))));
        }
        let motion =
            |q: Quantity| matches!(q, Quantity::Displacement | Quantity::Velocity | Quantity::Acceleration);
        let mut quantity = None;
        if let Some(text) = self.quantity.as_ref() {
            quantity = Quantity::from_name(text.get_ref()).filter(|q| motion(*q));
            if quantity.is_none() {
                let found = format!("the quantity {:?} is not known", text.get_ref());
                return Err(complaint(text.span(), found, "displacement, velocity or acceleration"));
            }
        }
        if let Some(text) = self.unit.as_ref() {
            let unit = Unit::parse_or_opaque(text.get_ref());
            let of = unit.quantity();
            if !motion(of) || quantity.is_some_and(|q| q != of) {
                let found = format!("the unit {:?} is one of {of}", text.get_ref());
                let (expected, such) = match quantity {
                    Some(Quantity::Displacement) => ("displacement", "m, mm or µm"),
                    Some(Quantity::Velocity) => ("velocity", "m/s or mm/s"),
                    Some(Quantity::Acceleration) => ("acceleration", "m/s², mm/s² or g"),
                    _ => ("displacement, velocity or acceleration", "mm, mm/s or g"),
                };
                return Err(complaint(text.span(), found, format!("a unit of {expected}, such as {such}")));
            }
        }
        Ok(())
    }

    /// How the files of this sweep are to be read.
    pub fn reader(&self) -> SweepReader {
        let quantity = self.quantity.as_ref().and_then(|q| Quantity::from_name(q.get_ref()));
        let unit = self.unit.as_ref().map(|u| Unit::parse_or_opaque(u.get_ref()));
        SweepReader {
            name: self.name.get_ref().clone(),
            direction: self.direction,
            mass: self.mass.as_ref().map(|m| *m.get_ref()),
            unit,
            quantity,
            calibration: self.calibration.as_ref().map(|f| *f.get_ref()),
            force_calibration: self.force_calibration.as_ref().map(|f| *f.get_ref()),
            window: self.window.as_ref().map(|w| Window::from_name(w.get_ref())),
            scaling: self.scaling,
            analyser_integrated: self.analyser_integrated.as_ref().map(|n| *n.get_ref()),
            format: None,
        }
    }
}

/// What to compute, and how.
#[derive(Debug, Clone, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Compute {
    /// Overlay measured responses on the model. Default: where a rig is given.
    pub overlay: bool,
    /// Draw waterfalls. Default true.
    pub waterfall: bool,
    /// Lines on both sides of the excitation in which a peak is looked for. Default 3.
    pub band: usize,
    /// Cut-off in Hz. Default: two lines or a quarter of the lowest excitation.
    pub fmin: Option<f64>,
    /// Highest frequency in waterfalls, in Hz. Default: the base band.
    pub fmax: Option<f64>,
}

impl Compute {
    /// What cannot be: key and sentence.
    pub(super) fn check(&self) -> Result<(), (&'static str, String)> {
        for (key, value) in [("fmin", self.fmin), ("fmax", self.fmax)] {
            if let Some(v) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return Err((key, format!("{key} = {v} is not a finite number above 0")));
            }
        }
        if !(1..=1000).contains(&self.band) {
            return Err(("band", format!("band = {} is not between 1 and 1000 lines", self.band)));
        }
        Ok(())
    }
}

impl Default for Compute {
    fn default() -> Compute {
        Compute { overlay: true, waterfall: true, band: 3, fmin: None, fmax: None }
    }
}
