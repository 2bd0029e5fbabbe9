//! Names of files that vibro writes for a campaign, except figures and tables of one record.

/// Name of the file of a folder's own campaign.
pub const OWN: &str = "campaign.toml";

/// The files of a campaign's results that are not figures or tables of one record.
pub const RESULTS: &str = "results.json";
/// The report.
pub const REPORT: &str = "report.html";
/// Digests of the inputs of the results.
pub const INPUTS: &str = "inputs.sha256";
