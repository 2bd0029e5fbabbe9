//! Figures, tables and pages as a caller sees them: well formed, repeatable, and drawn from any data without
//! a panic.

use ndarray::Array2;
use proptest::prelude::*;
use resvg::usvg::{self, roxmltree};
use vibroimpact::figure::{
    AxisSpec, Drawing, Figure, Heatmap, Legend, Medium, Panel, Plot, Series, Shape, Stroke, Waterfall,
};
use vibroimpact::read::Owner;
use vibroimpact::report::{Output, Page, Picture, Table};

/// Parses a drawing as XML and as a picture, and returns the texts it shows.
fn texts(drawing: &Drawing) -> Vec<String> {
    let svg = drawing.svg();
    let document = roxmltree::Document::parse(&svg).unwrap_or_else(|e| panic!("{e}\n{svg}"));
    usvg::Tree::from_str(&svg, &usvg::Options::default()).unwrap_or_else(|e| panic!("{e}\n{svg}"));
    let texts = document.descendants().filter(|n| n.has_tag_name("text"));
    texts.filter_map(|n| n.text().map(str::to_owned)).collect()
}

/// Checks that the drawing contains no NaN and no infinite number.
fn places_are_finite(drawing: &Drawing) {
    let svg = drawing.svg();
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}

fn one(plot: Plot) -> Drawing {
    Figure::single("figure").panel(plot).draw()
}

fn axes() -> (AxisSpec, AxisSpec) {
    (AxisSpec::frequency(), AxisSpec::new("Displacement", "m"))
}

fn spectra(rows: usize, columns: usize) -> (Vec<f64>, Vec<f64>, Array2<f64>) {
    let frequency: Vec<f64> = (0..columns).map(|i| i as f64 * 0.5).collect();
    let excitation: Vec<f64> = (0..rows).map(|i| 3.0 + i as f64 * 0.25).collect();
    let magnitude = Array2::from_shape_fn((rows, columns), |(r, c)| {
        1e-3 / (1.0 + (frequency[c] - excitation[r]).powi(2)) + 1e-6 * ((r * 31 + c * 17) % 7) as f64
    });
    (frequency, excitation, magnitude)
}

/// A figure with every kind of series and panel.
fn everything() -> Figure {
    let (x, y) = axes();
    let at = [3.0, 4.0, 5.0, 6.0];
    let plot = Plot::new(x, y)
        .title("(a) All series")
        .with(Series::band("band", at, [0.001; 4], [0.002; 4]))
        .with(Series::new("bars", Shape::Bars, [3.0, 4.0, 5.0], [0.001, 0.002]))
        .with(Series::line("line", at, [0.001, 0.003, f64::NAN, 0.002]).stroke(Stroke::DashDot))
        .with(Series::points("points", at, [0.002; 4]).y_error([3e-4; 4]).stroke(Stroke::Thin))
        .with(Series::vertical("vertical", 4.5))
        .with(Series::horizontal("horizontal", 0.0025))
        .note("a note", 4.0, 0.003);
    let (frequency, excitation, magnitude) = spectra(9, 40);
    let level = AxisSpec::new("Level", "m").db(1e-6);
    let map = Plot::new(AxisSpec::frequency(), AxisSpec::new("Excitation", "Hz"))
        .title("(b) Map")
        .heatmap(Heatmap::new(&frequency, &excitation, &magnitude, level).unwrap());
    let waterfall =
        Waterfall::new(&frequency, &excitation, &magnitude, AxisSpec::new("Displacement", "m")).unwrap();
    Figure::double("Everything").height(160.0).columns(2).panel(plot).panel(map).panel(waterfall)
}

#[test]
fn a_figure_says_all_its_names_as_text() {
    let texts = texts(&everything().draw());
    for name in [
        "(a) All series",
        "Frequency (Hz)",
        "Displacement (mm)",
        "band",
        "bars",
        "line",
        "points",
        "vertical",
        "horizontal",
        "a note",
        "Level (dB re 1 µm)",
        "Excitation frequency (Hz)",
    ] {
        assert!(texts.iter().any(|t| t == name), "{name} is not among {texts:?}");
    }
}

#[test]
fn equal_figures_give_equal_bytes() {
    let (first, second) = (everything().draw(), everything().draw());
    assert_eq!(first.svg(), second.svg());
    assert_eq!(first.png(150.0).unwrap(), second.png(150.0).unwrap());
}

#[test]
fn figures_drawn_at_once_are_those_drawn_alone() {
    use rayon::prelude::*;
    let alone = everything().draw().png(100.0).unwrap();
    let many: Vec<Vec<u8>> =
        (0..8).into_par_iter().map(|_| everything().draw().png(100.0).unwrap()).collect();
    assert!(many.iter().all(|png| *png == alone));
}

#[test]
fn a_picture_has_the_size_in_print_and_its_resolution() {
    let png = one(Plot::new(axes().0, axes().1)).png(300.0).unwrap();
    let word = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    // Width and height in pixels follow the signature, a length and the name IHDR: 86 mm × 62 mm at 300 dpi.
    assert_eq!((word(16), word(20)), (1016, 732));
    let phys = png.windows(4).position(|w| w == b"pHYs").unwrap();
    // 300 dots per inch are 11 811.02 dots per metre.
    assert_eq!((word(phys + 4), word(phys + 8), png[phys + 12]), (11_811, 11_811, 1));
}

#[test]
fn a_picture_too_large_for_memory_is_refused() {
    let figure = Figure { width: 1000.0, height: 1000.0, ..Figure::single("poster") };
    let error = figure.draw().png(1200.0).unwrap_err();
    assert_eq!(error.exit_code(), 1);
    assert!(error.to_string().contains("47244 × 47244"), "{error}");
}

/// Share of pixels that are not white.
fn ink(drawing: &Drawing) -> f64 {
    let png = drawing.png(100.0).unwrap();
    let pixels = resvg::tiny_skia::Pixmap::decode_png(&png).unwrap();
    let dark = pixels.pixels().iter().filter(|p| p.red() < 250 || p.green() < 250 || p.blue() < 250).count();
    dark as f64 / pixels.pixels().len() as f64
}

#[test]
fn text_and_maps_reach_the_pixels() {
    let (x, y) = axes();
    let nothing = ink(&one(Plot::new(x.clone(), y.clone()).legend(Legend::Hidden)));
    let named = ink(&one(Plot::new(x.clone(), y).title("A title of several words")));
    assert!(named > nothing + 0.002, "{named} {nothing}");
    let (frequency, excitation, magnitude) = spectra(9, 40);
    let map = Heatmap::new(&frequency, &excitation, &magnitude, AxisSpec::new("Level", "m")).unwrap();
    // The frame fills most of the page, and the map all of the frame.
    assert!(ink(&one(Plot::new(x, AxisSpec::new("Excitation", "Hz")).heatmap(map))) > 0.4);
}

#[test]
fn markup_in_names_stays_text() {
    let evil = "</text><script>alert('&\"1\")</script>\u{1}";
    let (x, _) = axes();
    let plot = Plot::new(x, AxisSpec::new(evil, evil))
        .title(evil)
        .with(Series::line(evil, [1.0, 2.0], [1.0, 2.0]))
        .with(Series::vertical(evil, 1.5))
        .note(evil, 1.5, 1.5);
    let figure = Figure::double(evil).caption(evil).panel(plot);
    let drawing = figure.draw();
    assert!(!drawing.svg().contains("<script"));
    assert!(texts(&drawing).iter().any(|t| t.starts_with("</text><script>")));
    let picture = Picture::of(&figure, Medium::Report).unwrap();
    let page = Page::new(evil).figure(&figure, &picture, &[evil]).table(&Table::new(evil).column(evil, evil));
    assert!(!page.html().contains("<script>alert"));
}

#[test]
fn data_without_a_finite_value_are_said_to_be_none() {
    let nan = f64::NAN;
    for (x, y) in [
        (vec![], vec![]),
        (vec![nan, nan], vec![1.0, 2.0]),
        (vec![1.0, 2.0], vec![nan, f64::INFINITY]),
        (vec![1.0], vec![]),
    ] {
        let (fx, fy) = axes();
        let drawing = one(Plot::new(fx, fy).with(Series::line("none", x, y)));
        assert!(texts(&drawing).contains(&"no data".to_owned()));
        places_are_finite(&drawing);
    }
    let empty = Waterfall::new(&[], &[], &Array2::zeros((0, 0)), AxisSpec::new("a", "m")).unwrap();
    assert!(texts(&Figure::single("").panel(empty).draw()).contains(&"no data".to_owned()));
    let map = Heatmap::new(&[], &[], &Array2::zeros((0, 0)), AxisSpec::new("a", "m")).unwrap();
    assert!(texts(&one(Plot::new(axes().0, axes().1).heatmap(map))).contains(&"no data".to_owned()));
    texts(&Figure::single("no panel at all").draw());
}

#[test]
fn one_value_and_equal_values_are_drawn() {
    for (x, y) in
        [(vec![5.0], vec![0.002]), (vec![5.0; 3], vec![0.0; 3]), (vec![1e300, -1e300], vec![-1e300, 1e300])]
    {
        let (fx, fy) = axes();
        let drawing = one(Plot::new(fx, fy).with(Series::points("", x, y)));
        let texts = texts(&drawing);
        assert!(!texts.contains(&"no data".to_owned()), "{texts:?}");
        // At least two numbers on each axis, and the names of the axes.
        assert!(texts.len() >= 6, "{texts:?}");
        places_are_finite(&drawing);
    }
}

#[test]
fn a_legend_covers_no_data_even_where_there_is_no_free_corner() {
    // A lattice of points fills the frame, so the legend has no free place inside and must lie outside the
    // outermost points.
    let lattice: Vec<(f64, f64)> = (0..400).map(|i| (f64::from(i % 20), f64::from(i / 20))).collect();
    let (x, y): (Vec<f64>, Vec<f64>) = lattice.into_iter().unzip();
    let plot = Plot::new(AxisSpec::new("x", ""), AxisSpec::new("y", "")).with(Series::points("name", x, y));
    let svg = one(plot).svg();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let name = document.descendants().find(|n| n.text() == Some("name")).unwrap();
    let at: f64 = name.attribute("y").unwrap().parse().unwrap();
    // The frame is the outline with a stroke width of 0.75, written as its corner and four sides.
    let frame = document.descendants().find(|n| n.attribute("stroke-width") == Some(".75")).unwrap();
    let corner = frame.attribute("d").unwrap().trim_start_matches('M').split(['l', ' ']).nth(1).unwrap();
    assert!(at < corner.parse().unwrap(), "{at} {corner}");
}

#[test]
fn a_folder_of_results_is_written_whole() {
    let dir = tempfile::tempdir().unwrap();
    let mut out = Output::new(dir.path().join("results"), Owner::Run).unwrap();
    let picture = Picture::of(&everything(), Medium::Report).unwrap();
    out.write("all.svg", &picture.svg).unwrap();
    out.write("all.png", &picture.png).unwrap();
    let page = Page::new("Report").figure(&everything(), &picture, &["all.svg"]);
    out.write("report.html", page.html()).unwrap();
    assert!(out.write("../report.html", "").is_err());
    let folder = out.folder().to_owned();
    assert_eq!(out.commit().unwrap(), ["all.svg", "all.png", "report.html"]);
    assert_eq!(std::fs::read_to_string(folder.join("report.html")).unwrap(), page.html());
}

/// Numbers as in sound and in broken files.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -10.0..10.0f64,
        1 => any::<f64>(),
        1 => prop_oneof![Just(0.0), Just(1e300), Just(-1e300), Just(f64::NAN), Just(f64::INFINITY), Just(1e-310)],
    ]
}

fn spec() -> impl Strategy<Value = AxisSpec> {
    let limits = prop::option::of((number(), number()));
    (0..3, limits, prop_oneof![Just("m"), Just("°"), Just("1"), Just("(m/s²)/N")]).prop_map(
        |(scale, limits, unit)| {
            let spec = AxisSpec { limits, ..AxisSpec::new("axis", unit) };
            match scale {
                0 => spec,
                1 => spec.log(),
                _ => spec.db(1e-6),
            }
        },
    )
}

fn series() -> impl Strategy<Value = Series> {
    let list = || prop::collection::vec(number(), 0..12);
    let shape = prop_oneof![
        Just(Shape::Line),
        Just(Shape::Points),
        Just(Shape::Band),
        Just(Shape::Bars),
        Just(Shape::Vertical),
        Just(Shape::Horizontal),
    ];
    ("\\PC{0,12}", shape, list(), list(), list(), list(), any::<bool>()).prop_map(
        |(name, shape, x, y, low, high, joined)| {
            let stroke = joined.then_some(Stroke::Thin);
            Series { low, high, stroke, ..Series::new(name, shape, x, y) }
        },
    )
}

fn panel() -> impl Strategy<Value = Panel> {
    let series = prop::collection::vec(series(), 0..5);
    let notes = prop::collection::vec((number(), number(), "\\PC{0,30}"), 0..4);
    (spec(), spec(), series, notes).prop_map(|(x, y, series, notes)| {
        let mut plot = Plot::new(x, y);
        plot.series = series;
        for (x, y, text) in notes {
            plot = plot.note(text, x, y);
        }
        plot.into()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Any numbers, names and sizes give a well-formed picture.
    #[test]
    fn any_figure_is_drawn(
        panels in prop::collection::vec(panel(), 0..4),
        columns in 0usize..4,
        shared_x: bool,
        width in prop_oneof![number(), 40.0..200.0f64],
        height in prop_oneof![number(), 20.0..200.0f64],
    ) {
        let figure = Figure { width, height, columns, shared_x, panels, ..Figure::single("any") };
        let drawing = figure.draw();
        texts(&drawing);
        places_are_finite(&drawing);
    }

    #[test]
    fn any_waterfall_is_drawn(
        rows in 0usize..6, columns in 0usize..20, values in prop::collection::vec(number(), 120),
        height in spec(), low in number(), high in number(),
    ) {
        let frequency: Vec<f64> = (0..columns).map(|i| i as f64).collect();
        let excitation = &values[..rows];
        let magnitude = Array2::from_shape_fn((rows, columns), |(r, c)| values[r * 20 + c]);
        let waterfall = Waterfall::new(&frequency, excitation, &magnitude, height).unwrap().frequencies(low, high);
        let drawing = Figure::single("any").panel(waterfall).draw();
        texts(&drawing);
        places_are_finite(&drawing);
    }
}
