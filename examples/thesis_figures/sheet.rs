//! One figure of the thesis' matter with what the thesis says of it and what comes out here.

use vibroimpact::figure::Figure;

/// A figure, or a table alone, and the claims that go with it.
pub struct Sheet {
    /// Name of its files; its place in the document.
    pub name: &'static str,
    /// Title.
    pub title: &'static str,
    /// The picture; `None` for a table alone.
    pub figure: Option<Figure>,
    /// What the thesis says, against what is computed.
    pub claims: Vec<Claim>,
}

impl Sheet {
    /// A sheet with a picture.
    pub fn new(name: &'static str, title: &'static str, figure: Figure, claims: Vec<Claim>) -> Sheet {
        Sheet { name, title, figure: Some(figure), claims }
    }

    /// The rows of its table.
    pub fn rows(&self) -> Vec<String> {
        self.claims.iter().map(Claim::row).collect()
    }

    /// The sheet as it stands in the document.
    pub fn markdown(&self) -> String {
        let name = self.name;
        let picture = self.figure.as_ref().map_or_else(String::new, |figure| {
            format!("[![{}](thesis/{name}.png)](thesis/{name}.svg)\n\n{}\n\n", self.title, figure.caption)
        });
        let table = "| what | thesis | here | verdict |\n|---|---|---|---|";
        format!("### {}\n{picture}{table}\n{}\n", self.title, self.rows().join("\n"))
    }
}

/// A claim with its verdict.
pub struct Claim {
    what: String,
    thesis: String,
    here: String,
    verdict: String,
}

impl Claim {
    /// A claim in words; `agrees` is what the computation says of it.
    pub fn told(
        what: impl Into<String>,
        thesis: impl Into<String>,
        here: impl Into<String>,
        agrees: bool,
        why: &str,
    ) -> Claim {
        let verdict = match (agrees, why) {
            (true, "") => "agrees".to_owned(),
            (true, why) => format!("agrees: {why}"),
            (false, why) => format!("does not, because {why}"),
        };
        Claim { what: what.into(), thesis: thesis.into(), here: here.into(), verdict }
    }

    /// A number of the thesis, with which `here` agrees within `tolerance`; shown in `unit` with so many
    /// decimals.
    pub fn number(
        what: impl Into<String>,
        thesis: &str,
        here: f64,
        (decimals, unit): (usize, &str),
        tolerance: f64,
        why: &str,
    ) -> Claim {
        let stated: f64 = thesis.parse().unwrap_or(f64::NAN);
        let agrees = (here - stated).abs() <= tolerance;
        let with = |number: &str| format!("{number} {unit}").trim_end().to_owned();
        Claim::told(what, with(thesis), with(&format!("{here:.decimals$}")), agrees, why)
    }

    /// The number is not the thesis' own but that of an independent computation of the same case: it stands
    /// in parentheses.
    pub fn recomputed(mut self) -> Claim {
        self.thesis = format!("({})", self.thesis);
        self
    }

    fn row(&self) -> String {
        format!("| {} | {} | {} | {} |", self.what, self.thesis, self.here, self.verdict)
    }
}
