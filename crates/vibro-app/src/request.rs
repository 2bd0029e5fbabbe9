//! What the page asks, and what it gets.

use serde::Deserialize;
use serde_json::Value;

/// What the page asks of a [`Workbench`](crate::Workbench).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum Request {
    /// The recordings of an example, with its campaign, in place of all files.
    Example {
        /// Its name, such as `bench`.
        name: String,
    },
    /// The files of a zip archive that was added, in its place.
    Unpack {
        /// Its name.
        path: String,
    },
    /// What the files are.
    Look,
    /// The campaign among the files, else one that is proposed for them: a record of unknown kind is tried.
    Propose {
        /// The text of the campaign as a person changed it: it stays, and has tables for further files at its
        /// end.
        #[serde(default)]
        known: Option<String>,
    },
    /// The text of the campaign, as a person changed it.
    Edit {
        /// The text.
        text: String,
    },
    /// The value of a key of a table, in TOML; an empty one makes the key a comment.
    State {
        /// Number of the table in the list of [`Request::Propose`], from 0.
        table: usize,
        /// The key.
        key: String,
        /// The value.
        value: String,
        /// Further keys of the table with values that were refused without this one.
        #[serde(default)]
        also: Vec<(String, String)>,
    },
    /// Another kind of record for a table.
    Kind {
        /// Number of the table in the list, from 0.
        table: usize,
        /// The section of the kind.
        section: String,
    },
    /// Runs the campaign.
    Run,
    /// The results with another value of a key of a table, which stays as it is.
    Try {
        /// Number of the table in the list, from 0.
        table: usize,
        /// The key.
        key: String,
        /// The value, in TOML.
        value: String,
    },
    /// Pictures of all records of a file.
    Pictures {
        /// Its name.
        path: String,
    },
    /// A part of the raw trace of a table.
    Trace {
        /// Number of the table, from 0.
        table: usize,
        /// Number of its file, from 0.
        #[serde(default)]
        file: usize,
        /// From this time on, in s.
        from: Option<f64>,
        /// To this time, in s.
        to: Option<f64>,
        /// Number of columns of the picture.
        columns: usize,
    },
    /// The sounds in the trace of a table, among which its impacts are chosen.
    Sounds {
        /// Number of the table, from 0.
        table: usize,
        /// Number of its file, from 0.
        #[serde(default)]
        file: usize,
    },
    /// A file of the results.
    File {
        /// Its name.
        name: String,
    },
    /// The campaign and all results as a zip archive.
    Archive,
}

/// An answer to the page.
#[derive(Debug, Clone, PartialEq)]
pub enum Reply {
    /// An object.
    Json(Value),
    /// Content of a file.
    Bytes(Vec<u8>),
}
