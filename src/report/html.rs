//! One page that holds a whole report: no script, no network, no other file.

use super::Drawing;
use super::table::Table;
use std::fmt::Write;
use vibro_figure::escaped;

/// A report in the order in which it is read.
///
/// ```
/// use vibroimpact::report::{Page, Table};
/// let page = Page::new("Two-mass rig")
///     .warning("The gap was measured before the test only.")
///     .heading("Resonances")
///     .table(&Table::new("").column("Frequency", "Hz").row([5.58.into()]));
/// assert!(page.html().starts_with("<!DOCTYPE html>"));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    title: String,
    warnings: Vec<String>,
    body: String,
}

impl Page {
    /// A page without content.
    pub fn new(title: impl Into<String>) -> Page {
        Page { title: title.into(), ..Page::default() }
    }

    /// Adds a sentence to the box at the top.
    pub fn warning(mut self, sentence: impl Into<String>) -> Page {
        self.warnings.push(sentence.into());
        self
    }

    /// Begins a section.
    pub fn heading(self, text: &str) -> Page {
        self.element(&format!("<h2>{}</h2>", escaped(text)))
    }

    /// Adds a paragraph.
    pub(crate) fn paragraph(self, text: &str) -> Page {
        self.element(&format!("<p>{}</p>", escaped(text)))
    }

    /// Adds a table.
    pub fn table(self, table: &Table) -> Page {
        self.element(table.html().trim_end())
    }

    /// Adds a figure with its title and a caption below; `files` are names of files beside the page that hold
    /// the same picture.
    pub fn figure(self, drawing: &Drawing, caption: &str, files: &[&str]) -> Page {
        let mut below =
            format!("<b>{}.</b> {}", escaped(drawing.name.trim_end_matches('.')), escaped(caption));
        for file in files {
            let _ = write!(below, " <a href=\"./{0}\">{0}</a>", escaped(file));
        }
        self.element(&format!(
            "<figure style=\"--width:{}\">\n{}<figcaption>{}</figcaption>\n</figure>",
            drawing.size.0.round(),
            drawing.svg(),
            below.trim_end()
        ))
    }

    /// Adds a part that is shown on demand, such as where the data came from: pairs of a name and a text, the
    /// text as it is in lines.
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
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n"
        );
        if !self.warnings.is_empty() {
            out.push_str(
                "<section class=\"warnings\" aria-label=\"Warnings\">\n<h2>Notes and warnings</h2>\n<ul>\n",
            );
            for sentence in &self.warnings {
                let _ = writeln!(out, "<li>{}</li>", escaped(sentence));
            }
            out.push_str("</ul>\n</section>\n");
        }
        out.push_str(&self.body);
        out.push_str("</main>\n</body>\n</html>\n");
        out
    }

    fn element(mut self, html: &str) -> Page {
        self.body.push_str(html);
        self.body.push('\n');
        self
    }
}

const STYLE: &str = include_str!("assets/page.css");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{AxisSpec, Figure, Plot, Series};

    fn page() -> Page {
        let plot = Plot::new(AxisSpec::frequency(), AxisSpec::new("<y>", "m")).with(Series::line(
            "a&b",
            [1.0, 2.0],
            [1.0, 2.0],
        ));
        let drawing = Figure::single("A \"title\" <i>").panel(plot).draw();
        Page::new("Rig <1> & more")
            .warning("<script>alert(1)</script>")
            .heading("A & B")
            .paragraph("p > q")
            .figure(&drawing, "caption <b>", &["figures/a b.svg", "javascript:x"])
            .figure(&drawing, "again", &[])
            .table(&Table::new("").column("a", "").row(["<td>".into()]))
            .details("Where <from>", [("file", "C:\\a<b>\nsecond")])
    }

    #[test]
    fn the_page_is_well_formed_and_holds_no_foreign_markup() {
        let html = page().html();
        for foreign in ["<script", "<i>", "<1>", "<y>", "<from>", "javascript:"] {
            assert!(!html.contains(foreign) || foreign == "javascript:", "{foreign}");
        }
        assert!(!html.contains("href=\"javascript:"));
        assert!(html.contains("href=\"./figures/a b.svg\"") && html.contains("href=\"./javascript:x\""));
        // All but the void elements and the document type is XML, which the parser of usvg can check.
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
    fn the_page_needs_nothing_from_outside_and_has_no_ids() {
        let html = page().html();
        assert!(!html.contains(" id=\"") && !html.contains("url(") && !html.contains("@import"));
        assert!(!html.replace("http://www.w3.org/2000/svg", "").contains("http"));
    }
}
