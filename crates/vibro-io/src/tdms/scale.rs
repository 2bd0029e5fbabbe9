//! From raw values to measured ones: the scales `NI_Scale[0]`, `NI_Scale[1]`, … of a channel, the last of which gives the result.

use super::segment::{Object, Slot};
use num_complex::Complex64;
use vibro_record::Values;

/// The input that is the raw values themselves.
const RAW: u32 = u32::MAX;

/// The scales of a channel: its own, else those of its group or of the file.
pub struct Scales<'a> {
    from: &'a Object,
    n: u32,
}

impl<'a> Scales<'a> {
    /// The scales that hold for `channel`.
    pub fn of(objects: &'a [Object], channel: &'a Object) -> Scales<'a> {
        let above =
            objects.iter().filter(|o| channel.path.starts_with(&o.path) && o.path.len() < channel.path.len());
        let mut holders: Vec<&Object> = above.collect();
        holders.sort_by_key(|o| std::cmp::Reverse(o.path.len()));
        // Older files do not say how many there are.
        let index = |key: &str| key.strip_prefix("NI_Scale[")?.split_once("]_Scale_Type")?.0.parse().ok();
        let last = |o: &Object| o.properties.iter().filter_map(|(key, _)| index(key)).max();
        let count = |o: &Object| {
            let said = o.number("NI_Number_Of_Scales").map(|n| n as u32);
            said.or_else(|| last(o).map(|i: u32| i.saturating_add(1))).unwrap_or(0)
        };
        let from = std::iter::once(channel).chain(holders).find(|o| count(o) > 0);
        from.map_or(Scales { from: channel, n: 0 }, |from| Scales { from, n: count(from) })
    }

    /// The measured values of raw `columns`, one a slot.
    ///
    /// # Errors
    /// The scale that is not known.
    pub fn apply(&self, slots: &[Slot], mut columns: Vec<Vec<f64>>) -> Result<Values, String> {
        if let ([Slot::Real, Slot::Imaginary], 0) = (slots, self.n) {
            let (imaginary, real) = (columns.pop().unwrap_or_default(), columns.pop().unwrap_or_default());
            let pairs = real.into_iter().zip(imaginary);
            return Ok(Values::Complex(pairs.map(|(re, im)| Complex64::new(re, im)).collect()));
        }
        let raw = |id: u32| slots.iter().position(|slot| *slot == Slot::Scaler(id)).unwrap_or(0);
        if self.n == 0 {
            return Ok(Values::Real(columns.swap_remove(0)));
        }
        self.value(self.n - 1, self.n, &mut |id| columns.get(raw(id)).cloned().unwrap_or_default())
            .map(Values::Real)
    }

    /// What scale `i` gives, after at most `depth` others.
    fn value(&self, i: u32, depth: u32, raw: &mut dyn FnMut(u32) -> Vec<f64>) -> Result<Vec<f64>, String> {
        let number = |key: &str| self.from.number(&format!("NI_Scale[{i}]_{key}"));
        let Some(kind) = self.from.text(&format!("NI_Scale[{i}]_Scale_Type")) else {
            // The scaler of a DAQmx channel, which stands in the layout of its raw data.
            return Ok(raw(i));
        };
        if depth == 0 {
            return Err(format!("{kind}, whose input leads back to itself"));
        }
        let mut input = |key: &str| match number(key).map_or(RAW, |n| n as u32) {
            RAW => Ok(raw(RAW)),
            source => self.value(source, depth - 1, raw),
        };
        let missing = |what: &str| format!("{kind} without {what}");
        let list = |name: &str| -> Result<Vec<f64>, String> {
            // Four is NI's rule where the number of coefficients is left out.
            let n = number(&format!("{name}_Size")).unwrap_or(4.0);
            (0..n as u32).map(|j| number(&format!("{name}[{j}]")).ok_or_else(|| missing(name))).collect()
        };
        let each = |values: Vec<f64>, f: &dyn Fn(f64) -> f64| Ok(values.into_iter().map(f).collect());
        match kind {
            "Linear" => {
                let slope = number("Linear_Slope").ok_or_else(|| missing("Linear_Slope"))?;
                let intercept = number("Linear_Y_Intercept").ok_or_else(|| missing("Linear_Y_Intercept"))?;
                each(input("Linear_Input_Source")?, &|v| v * slope + intercept)
            }
            "Polynomial" => {
                let all: Vec<f64> = list("Polynomial_Coefficients")?;
                each(input("Polynomial_Input_Source")?, &|v| all.iter().rev().fold(0.0, |sum, c| sum * v + c))
            }
            "Table" => {
                let (from, to) = (list("Table_Pre_Scaled_Values")?, list("Table_Scaled_Values")?);
                let mut table: Vec<(f64, f64)> = from.into_iter().zip(to).collect();
                table.sort_by(|a, b| a.0.total_cmp(&b.0));
                if table.len() < 2 || table.windows(2).any(|w| w[0].0 == w[1].0) {
                    return Err(missing("a table that rises"));
                }
                each(input("Table_Input_Source")?, &|v| between(&table, v))
            }
            "Add" | "Subtract" => {
                let left = input(&format!("{kind}_Left_Operand_Input_Source"))?;
                let right = input(&format!("{kind}_Right_Operand_Input_Source"))?;
                // NI subtracts the left operand from the right one.
                let sign = if kind == "Add" { 1.0 } else { -1.0 };
                Ok(right.into_iter().zip(left).map(|(right, left)| right + sign * left).collect())
            }
            // It says who scales, and changes nothing.
            "AdvancedAPI" => input("AdvancedAPI_Input_Source"),
            other => Err(other.to_owned()),
        }
    }
}

/// A value of a table, straight between its rows and constant beyond them.
fn between(table: &[(f64, f64)], at: f64) -> f64 {
    let above = table.partition_point(|(x, _)| *x <= at);
    let (Some((x0, y0)), Some((x1, y1))) = (above.checked_sub(1).map(|i| table[i]), table.get(above)) else {
        return if above == 0 { table[0].1 } else { table[table.len() - 1].1 };
    };
    y0 + (y1 - y0) / (x1 - x0) * (at - x0)
}
