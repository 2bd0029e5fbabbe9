//! Residuals of a fit, and the profile of its least certain parameter.

use crate::compare::{Fit, Profile};
use crate::record::Direction;
use crate::report::layout::{lettered, line, points};
use crate::report::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};
use std::fmt::Write as _;

/// Residuals over frequency, by mass and direction, and the profile of the parameter with the largest
/// relative uncertainty.
pub fn fit(title: &str, fit: &Fit) -> Figure {
    let mut above =
        Plot::new(AxisSpec::new("Excitation frequency", "Hz"), AxisSpec::new("Residual / stated std", ""))
            .legend(Legend::Right);
    for (mass, direction, marker) in [
        (1, Direction::Up, Marker::Circle),
        (1, Direction::Down, Marker::OpenCircle),
        (2, Direction::Up, Marker::FilledSquare),
        (2, Direction::Down, Marker::Square),
    ] {
        let of_sweep = fit.points.iter().filter(|p| p.mass == mass && p.direction == direction);
        let places = of_sweep.map(|p| (p.frequency, p.residual));
        let name = format!("mass {mass}, {}", direction.name());
        above = points(above, &name, places, Ink::Nth(usize::from(mass) - 1), marker);
    }
    above = above.with(Series::horizontal("", 0.0));
    let mut figure = Figure::double(format!("Fit, {title}")).panel(above.title("Residuals")).height(80.0);
    let left = fit.left_out;
    let mut caption = format!(
        "Residuals of {} amplitudes in units of their stated standard uncertainties; {} of other motions, and outliers, are left out.",
        fit.n,
        left.clear()
    );
    if let Some(profile) = &fit.profile {
        let certain = fit.doubt.is_none();
        figure = figure.panel(profile_plot(profile, certain)).height(150.0);
        let name = profile.parameter.name();
        let _ = write!(
            caption,
            " Below: the least sum of squares over {name}, the least certain parameter, all others free; "
        );
        let _ = if certain {
            write!(caption, "the 95 % confidence interval lies below the grey line ({}).", profile.limit)
        } else {
            write!(caption, "the answer is in doubt, so it gives no interval.")
        };
    }
    lettered(figure).caption(caption)
}

/// The least sum of squares over one parameter, all others free; with the limit of its 95 % interval where
/// the fit is not in doubt.
fn profile_plot(profile: &Profile, certain: bool) -> Plot {
    let largest = profile.rise.iter().copied().filter(|r| r.is_finite()).fold(profile.limit, f64::max);
    let unit = if profile.unit == "1" { "" } else { profile.unit };
    let plot = Plot::new(
        AxisSpec::new(profile.parameter.name(), unit),
        AxisSpec::new("Rise of the sum of squares", "").limits(0.0, 1.05 * largest.min(6.0 * profile.limit)),
    )
    .title(format!("Profile of {}", profile.parameter.name()))
    .legend(Legend::Hidden);
    let plot = if certain { plot.with(Series::horizontal("95 %", profile.limit)) } else { plot };
    let places = profile.value.iter().copied().zip(profile.rise.iter().copied());
    line(plot, "", places, Ink::Nth(0), Stroke::Solid)
}
