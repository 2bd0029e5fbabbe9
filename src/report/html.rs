//! The report as one interactive page without network access or other files.

use super::files::Picture;
use super::table::Table;
use crate::record::Severity;
use crate::units::notation::counted;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Value, json};
use std::fmt::Write;
use std::io::Write as _;
use vibro_figure::{Figure, Matrices, escaped};

/// A report in reading order. A script draws the figures, so that they can be zoomed and rotated; without
/// scripts a reader sees the printed version.
///
/// ```
/// use vibroimpact::report::{Page, Table};
/// let page = Page::new("Two-mass rig")
///     .heading("Resonances")
///     .table(&Table::new("").column("Frequency", "Hz").row([5.58.into()]));
/// assert!(page.html().starts_with("<!DOCTYPE html>"));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    title: String,
    headings: Vec<String>,
    /// The elements so far, as HTML.
    body: String,
    /// Data of the figures, for the script.
    figures: Vec<Value>,
    /// Matrices to which the figures refer.
    matrices: Matrices,
    /// Initial values of the sliders, if the page has them.
    whatif: Option<Value>,
}

/// Number of rows above which a table is collapsed.
const MOST_SHOWN_ROWS: usize = 12;

/// Number of cautions of one part above which they are collapsed.
const MOST_CAUTIONS: usize = 3;

/// Number of cautions at the head of the page above which they are collapsed.
const MOST_AT_HEAD: usize = 12;

impl Page {
    /// A page without content.
    pub fn new(title: impl Into<String>) -> Page {
        Page { title: title.into(), ..Page::default() }
    }

    /// Begins a section.
    pub fn heading(mut self, text: &str) -> Page {
        self.headings.push(text.to_owned());
        let number = self.headings.len();
        self.element(&format!("<h2 id=\"part-{number}\">{}</h2>", escaped(text)))
    }

    /// Adds short tables side by side, as many as fit.
    pub fn answers(self, tables: &[Table]) -> Page {
        let all: String = tables.iter().map(Table::html).collect();
        self.element(&format!("<div class=\"answers\">{all}</div>"))
    }

    /// Adds a paragraph.
    pub fn paragraph(self, text: &str) -> Page {
        self.element(&format!("<p>{}</p>", escaped(text)))
    }

    /// Adds findings: doubts and a few cautions are visible, others collapsed.
    pub fn findings(self, all: &[(Severity, String)]) -> Page {
        self.listed(all, MOST_CAUTIONS)
    }

    /// As [`Page::findings`] at the head of the page: more cautions are visible.
    pub fn foremost(self, all: &[(Severity, String)]) -> Page {
        self.listed(all, MOST_AT_HEAD)
    }

    /// Adds a list of findings, in which cautions are collapsed if there are more than `most` of them.
    fn listed(self, all: &[(Severity, String)], most: usize) -> Page {
        let list = |with: &dyn Fn(Severity) -> bool| {
            let listed = all.iter().filter(|(severity, _)| with(*severity));
            listed.fold(String::new(), |mut out, (severity, sentence)| {
                let name = severity.name();
                let _ = writeln!(out, "<li class=\"{name}\"><b>{name}</b> {}</li>", code(&escaped(sentence)));
                out
            })
        };
        let count = |grade: Severity| all.iter().filter(|(severity, _)| *severity == grade).count();
        let cautions = count(Severity::Caution);
        let least = if cautions > most { Severity::Doubt } else { Severity::Caution };
        let (shown, others) = (list(&|s| s >= least), list(&|s| s < least));
        let folded = [Severity::Caution, Severity::Note].into_iter().filter(|grade| *grade < least);
        let folded = folded.map(|grade| (count(grade), grade.name())).filter(|(n, _)| *n > 0);
        let folded: Vec<String> = folded.map(|(n, name)| counted(n, name)).collect();
        let mut page = self;
        if !shown.is_empty() {
            page = page.element(&format!("<ul class=\"findings\">\n{shown}</ul>"));
        }
        if folded.is_empty() {
            return page;
        }
        let folded = folded.join(", ");
        page.element(&format!(
            "<details><summary>{folded}</summary>\n<ul class=\"findings\">\n{others}</ul></details>"
        ))
    }

    /// Adds a table; a long one is collapsed.
    pub fn table(self, table: &Table) -> Page {
        let html = table.html();
        if table.rows.len() <= MOST_SHOWN_ROWS {
            return self.element(html.trim_end());
        }
        let (title, n) = (escaped(&table.title), table.rows.len());
        self.element(&format!("<details><summary>{title}: {n} rows</summary>\n{html}</details>"))
    }

    /// Adds tables: those of the kind of the first one are visible, the others collapsed, a long one by
    /// itself. The title of a table is its kind, then the name of its record.
    pub fn tables<'a>(self, all: impl IntoIterator<Item = &'a Table>) -> Page {
        let kind = |table: &Table| table.title.split(", ").next().unwrap_or_default().to_owned();
        let all: Vec<&Table> = all.into_iter().collect();
        let first = all.first().map(|table| kind(table));
        let is_shown = |table: &&Table| table.rows.len() > MOST_SHOWN_ROWS || Some(kind(table)) == first;
        let (shown, others): (Vec<&Table>, Vec<&Table>) = all.into_iter().partition(is_shown);
        let page = shown.into_iter().fold(self, Page::table);
        if others.is_empty() {
            return page;
        }
        let mut kinds: Vec<String> = others.iter().map(|table| kind(table)).collect();
        kinds.dedup();
        let tables: String = others.into_iter().map(Table::html).collect();
        page.element(&format!(
            "<details><summary>{}</summary>\n{tables}</details>",
            escaped(&kinds.join(", "))
        ))
    }

    /// Adds a figure with its title and a caption below, as drawn for print and as data for the script;
    /// `files` are names of files beside the page that hold the same picture.
    pub fn figure(mut self, figure: &Figure, picture: &Picture, files: &[&str]) -> Page {
        let title = escaped(figure.title.trim_end_matches('.'));
        let mut below = escaped(&figure.caption);
        for file in files {
            let _ = write!(below, " <a href=\"./{0}\">{0}</a>", escaped(file));
        }
        let data = figure.data(&mut self.matrices);
        let svg = &picture.svg;
        let width = picture.width.round();
        let inside = match (data, files.first()) {
            (None, _) => svg.clone(),
            // Without scripts a map is replaced by the name of its file: its picture would be half of the
            // page.
            (Some(data), Some(file)) if figure.has_map() => {
                self.place(data, &format!("<p>The map is in {}.</p>\n", escaped(file)))
            }
            (Some(data), _) => self.place(data, svg),
        };
        self.element(&format!(
            "<figure style=\"--width:{width}\">\n<h3>{title}</h3>\n{inside}<figcaption>{}</figcaption>\n</figure>",
            below.trim_end()
        ))
    }

    /// The element in which the script draws a figure, with the printed version for a reader without
    /// scripts.
    fn place(&mut self, data: Value, without: &str) -> String {
        self.figures.push(data);
        let number = self.figures.len() - 1;
        format!("<div class=\"panels\" data-figure=\"{number}\"></div>\n<noscript>\n{without}</noscript>\n")
    }

    /// Adds sliders for the parameters of a rig, with the predicted curves and motion. `start` holds `rig`
    /// with its keys in SI units, `force` in N, contact `stiffness` in N/m (0: rigid), `frequency` of the
    /// motion, `from` and `to` in Hz, `low` and `high` of amplitudes in mm, and `measured`: `name`, `mass`,
    /// `down`, lists `x` in Hz and `y` in mm.
    pub fn what_if(mut self, start: Value) -> Page {
        self.whatif = Some(start);
        self.element("<div id=\"what-if\"></div>\n<noscript><p>This part needs scripts.</p></noscript>")
    }

    /// Adds a collapsed part, such as the sources of the data: pairs of name and text. Line breaks of the
    /// text are kept.
    pub fn details<'a>(self, name: &str, pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> Page {
        let mut list = String::new();
        for (name, text) in pairs {
            let lines: Vec<String> = text.lines().map(escaped).collect();
            let _ = writeln!(list, "<dt>{}</dt><dd>{}</dd>", escaped(name), lines.join("<br>"));
        }
        self.element(&format!("<details><summary>{}</summary>\n<dl>\n{list}</dl></details>", escaped(name)))
    }

    /// The whole page.
    pub fn html(&self) -> String {
        let title = escaped(&self.title);
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{STYLE}{PLOTS}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n"
        );
        if self.headings.len() > 1 {
            out.push_str("<nav aria-label=\"Contents\">\n");
            for (k, heading) in self.headings.iter().enumerate() {
                let _ = writeln!(out, "<a href=\"#part-{}\">{}</a>", k + 1, escaped(heading));
            }
            out.push_str("</nav>\n");
        }
        out.push_str(&self.body);
        out.push_str("</main>\n");
        if !self.figures.is_empty() || self.body.contains("<table") {
            let data = json!({ "figures": self.figures, "matrices": self.matrices, "whatif": self.whatif });
            packed(&mut out, "data", &gzip(data.to_string().as_bytes()));
            if self.whatif.is_some() {
                packed(&mut out, "model", MODEL);
            }
            for script in SCRIPTS {
                let _ = writeln!(out, "<script>{script}</script>");
            }
        }
        out.push_str("</body>\n</html>\n");
        out
    }

    /// Adds an element, as HTML.
    fn element(mut self, html: &str) -> Page {
        self.body.push_str(html);
        self.body.push('\n');
        self
    }
}

/// Adds gzip data as base64, so that markup in names cannot end the script element.
fn packed(out: &mut String, id: &str, bytes: &[u8]) {
    let _ =
        writeln!(out, "<script type=\"application/gzip\" id=\"{id}\">{}</script>", STANDARD.encode(bytes));
}

/// The bytes packed by gzip.
fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    // Writing to a vector cannot fail.
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

/// The model in WebAssembly, made by `crates/vibro-whatif/build.sh`.
const MODEL: &[u8] = include_bytes!("assets/page/whatif.wasm.gz");

/// Styles of the page, and of its plots.
const STYLE: &str = include_str!("assets/page.css");
const PLOTS: &str = include_str!("assets/page/uplot.css");

/// The scripts of the page: uPlot 1.6.32 (MIT, `assets/page/LICENSE-uPlot.txt`), and those of this project.
const SCRIPTS: &[&str] = &[
    include_str!("assets/page/uplot.js"),
    include_str!("assets/page/decode.js"),
    include_str!("assets/page/plot.js"),
    include_str!("assets/page/waterfall.js"),
    include_str!("assets/page/whatif.js"),
    include_str!("assets/page/page.js"),
];

/// Text as HTML; parts between backticks become code.
fn code(text: &str) -> String {
    if text.matches('`').count() % 2 == 1 {
        return text.to_owned();
    }
    let parts = text.split('`').enumerate();
    parts.map(|(i, part)| if i % 2 == 1 { format!("<code>{part}</code>") } else { part.to_owned() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{AxisSpec, Figure, Medium, Plot, Series};

    fn page() -> Page {
        let plot = Plot::new(AxisSpec::frequency(), AxisSpec::new("<y>", "m")).with(Series::line(
            "</script><script>alert(1)</script>",
            [1.0, 2.0],
            [1.0, 2.0],
        ));
        let figure = Figure::single("A \"title\" <i>").panel(plot).caption("caption <b>");
        let drawing = Picture::of(&figure, Medium::Report).unwrap();
        Page::new("Rig <1> & more")
            .findings(&[
                (Severity::Doubt, "<script>alert(1)</script>".to_owned()),
                (Severity::Note, "n".to_owned()),
            ])
            .heading("A & B")
            .paragraph("p > q")
            .figure(&figure, &drawing, &["figures/a b.svg", "javascript:x"])
            .figure(&figure, &drawing, &[])
            .table(&Table::new("").column("a", "").row(["<td>".into()]))
            .details("Where <from>", [("file", "C:\\a<b>\nsecond")])
    }

    /// The page without the scripts of the project, which hold no text from files.
    fn without_scripts(html: &str) -> String {
        SCRIPTS
            .iter()
            .fold(html.to_owned(), |html, script| html.replace(&format!("<script>{script}</script>"), ""))
    }

    #[test]
    fn the_page_is_well_formed_and_holds_no_foreign_markup() {
        let html = without_scripts(&page().html());
        for foreign in ["<script>", "alert(1)</", "<i>", "<1>", "<y>", "<from>"] {
            assert!(!html.contains(foreign), "{foreign}");
        }
        assert_eq!(html.matches("</script>").count(), 1);
        assert!(!html.contains("href=\"javascript:"));
        assert!(html.contains("href=\"./figures/a b.svg\"") && html.contains("href=\"./javascript:x\""));
        // Apart from void elements and the document type the page is XML, which the parser of usvg checks.
        let body = html.replace("<!DOCTYPE html>", "").replace("<br>", "<br/>");
        let body = body
            .replace("charset=\"utf-8\">", "charset=\"utf-8\"/>")
            .replace("initial-scale=1\">", "initial-scale=1\"/>");
        assert!(
            resvg::usvg::roxmltree::Document::parse(&body).is_ok(),
            "{:?}",
            resvg::usvg::roxmltree::Document::parse(&body)
        );
    }

    #[test]
    fn tables_of_another_kind_than_the_first_are_collapsed() {
        let table = |title: &str| Table::new(title).column("a", "").row(["x".into()]);
        let html = Page::new("").tables(&["Modes, a", "Levels, a", "Modes, b"].map(table)).html();
        let (seen, folded) = html.split_once("<details><summary>Levels</summary>").unwrap();
        assert!(
            seen.contains("Modes, a") && seen.contains("Modes, b") && folded.contains("Levels, a"),
            "{html}"
        );
    }

    #[test]
    fn the_page_needs_nothing_from_outside() {
        let html = page().html();
        assert!(!html.contains("url(") && !html.contains("@import") && !html.contains(" src="));
        assert!(!html.replace("http://www.w3.org/2000/svg", "").contains("http:"));
    }

    #[test]
    fn a_matrix_that_two_figures_show_stands_in_the_page_once() {
        use crate::figure::Waterfall;
        let matrix = ndarray::Array2::from_shape_fn((3, 40), |(i, k)| (1 + i * k) as f64);
        let lines: Vec<f64> = (0..40).map(f64::from).collect();
        let height = AxisSpec::new("Displacement", "m");
        let waterfall = Waterfall::new(&lines, &[1.0, 2.0, 3.0], &matrix, height).unwrap();
        let figure = Figure::single("w").panel(waterfall);
        let drawing = Picture::of(&figure, Medium::Report).unwrap();
        let page = Page::new("").figure(&figure, &drawing, &[]).figure(&figure, &drawing, &[]);
        assert_eq!((page.matrices.len(), page.figures.len()), (1, 2));
    }

    /// The vendored file is that of the package uplot 1.6.32: 51 081 bytes.
    #[test]
    fn the_plotter_is_the_published_one() {
        assert_eq!(SCRIPTS[0].len(), 51_081);
        assert!(SCRIPTS[0].starts_with("/*! https://github.com/leeoniya/uPlot (v1.6.32) */"));
    }
}
