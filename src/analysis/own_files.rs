//! Names of files that vibro writes for a campaign, except figures and tables of one record.

/// Name of the file of a folder's own campaign.
pub const OWN: &str = "campaign.toml";

/// All numbers of a campaign.
pub const RESULTS: &str = "results.json";
/// The report.
pub const REPORT: &str = "report.html";
/// Digests of the inputs of the results.
pub const INPUTS: &str = "inputs.sha256";
