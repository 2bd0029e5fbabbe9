//! A figure on a topic of the thesis, and the claims of the thesis beside the computed values.

use vibroimpact::figure::Figure;

/// A figure, or only a table, and the claims that belong to it.
pub struct Sheet {
    /// Name of its files and of its place in the document.
    pub name: &'static str,
    /// Title.
    pub title: &'static str,
    /// The picture; `None` for a table without one.
    pub figure: Option<Figure>,
    /// Claims of the thesis against computed values.
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

    /// The sheet as Markdown, as the document contains it.
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
    /// A claim in words; `agrees` is the result of the computation. There is no verdict where the thesis
    /// states nothing ("–").
    pub fn told(
        what: impl Into<String>,
        thesis: impl Into<String>,
        here: impl Into<String>,
        agrees: bool,
        why: &str,
    ) -> Claim {
        let thesis = thesis.into();
        let verdict = match (agrees, why) {
            (true, why) if thesis == "–" => why.to_owned(),
            (true, "") => "agrees".to_owned(),
            (true, why) => format!("agrees: {why}"),
            (false, "") => "does not".to_owned(),
            (false, why) => format!("does not, because {why}"),
        };
        Claim { what: what.into(), thesis, here: here.into(), verdict }
    }

    /// A number of the thesis: `here` agrees if it rounds to that number, otherwise the verdict is the
    /// difference in per cent. `here` is shown in `unit` with `decimals` decimals.
    pub fn number(
        what: impl Into<String>,
        thesis: &str,
        here: f64,
        (decimals, unit): (usize, &str),
        why: &str,
    ) -> Claim {
        let with = |number: &str| format!("{number} {unit}").trim_end().to_owned();
        let shown = with(&format!("{here:.decimals$}"));
        Claim::told(what, with(thesis), shown, true, "").against(thesis, here, why)
    }

    /// The verdict on `here`, compared with the number that the thesis prints.
    pub fn against(self, printed: &str, here: f64, why: &str) -> Claim {
        let stated: f64 = printed.parse().unwrap_or(f64::NAN);
        let decimals = printed.split_once('.').map_or(0, |(_, digits)| digits.len());
        // Slightly more than half of the last digit, so that a tie agrees with either rounding.
        let agrees = (here - stated).abs() <= 0.500_001 * 10f64.powi(-(decimals as i32));
        let percent = 100.0 * (here / stated - 1.0);
        let digits = usize::from(percent.abs() < 10.0);
        let differs = if percent > 1000.0 {
            format!("differs by a factor of {:.0}", here / stated)
        } else {
            format!("differs by {percent:+.digits$} %").replace('-', "−")
        };
        let verdict = if agrees { "agrees" } else { &differs };
        let verdict = if why.is_empty() { verdict.to_owned() } else { format!("{verdict}: {why}") };
        Claim { verdict, ..self }
    }

    /// Whether the claim holds with other forces (N), since the thesis states none; `with` are other values.
    pub fn of_forces(mut self, with: &str, tried: &[(f64, bool)]) -> Claim {
        let of = |holds: bool| {
            let forces: Vec<String> =
                tried.iter().filter(|(_, held)| *held == holds).map(|(force, _)| force.to_string()).collect();
            (!forces.is_empty()).then(|| format!("{with}{} N", forces.join(", ")))
        };
        let verdict = match (of(true), of(false)) {
            (Some(yes), Some(no)) => format!("agrees with {yes}, not with {}", no.trim_start_matches(with)),
            (Some(yes), None) => format!("agrees with {yes}"),
            (None, no) => format!("does not with {}", no.unwrap_or_default()),
        };
        let stated = "the thesis states no force";
        let before = self.verdict.strip_suffix(stated).unwrap_or("");
        self.verdict = format!("{before}{verdict}; {stated}");
        self
    }

    /// A remark behind the verdict.
    pub fn and(mut self, remark: &str) -> Claim {
        self.verdict = format!("{}; {remark}", self.verdict);
        self
    }

    /// The claim holds only with `values`, which the thesis does not state.
    pub fn only_with(mut self, values: &str) -> Claim {
        self.verdict = self.verdict.replacen(
            "agrees",
            &format!("only with {values}, which the thesis does not state"),
            1,
        );
        self
    }

    /// The number is not from the thesis but from an independent computation of the same case; it is shown
    /// in parentheses.
    pub fn recomputed(mut self) -> Claim {
        self.thesis = format!("({})", self.thesis);
        self
    }

    fn row(&self) -> String {
        format!("| {} | {} | {} | {} |", self.what, self.thesis, self.here, self.verdict)
    }
}
