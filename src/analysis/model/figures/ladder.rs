//! The ladder of models: what a rung costs and is worth, and which one is chosen where.

use crate::error::Result;
use crate::model::Observable;
use crate::model::ladder::{Choice, Model, Question, Rung, Survey};
use crate::report::layout::lettered;
use crate::report::{AxisSpec, Figure, Heatmap, Ink, Legend, Marker, Plot, Series, Stroke};
use ndarray::Array2;

/// Changes in percent below this are drawn here: an axis of parts has no zero.
const LEAST: f64 = 1e-3;

/// Colours of the rungs, those of the map last, and their markers.
const INKS: [usize; 7] = [6, 4, 5, 3, 1, 2, 0];
const MARKS: [Marker; 7] = [
    Marker::Circle,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::OpenCircle,
    Marker::FilledSquare,
    Marker::Cross,
];

/// What became of a rung.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    NotValid,
    Moves,
    Enough,
    Chosen,
}

impl Fate {
    const ALL: [Fate; 4] = [Fate::Chosen, Fate::Enough, Fate::Moves, Fate::NotValid];
    const NAMES: [&'static str; 4] = ["chosen", "good enough", "answer moves too far", "not valid"];

    fn of(choice: &Choice, rung: &Rung) -> Fate {
        match rung {
            _ if choice.chosen == Some(rung.model) => Fate::Chosen,
            r if !r.valid => Fate::NotValid,
            r if r.sufficient => Fate::Enough,
            _ => Fate::Moves,
        }
    }
}

/// Change of each rung's answer at the rungs above over the time it takes; the answer over the stiffness of the contact where that is not
/// known and nothing could be chosen.
pub fn ladder(choice: &Choice, question: &Question) -> Figure {
    let unknown = choice.chosen.is_none() && !choice.sensitivity.is_empty();
    let (plot, caption) = if unknown {
        (stiffness(choice, question), OVER_STIFFNESS)
    } else {
        (price(choice, question), PRICE)
    };
    Figure::double("Ladder of models").panel(plot).caption(caption)
}

const PRICE: &str = "Largest change of a rung's answer at the next rung and at the next one that follows the motion, over the time the answer takes \
                     on this machine. Rungs without a rung above, or without an answer, are not shown; changes below 0.001 % are drawn there.";
const OVER_STIFFNESS: &str = "Change of the answer from that of impacts without duration, over the stiffness of the contact, which is not known.";

fn tolerance(plot: Plot, question: &Question) -> Plot {
    let name = format!("tolerance {} %", 100.0 * question.tolerance);
    plot.with(Series::horizontal(name, 100.0 * question.tolerance))
}

fn price(choice: &Choice, question: &Question) -> Plot {
    let mut plot = Plot::new(
        AxisSpec::new("Time of an answer", "s").log(),
        AxisSpec::new("Change at the rungs above (%)", "").log().limits(LEAST / 2.0, f64::NAN),
    )
    .legend(Legend::Right);
    plot = tolerance(plot, question);
    let marks = [Marker::FilledSquare, Marker::Circle, Marker::OpenCircle, Marker::Cross];
    for (i, fate) in Fate::ALL.into_iter().enumerate() {
        let rungs = choice.rungs.iter().filter(|r| Fate::of(choice, r) == fate);
        let shown: Vec<(f64, f64, Model)> =
            rungs.filter_map(|r| Some((1e-9 * r.cost_ns?, (100.0 * r.error?).max(LEAST), r.model))).collect();
        if shown.is_empty() {
            continue;
        }
        for (x, y, model) in &shown {
            plot = plot.note(model.name(), *x, *y);
        }
        let (x, y): (Vec<f64>, Vec<f64>) = shown.iter().map(|s| (s.0, s.1)).unzip();
        plot = plot.with(Series::points(Fate::NAMES[i], x, y).ink(Ink::Nth(i)).marker(marks[i]));
    }
    plot
}

fn stiffness(choice: &Choice, question: &Question) -> Plot {
    let rows = &choice.sensitivity;
    let (x, y): (Vec<f64>, Vec<f64>) =
        rows.iter().map(|r| (r.stiffness, (100.0 * r.change.abs()).max(LEAST))).unzip();
    let plot = Plot::new(
        AxisSpec::new("Contact stiffness", "N/m").log(),
        AxisSpec::new("Change of the answer (%)", "").log(),
    )
    .legend(Legend::Hidden);
    tolerance(plot, question)
        .with(Series::line("", x.clone(), y.clone()).ink(Ink::Nth(0)).stroke(Stroke::Thin))
        .with(Series::points("", x, y).ink(Ink::Nth(0)).marker(Marker::Circle))
}

/// Over frequency: what became of each rung, and the answer with the rung that gives it.
///
/// # Errors
/// As [`Heatmap::classes`].
pub(crate) fn ladder_over(survey: &Survey, question: &Question) -> Result<Figure> {
    let points = &survey.points;
    let x: Vec<f64> = points.iter().map(|c| c.frequency).collect();
    // Rungs that are nowhere valid stand for nothing here, if they are above all that are.
    let tried = |model: &Model| points.iter().any(|c| c.rung(*model).valid);
    let rows = 1 + Model::ALL.iter().rposition(tried).unwrap_or(0);
    let y: Vec<f64> = (1..=rows).map(|n| n as f64).collect();
    let fates = Array2::from_shape_fn((rows, x.len()), |(row, column)| {
        let choice = &points[column];
        let fate = Fate::of(choice, &choice.rungs[row]);
        Fate::ALL.iter().position(|f| *f == fate).map_or(f64::NAN, |k| k as f64)
    });
    let frequency = || AxisSpec::frequency().limits(x[0], x[x.len() - 1]);
    let names: Vec<String> =
        Model::ALL[..rows].iter().enumerate().map(|(i, m)| format!("{} {}", i + 1, m.name())).collect();
    let map = Plot::new(frequency(), AxisSpec::new("Rung", ""))
        .title(format!("rungs: {}", names.join(", ")))
        .heatmap(Heatmap::classes(&x, &y, &fates, &Fate::NAMES)?)
        .legend(Legend::Above);
    let masses = if question.observable.is_of_impacts() { 1 } else { 2 };
    let mut figure = Figure::double("Ladder of models along an axis")
        .height(62.0 + 52.0 * f64::from(masses))
        .shared_x()
        .panel(map)
        .caption(format!(
            "(a) What became of each rung: {}. Below, the answer, with the rung that gives it; none where no rung can be chosen.",
            names.join(", ")
        ));
    for mass in 0..masses as usize {
        figure = figure.panel(answers(survey, question, mass, frequency()));
    }
    Ok(lettered(figure))
}

fn answers(survey: &Survey, question: &Question, mass: usize, x: AxisSpec) -> Plot {
    let label = match question.observable {
        Observable::Fundamental => ["Amplitude of x₁", "Amplitude of x₂"][mass],
        Observable::HalfPeakToPeak => ["Half peak-to-peak of x₁", "Half peak-to-peak of x₂"][mass],
        Observable::ImpactSpeed => "Impact speed",
        Observable::Impulse => "Impulse",
    };
    let title = match (question.observable.is_of_impacts(), mass) {
        (true, _) => "impacts",
        (false, 0) => "excited mass",
        (false, _) => "passive mass",
    };
    let mut plot =
        Plot::new(x, AxisSpec::new(label, question.observable.unit())).title(title).legend(Legend::Right);
    for (i, model) in Model::ALL.into_iter().enumerate() {
        let of = survey.points.iter().filter(|c| c.chosen == Some(model));
        let (x, y): (Vec<f64>, Vec<f64>) = of.filter_map(|c| Some((c.frequency, c.answer()?[mass]))).unzip();
        if !x.is_empty() {
            plot = plot.with(Series::points(model.name(), x, y).ink(Ink::Nth(INKS[i])).marker(MARKS[i]));
        }
    }
    plot
}
