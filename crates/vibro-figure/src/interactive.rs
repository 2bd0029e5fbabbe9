//! Figures as JSON, for a report page that draws them itself.

use crate::style::{SeriesLook, looks};
use crate::{Axis, Figure, Heatmap, Key, Panel, Plot, Scale, Shape, Sheet, Waterfall};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use serde_json::{Value, json};

impl Figure {
    /// The figure as data for a page: panels with axes, series and matrices, with all values in the unit of
    /// their axes. Lists are base64 of 32-bit floats, least significant byte first. Matrices are added to
    /// those of the page; the figure refers to them by number. A panel that repeats an earlier one
    /// (`Plot::again`) is left out. `None` where a page cannot draw a panel, such as a grid of classes.
    pub fn data(&self, matrices: &mut Matrices) -> Option<Value> {
        let repeats = |panel: &&Panel| matches!(panel, Panel::Plot(plot) if plot.again);
        let (before, shown) = (matrices.len(), self.panels.iter().filter(|panel| !repeats(panel)));
        let Some(panels) = shown.map(|panel| panel.data(matrices)).collect::<Option<Vec<Value>>>() else {
            matrices.0.truncate(before);
            return None;
        };
        let aspect = if self.width > 0.0 { self.height / self.width } else { 0.6 };
        Some(
            json!({ "title": self.title, "columns": self.columns.max(1), "aspect": aspect, "panels": panels }),
        )
    }

    /// Whether a panel has a heat map. Its image for browsers without scripts would be half of a page's size.
    pub fn has_map(&self) -> bool {
        self.panels.iter().any(|panel| matches!(panel, Panel::Plot(plot) if plot.heatmap.is_some()))
    }
}

/// The matrices of a page, each stored once: a waterfall and a map may show the same one. A matrix is base64
/// of 16-bit levels: 0 for a missing value, else 1 at `low` to 65535 at `high` of the panel that shows
/// it. Levels are linear in the value, or in log₁₀ of the value for non-negative quantities.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Matrices(Vec<String>);

impl Matrices {
    /// Number of matrices.
    #[allow(clippy::len_without_is_empty)] // the number alone is used
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The number of a matrix; it is added if the page does not have it yet.
    fn number(&mut self, levels: String) -> usize {
        self.0.iter().position(|known| *known == levels).unwrap_or_else(|| {
            self.0.push(levels);
            self.0.len() - 1
        })
    }
}

impl Panel {
    /// The panel as data; `None` for a grid of classes, or without anything to show.
    fn data(&self, matrices: &mut Matrices) -> Option<Value> {
        match self {
            Panel::Plot(plot) => plot.data(matrices),
            Panel::Waterfall(waterfall) => waterfall.data(matrices),
            Panel::Grid(_) => None,
        }
    }
}

impl Axis {
    /// A value in the unit of the axis. On a logarithmic axis the value itself: the page leaves out values
    /// that are not above 0.
    fn in_unit(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value / 10f64.powi(self.power),
            Scale::Log => value,
            Scale::Db { .. } => self.scale.of(value),
        }
    }

    /// The axis as data: title, limits, and the factor or dB reference that converts matrix values.
    fn data(&self) -> Value {
        let log = self.scale == Scale::Log;
        let end = |u: f64| match self.scale {
            Scale::Log => 10f64.powf(u),
            Scale::Linear => u / 10f64.powi(self.power),
            Scale::Db { .. } => u,
        };
        let reference = if let Scale::Db { reference } = self.scale { Some(reference) } else { None };
        // Matrix value × `factor` = value in the axis' unit. On a decibel axis the page computes it from
        // `reference`.
        let factor = if self.scale == Scale::Linear { self.in_unit(1.0) } else { 1.0 };
        let (low, high) = (end(self.lo), end(self.hi));
        json!({ "title": self.title, "log": log, "low": low, "high": high, "reference": reference, "factor": factor })
    }

    /// Values in the unit of the axis, as base64 of 32-bit floats.
    fn list(&self, values: &[f64]) -> Value {
        floats(values.iter().map(|v| self.in_unit(*v)))
    }
}

impl Plot {
    /// The plot as data; `None` without anything to show.
    fn data(&self, matrices: &mut Matrices) -> Option<Value> {
        let (x, y) = Sheet::new(self, crate::plot::extents(self).0, true).axes?;
        let series: Vec<Value> = self
            .series
            .iter()
            .zip(looks(&self.series))
            .map(|(series, look)| {
                // Whether a line joins the points.
                let joined =
                    series.shape == Shape::Line || series.shape == Shape::Points && series.stroke.is_some();
                json!({
                    "name": series.name,
                    "shape": series.shape,
                    "x": x.list(&series.x),
                    "y": y.list(&series.y),
                    "low": y.list(&series.low),
                    "high": y.list(&series.high),
                    "std": floats(series.high.iter().zip(&series.y).map(|(high, value)| y.in_unit(*high) - y.in_unit(*value))),
                    "joined": joined,
                    "look": look.data(),
                })
            })
            .collect();
        let note =
            |note: &crate::Note| json!({ "text": note.text, "x": x.in_unit(note.x), "y": y.in_unit(note.y) });
        Some(json!({
            "kind": "plot",
            "title": self.title,
            "square": self.square,
            "x": x.data(),
            "y": y.data(),
            "series": series,
            "notes": self.notes.iter().map(note).collect::<Vec<_>>(),
            "map": self.heatmap.as_ref().and_then(|map| map.data(&x, &y, matrices)),
        }))
    }
}

impl Heatmap {
    /// The map as data: positions, matrix, and the meaning of the colours.
    fn data(&self, x: &Axis, y: &Axis, matrices: &mut Matrices) -> Option<Value> {
        let key = match &self.key {
            Key::Quantity(_) => self.colour_axis()?.data(),
            Key::Classes(names) => {
                let colours: Vec<String> =
                    (0..names.len()).map(|k| Heatmap::class_colour(k).to_string()).collect();
                json!({ "classes": names, "colours": colours })
            }
        };
        Some(json!({
            "x": x.list(&self.x),
            "y": y.list(&self.y),
            "z": levels(self.values.iter().copied(), matches!(self.key, Key::Quantity(_)), matrices),
            "key": key,
        }))
    }
}

impl Waterfall {
    /// The waterfall as data: axes, frequencies, excitations and matrix.
    fn data(&self, matrices: &mut Matrices) -> Option<Value> {
        let [x, depth, up] = self.axes()?;
        Some(json!({
            "kind": "waterfall",
            "record": self.record,
            "x": x.data(),
            "depth": depth.data(),
            "up": up.data(),
            "frequency": x.list(&self.frequency),
            "excitation": depth.list(&self.rows.iter().map(|row| row.0).collect::<Vec<_>>()),
            "z": levels(self.rows.iter().flat_map(|row| row.1.iter().copied()), true, matrices),
        }))
    }
}

impl SeriesLook {
    /// The look as data.
    fn data(&self) -> Value {
        json!({
            "colour": self.colour.to_string(),
            "width": self.pen.width,
            "dashes": self.pen.dashes,
            "marker": self.marker,
        })
    }
}

/// Base64 of 32-bit floats.
fn floats(values: impl Iterator<Item = f64>) -> Value {
    let bytes: Vec<u8> = values.flat_map(|v| (v as f32).to_le_bytes()).collect();
    Value::String(STANDARD.encode(bytes))
}

/// Decades below the largest magnitude that levels cover.
const DECADES: f64 = 8.0;

/// A matrix as 16-bit levels: 0 for a missing value, else 1 at `low` to 65535 at `high`. Levels are linear in
/// the value. If all values of a quantity are non-negative, they are linear in log₁₀ of the value, over at
/// most 8 decades in steps of 0.03 %; smaller values get level 1.
fn levels(values: impl Iterator<Item = f64> + Clone, quantity: bool, matrices: &mut Matrices) -> Value {
    let finite = values.clone().filter(|v| v.is_finite());
    let magnitudes = quantity && finite.clone().all(|v| v >= 0.0) && finite.clone().any(|v| v > 0.0);
    let scale = if magnitudes { Scale::Log } else { Scale::Linear };
    let ends = |(a, b): (f64, f64), v: f64| (a.min(v), b.max(v));
    let scaled = finite.map(|v| scale.of(v)).filter(|u| u.is_finite());
    let (mut low, high) = scaled.fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    if magnitudes {
        low = low.max(high - DECADES);
    }
    let span = if high > low { high - low } else { 1.0 };
    let level = |v: f64| match scale.of(v) {
        u if v.is_nan() || u.is_nan() => 0,
        u => 1 + (((u - low) / span).clamp(0.0, 1.0) * 65534.0).round() as u16,
    };
    let bytes: Vec<u8> = values.flat_map(|v| level(v).to_le_bytes()).collect();
    let number = matrices.number(STANDARD.encode(bytes));
    json!({ "levels": number, "low": low, "high": low + span, "log": magnitudes })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AxisSpec, Series};
    use ndarray::array;

    fn decoded(list: &Value) -> Vec<f32> {
        let bytes = STANDARD.decode(list.as_str().unwrap()).unwrap();
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
    }

    #[test]
    fn values_are_as_the_axes_show_them() {
        let plot = Plot::new(AxisSpec::frequency(), AxisSpec::new("Displacement", "m"))
            .with(Series::points("a", [1.0, 2.0], [0.001, 0.002]).y_error([1e-4, f64::NAN]));
        let data = Figure::single("x").panel(plot).data(&mut Matrices::default()).unwrap();
        let panel = &data["panels"][0];
        assert_eq!(panel["y"]["title"], "Displacement (mm)");
        assert_eq!(decoded(&panel["series"][0]["y"]), [1.0, 2.0]);
        let low = decoded(&panel["series"][0]["low"]);
        assert!((low[0] - 0.9).abs() < 1e-6 && low[1].is_nan());
    }

    /// 65534 steps of 8 decades are 0.028 % each, so a level is accurate to half of that.
    #[test]
    fn levels_keep_magnitudes_to_their_step() {
        let values = [1.0, 3e-4, 0.0, f64::NAN, 2e-9];
        let mut matrices = Matrices::default();
        let data = levels(values.into_iter(), true, &mut matrices);
        assert_eq!(data["levels"], 0);
        let bytes = STANDARD.decode(&matrices.0[0]).unwrap();
        let (low, high) = (data["low"].as_f64().unwrap(), data["high"].as_f64().unwrap());
        let value = |b: &[u8]| match u16::from_le_bytes([b[0], b[1]]) {
            0 => f64::NAN,
            level => 10f64.powf(low + f64::from(level - 1) / 65534.0 * (high - low)),
        };
        let found: Vec<f64> = bytes.chunks_exact(2).map(value).collect();
        assert!((found[0] - 1.0).abs() < 1.5e-4 && (found[1] / 3e-4 - 1.0).abs() < 1.5e-4, "{found:?}");
        assert!(found[3].is_nan());
        // Zero and values below eight decades have the lowest level.
        assert!((found[2] / 1e-8 - 1.0).abs() < 1.5e-4 && found[4] == found[2]);
        // Classes keep their distances, and the lowest has its own level.
        let classes = levels([0.0, 1.0, 2.0].into_iter(), false, &mut matrices);
        assert_eq!((classes["low"].as_f64(), classes["log"].as_bool()), (Some(0.0), Some(false)));
        let matrix = array![[1.0, 2.0], [3.0, f64::NAN]];
        let map = Heatmap::new(&[0.0, 1.0], &[0.0, 1.0], &matrix, AxisSpec::new("z", "m")).unwrap();
        let plot = Plot::new(AxisSpec::frequency(), AxisSpec::frequency()).heatmap(map);
        let figure = Figure::single("").panel(plot);
        assert!(figure.has_map());
        let data = figure.data(&mut matrices).unwrap();
        assert_eq!(data["panels"][0]["map"]["z"]["log"], true);
        assert_eq!((data["panels"][0]["map"]["z"]["levels"].as_u64(), matrices.len()), (Some(2), 3));
    }
}
