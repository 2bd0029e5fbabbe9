//! Proposed tables, together with the files for which there is none.

use super::Table;

/// Proposed tables, and the files without one.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct FoundTables {
    /// Tables of a campaign.
    pub tables: Vec<Table>,
    /// Files without a table, with the reason.
    pub left: Vec<(String, String)>,
}

impl FoundTables {
    /// A single table.
    pub fn table(table: Table) -> FoundTables {
        FoundTables { tables: vec![table], ..FoundTables::default() }
    }

    /// A file without a table, with the reason.
    pub fn left(file: impl Into<String>, why: impl Into<String>) -> FoundTables {
        FoundTables { left: vec![(file.into(), why.into())], ..FoundTables::default() }
    }

    /// Adds the tables of further files, and the files without one.
    pub fn add(&mut self, more: FoundTables) {
        self.tables.extend(more.tables);
        self.left.extend(more.left);
    }

    /// The same tables for another file or for a pattern: the prefix `from` of their names becomes `name`,
    /// the key `file` the value `file`, and their files in words `words`.
    pub fn renamed(&self, from: &str, [name, file, words]: [&str; 3]) -> FoundTables {
        let table = |table: &Table| {
            let mut table = Table { files: words.to_owned(), ..table.clone() };
            for row in &mut table.rows {
                let value: String = serde_json::from_str(&row.value).unwrap_or_default();
                let renamed = match row.key {
                    "file" => file.to_owned(),
                    "name" => name.to_owned() + value.strip_prefix(from).unwrap_or(&value),
                    _ => continue,
                };
                row.value = serde_json::to_string(&renamed).unwrap_or_default();
            }
            table
        };
        let left = self.left.iter().map(|(_, why)| (words.to_owned(), why.clone()));
        FoundTables { tables: self.tables.iter().map(table).collect(), left: left.collect() }
    }

    /// Whether two files have the same tables, their names removed by [`FoundTables::renamed`]. Reasons for
    /// no table are not compared, since they may differ in numbers.
    pub fn agrees(&self, other: &FoundTables) -> bool {
        self.tables == other.tables && self.left.len() == other.left.len()
    }
}
