//! Names of the files of a campaign that vibro writes, but for figures and tables of one record.

/// Name of the file of a folder's own campaign.
pub const OWN: &str = "campaign.toml";

/// The files of a campaign's results that are not figures or tables of one record.
pub const RESULTS: &str = "results.json";
/// The page.
pub const REPORT: &str = "report.html";
/// What the results were computed from.
pub const INPUTS: &str = "inputs.sha256";
