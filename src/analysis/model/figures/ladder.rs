//! The ladder of models: the verdict on each rung over frequency.

use crate::error::Result;
use crate::model::Observable;
use crate::model::ladder::{Choice, Model, Question, Rung, Survey};
use crate::report::layout::lettered;
use crate::report::{AxisSpec, Figure, Heatmap, Ink, Legend, Plot, Series};
use ndarray::Array2;

/// Verdict on a rung at one frequency.
#[derive(Clone, Copy, PartialEq, Eq)]
enum RungVerdict {
    NotValid,
    /// A richer model changes the answer by more than the tolerance.
    ChangesTooMuch,
    Adequate,
    /// The simplest adequate one.
    Chosen,
}

impl RungVerdict {
    /// All verdicts in the order of the legend.
    const ALL: [RungVerdict; 4] =
        [RungVerdict::Chosen, RungVerdict::Adequate, RungVerdict::ChangesTooMuch, RungVerdict::NotValid];
    /// Their names.
    const NAMES: [&'static str; 4] = ["chosen", "adequate", "answer changes too much", "not valid"];

    /// The verdict on a rung of a choice.
    fn of(choice: &Choice, rung: &Rung) -> RungVerdict {
        match rung {
            _ if choice.chosen == Some(rung.model) => RungVerdict::Chosen,
            r if !r.valid => RungVerdict::NotValid,
            r if r.sufficient => RungVerdict::Adequate,
            _ => RungVerdict::ChangesTooMuch,
        }
    }
}

/// Over frequency: the result of each rung, and the answer of the chosen one.
///
/// # Errors
/// As [`Heatmap::classes`].
pub fn ladder(survey: &Survey, question: &Question) -> Result<Figure> {
    let all = &survey.points;
    let x: Vec<f64> = all.iter().map(|c| c.frequency).collect();
    // Rungs above the highest one that is valid anywhere are left out.
    let is_valid_somewhere = |model: &Model| all.iter().any(|c| c.rung(*model).valid);
    let rows = 1 + Model::ALL.iter().rposition(is_valid_somewhere).unwrap_or(0);
    let y: Vec<f64> = (1..=rows).map(|n| n as f64).collect();
    let verdicts = Array2::from_shape_fn((rows, x.len()), |(row, column)| {
        let choice = &all[column];
        let verdict = RungVerdict::of(choice, &choice.rungs[row]);
        RungVerdict::ALL.iter().position(|f| *f == verdict).map_or(f64::NAN, |k| k as f64)
    });
    let frequency = || AxisSpec::frequency().limits(x[0], x[x.len() - 1]);
    let names: Vec<String> = (1..=rows).zip(Model::ALL).map(|(i, m)| format!("{i} {}", m.name())).collect();
    let names = names.join(", ");
    let map = Plot::new(frequency(), AxisSpec::new("Model", ""))
        .title(format!("models: {names}"))
        .heatmap(Heatmap::classes(&x, &y, &verdicts, &RungVerdict::NAMES)?)
        .legend(Legend::Above);
    let observable = question.observable;
    let panels: &[(&str, &str)] = match observable {
        Observable::Fundamental => {
            &[("excited mass", "Amplitude of x₁"), ("passive mass", "Amplitude of x₂")]
        }
        Observable::HalfPeakToPeak => {
            &[("excited mass", "Half peak-to-peak of x₁"), ("passive mass", "Half peak-to-peak of x₂")]
        }
        Observable::ImpactSpeed => &[("impacts", "Impact speed")],
        Observable::Impulse => &[("impacts", "Impulse")],
    };
    let mut figure = Figure::double("Ladder of models along an axis")
        .height(62.0 + 52.0 * panels.len() as f64)
        .shared_x()
        .panel(map)
        .caption(format!(
            "(a) Verdict on each model: {names}. Below, the answer of the chosen model; none where no model can be chosen."
        ));
    for (mass, (title, label)) in panels.iter().enumerate() {
        let y = AxisSpec::new(*label, observable.unit());
        let mut plot = Plot::new(frequency(), y).title(*title).legend(Legend::Right);
        for (i, model) in Model::ALL.into_iter().enumerate() {
            let chosen_here = all.iter().filter(|c| c.chosen == Some(model));
            let (x, y): (Vec<f64>, Vec<f64>) =
                chosen_here.filter_map(|c| Some((c.frequency, c.answer()?[mass]))).unzip();
            if !x.is_empty() {
                plot = plot.with(Series::points(model.name(), x, y).ink(Ink::Nth(i)));
            }
        }
        figure = figure.panel(plot);
    }
    Ok(lettered(figure))
}
