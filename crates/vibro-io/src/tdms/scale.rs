//! Converts raw values to measured values with the scales `NI_Scale[0]`, `NI_Scale[1]`, … of a channel. The
//! last scale gives the result.

use super::description::Slot;
use super::segment::Object;
use std::collections::BTreeSet;
use vibro_record::{Values, sort_by_number};

/// Input number that means the raw values.
const RAW: u32 = u32::MAX;

/// The scales of a channel: its own, else those of its group or of the file.
pub struct Scales<'a> {
    from: &'a Object,
    n: u32,
}

/// Conversion of a scale's inputs to its values.
enum Conversion {
    /// Raw values of a column.
    Raw(usize),
    /// Coefficients, of the lowest power first.
    Polynomial(Vec<f64>),
    /// Rows of input and output, in rising order of the input.
    Table(Vec<(f64, f64)>),
    /// The first input plus the second times this sign.
    Sum(f64),
}

impl<'a> Scales<'a> {
    /// The scales that apply to `channel`; `above` are the file and its groups, groups first.
    pub fn of(above: &[&'a Object], channel: &'a Object) -> Scales<'a> {
        // Older files do not state the number of scales: it follows from their highest index.
        let index = |key: &str| key.strip_prefix("NI_Scale[")?.split_once("]_Scale_Type")?.0.parse().ok();
        let last = |o: &Object| o.properties.keys().filter_map(|key| index(key)).max();
        let count = |o: &Object| {
            let said = o.number("NI_Number_Of_Scales").map(|n| n as u32);
            said.or_else(|| last(o).map(|i: u32| i.saturating_add(1))).unwrap_or(0)
        };
        let holders = above.iter().copied().filter(|o| channel.path.starts_with(&o.path));
        let from = std::iter::once(channel).chain(holders).find(|o| count(o) > 0);
        // Values stored already scaled still list their scales; these are not applied again.
        let from = from.filter(|from| from.text("NI_Scaling_Status") != Some("scaled"));
        from.map_or(Scales { from: channel, n: 0 }, |from| Scales { from, n: count(from) })
    }

    /// The measured values of raw `columns`, one for each slot.
    ///
    /// # Errors
    /// The type of an unknown scale, or the fault in a scale.
    pub fn apply(&self, slots: &[Slot], mut columns: Vec<Vec<f64>>) -> Result<Values, String> {
        if let ([Slot::Real, Slot::Imaginary], 0) = (slots, self.n) {
            let (imaginary, real) = (columns.pop().unwrap_or_default(), columns.pop().unwrap_or_default());
            return Ok(Values::of(real, Some(imaginary)));
        }
        if self.n == 0 {
            return Ok(Values::Real(columns.swap_remove(0)));
        }
        // Collects the scales from the last one down to the raw values, each once. Numbers here are one
        // higher than in the file, so that 0 means the raw values.
        let (mut wanted, mut chain) = (BTreeSet::from([self.n]), Vec::new());
        while let Some(number) = wanted.pop_last() {
            let (step, inputs) = self.step(number.wrapping_sub(1), slots)?;
            let inputs: Vec<u32> = inputs.into_iter().map(|input| input.wrapping_add(1)).collect();
            if inputs.iter().any(|input| *input >= number) {
                return Err(format!("scale {}, whose input leads back to itself", number - 1));
            }
            wanted.extend(&inputs);
            chain.push((number, step, inputs));
        }
        chain.reverse();
        let raw = chain
            .iter()
            .filter_map(|(_, step, _)| if let Conversion::Raw(i) = step { Some(*i) } else { None });
        let n = raw.map(|i| columns.get(i).map_or(0, Vec::len)).min().unwrap_or(0);
        let place = |number: u32| chain.partition_point(|(known, ..)| *known < number);
        let steps: Vec<(&Conversion, Vec<usize>)> = chain
            .iter()
            .map(|(_, step, inputs)| (step, inputs.iter().map(|input| place(*input)).collect()))
            .collect();
        let mut made = vec![0.0; steps.len()];
        let value = |row: usize| {
            for (i, (step, inputs)) in steps.iter().enumerate() {
                made[i] = match step {
                    Conversion::Raw(column) => columns[*column][row],
                    Conversion::Polynomial(all) => {
                        all.iter().rev().fold(0.0, |sum, c| sum * made[inputs[0]] + c)
                    }
                    Conversion::Table(table) => between(table, made[inputs[0]]),
                    Conversion::Sum(sign) => made[inputs[0]] + sign * made[inputs[1]],
                };
            }
            made[made.len() - 1]
        };
        Ok(Values::Real((0..n).map(value).collect()))
    }

    /// Conversion and inputs of scale `i`.
    fn step(&self, i: u32, slots: &[Slot]) -> Result<(Conversion, Vec<u32>), String> {
        let number = |key: &str| self.from.number(&format!("NI_Scale[{i}]_{key}"));
        let Some(kind) = self.from.text(&format!("NI_Scale[{i}]_Scale_Type")) else {
            // Without a type it is a DAQmx scaler, whose column the layout of the raw data gives.
            let column = slots.iter().position(|slot| *slot == Slot::Scaler(i)).unwrap_or(0);
            return Ok((Conversion::Raw(column), Vec::new()));
        };
        let input = |key: &str| number(&format!("{kind}_{key}Input_Source")).map_or(RAW, |n| n as u32);
        let missing = |what: &str| format!("{kind} without {what}");
        let list = |name: &str| -> Result<Vec<f64>, String> {
            // NI's default is 4 if the number of coefficients is left out.
            let n = number(&format!("{name}_Size")).unwrap_or(4.0);
            (0..n as u32).map(|j| number(&format!("{name}[{j}]")).ok_or_else(|| missing(name))).collect()
        };
        Ok(match kind {
            "Linear" => {
                let one = |key: &str| number(key).ok_or_else(|| missing(key));
                let slope = one("Linear_Slope")?;
                (Conversion::Polynomial(vec![one("Linear_Y_Intercept")?, slope]), vec![input("")])
            }
            "Polynomial" => (Conversion::Polynomial(list("Polynomial_Coefficients")?), vec![input("")]),
            "Table" => {
                let (from, to) = (list("Table_Pre_Scaled_Values")?, list("Table_Scaled_Values")?);
                let mut table: Vec<(f64, f64)> = from.into_iter().zip(to).collect();
                sort_by_number(&mut table, |row| row.0);
                if table.len() < 2 || table.windows(2).any(|w| w[0].0 == w[1].0) {
                    return Err(missing("a table that rises"));
                }
                (Conversion::Table(table), vec![input("")])
            }
            // NI subtracts the left operand from the right one.
            "Add" | "Subtract" => {
                let sign = if kind == "Add" { 1.0 } else { -1.0 };
                (Conversion::Sum(sign), vec![input("Right_Operand_"), input("Left_Operand_")])
            }
            // This scale only states which software applies the scaling; it changes no values.
            "AdvancedAPI" => (Conversion::Polynomial(vec![0.0, 1.0]), vec![input("")]),
            other => return Err(other.to_owned()),
        })
    }
}

/// A value from a table: linear between its rows, constant beyond them.
fn between(table: &[(f64, f64)], at: f64) -> f64 {
    let above = table.partition_point(|(x, _)| *x <= at);
    let (Some((x0, y0)), Some((x1, y1))) = (above.checked_sub(1).map(|i| table[i]), table.get(above)) else {
        return if above == 0 { table[0].1 } else { table[table.len() - 1].1 };
    };
    y0 + (y1 - y0) / (x1 - x0) * (at - x0)
}
