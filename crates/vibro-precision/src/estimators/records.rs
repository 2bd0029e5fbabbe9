//! The records of the scenes as files, so that other programs estimate from the same ones.

use super::all_scenes;
use super::trial::Numbers;
use serde::Serialize;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use vibro_record::{Error, Result};

/// Row of `records.json`: a record of one setting of a scene.
#[derive(Serialize)]
struct Row {
    scene: &'static str,
    setting: String,
    /// The value that is to be estimated.
    truth: f64,
    /// Unit of the scene's error, in that of the truth.
    unit: f64,
    start: f64,
    step: f64,
    known: Option<f64>,
    /// First of its values in `records.f64`, and their number.
    first: usize,
    count: usize,
}

/// Writes the records that the methods of [`Family::Estimators`](crate::Family) get to a folder that exists:
/// `records.f64` has their values as 64-bit floats, little-endian, and `records.json` a row for each with
/// scene, setting, truth and place. `quick` writes those of a quick run.
///
/// # Errors
/// If a file cannot be written.
pub fn write_records(folder: &Path, quick: bool) -> Result<()> {
    let (values_path, rows_path) = (folder.join("records.f64"), folder.join("records.json"));
    let failed = |error| Error::io("write", &values_path, error);
    let mut file = BufWriter::new(File::create(&values_path).map_err(failed)?);
    let (mut rows, mut first) = (Vec::new(), 0);
    for scene in all_scenes() {
        let mut take = |setting: &str, numbers: Numbers, [truth, unit]: [f64; 2]| {
            let Numbers { start, step, values, known } = numbers;
            for v in &values {
                file.write_all(&v.to_le_bytes()).map_err(failed)?;
            }
            let (scene, count) = (scene.texts[0], values.len());
            let setting = setting.to_owned();
            rows.push(Row { scene, setting, truth, unit, start, step, known, first, count });
            first += count;
            Ok(())
        };
        scene.trials.each_record(quick, &mut take)?;
    }
    file.flush().map_err(failed)?;
    let text = serde_json::to_string(&rows).map_err(|e| failed(e.into()))?;
    std::fs::write(&rows_path, text).map_err(|error| Error::io("write", &rows_path, error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    #[test]
    fn the_records_of_every_scene_are_written_one_after_another() {
        let folder = tempfile::tempdir().unwrap();
        write_records(folder.path(), true).unwrap();
        let text = std::fs::read_to_string(folder.path().join("records.json")).unwrap();
        let rows: Vec<Value> = serde_json::from_str(&text).unwrap();
        let mut next = 0;
        for row in &rows {
            assert_eq!(row["first"].as_u64().unwrap(), next);
            next += row["count"].as_u64().unwrap();
            assert!(row["truth"].as_f64().unwrap() > 0.0 && row["step"].as_f64().unwrap() > 0.0);
        }
        assert_eq!(std::fs::metadata(folder.path().join("records.f64")).unwrap().len(), 8 * next);
        let mut scenes: Vec<&str> = rows.iter().map(|row| row["scene"].as_str().unwrap()).collect();
        scenes.dedup();
        assert_eq!(scenes, all_scenes().iter().map(|s| s.texts[0]).collect::<Vec<_>>());
    }
}
