//! Archives and workbooks made by the tests, compared with the same table read from plain text.

use crate::folder::Folder;
use crate::limit::Limit;
use crate::reader::Reader;
use crate::recording::Recording;
use crate::tests::has_finding;
use sha2::{Digest as _, Sha256};
use std::io::{Cursor, Write};
use std::path::Path;
use vibro_record::{Record, Trace};
use zip::unstable::write::FileOptionsExt;
use zip::write::SimpleFileOptions;

/// Rows of the test table.
const N: u32 = 200;

/// Table of time and two channels sampled at 400 Hz, its columns separated by `mark`.
fn table(mark: char) -> String {
    let row = |i| {
        format!(
            "{}{mark}{}{mark}{}\n",
            f64::from(i) / 400.0,
            (f64::from(i) * 0.3).sin(),
            f64::from(i % 7) / 8.0
        )
    };
    (0..N).fold(format!("Time (s){mark}Acceleration x (m/s^2){mark}Force (N)\n"), |text, i| text + &row(i))
}

fn archive(files: &[(&str, &[u8])], options: SimpleFileOptions) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        writer.start_file(*name, options).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn packed(files: &[(&str, &[u8])]) -> Vec<u8> {
    archive(files, SimpleFileOptions::default())
}

fn traces(recording: &Recording) -> Vec<&Trace> {
    recording.records.iter().filter_map(|r| if let Record::Trace(t) = r { Some(t) } else { None }).collect()
}

/// Asserts that a file has the values, units and axis of the plain-text table.
fn same(name: &str, bytes: &[u8]) -> Recording {
    let text = Reader::new().from_reader("x.csv", table(',').as_bytes()).unwrap();
    let found = Reader::new().from_reader(name, bytes).unwrap();
    assert_eq!(traces(&found).len(), 2, "{name}");
    for (a, b) in traces(&found).iter().zip(traces(&text)) {
        assert_eq!((&a.values, &a.axis, &a.meta.name), (&b.values, &b.axis, &b.meta.name), "{name}");
        assert_eq!((&a.meta.unit, a.meta.resolution), (&b.meta.unit, b.meta.resolution), "{name}");
    }
    found
}

const DEVICE: &[u8] = b"property,value\nversion,1.1.11\nbuild,1234\n";
const EVENTS: &[u8] = b"\"event\",\"experiment time\"\n\"START\",0.0\n\"PAUSE\",0.5\n";

#[test]
fn the_table_of_an_archive_is_read_and_the_rest_named() {
    let raw = table(',');
    let files = [("meta/device.csv", DEVICE), ("Raw Data.csv", raw.as_bytes()), ("meta/time.csv", EVENTS)];
    let found = same("phyphox.zip", &packed(&files));
    let parts = ["part=Raw Data.csv", "meta/device.csv"];
    assert!(has_finding(&found.findings, "parts-left-out", &parts), "{:?}", found.findings);
    let found = same("x.zip", &packed(&[("a/b.csv", raw.as_bytes()), ("__MACOSX/a/._b.csv", b"\0\x05")]));
    assert!(found.findings.is_empty(), "{:?}", found.findings);
}

#[test]
fn one_of_several_tables_is_named_by_its_path() {
    let raw = table(',');
    let files = packed(&[("a.csv", raw.as_bytes()), ("sub/b.csv", raw.replace("Force", "Kraft").as_bytes())]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.zip");
    std::fs::write(&path, &files).unwrap();
    let said = Reader::new().from_path(&path).unwrap_err().to_string();
    assert!(said.contains("a.csv (200 rows), sub/b.csv (200 rows)"), "{said}");
    // The path that the hint proposes opens its part.
    let typed = said.rsplit("name one: ").next().unwrap().lines().next().unwrap();
    assert_eq!(traces(&Reader::new().from_path(typed).unwrap())[1].meta.name, "Force");
    let second = Reader::new().from_path(path.join("sub/b.csv")).unwrap();
    assert_eq!(traces(&second)[1].meta.name, "Kraft");
    let streamed = Reader::new().stream(path.join("sub/b.csv")).unwrap();
    assert_eq!(streamed.channels().len(), 2);
    let said = Reader::new().from_path(path.join("c.csv")).unwrap_err().to_string();
    assert!(said.contains("no part of the name \"c.csv\"; expected one of a.csv, sub/b.csv"), "{said}");
}

#[test]
fn a_path_means_a_part_on_a_disk_and_in_memory() {
    let raw = table(',');
    let two = packed(&[("a.csv", raw.as_bytes()), ("sub/b.csv", raw.as_bytes())]);
    let one = packed(&[("a.csv", raw.as_bytes()), ("device.csv", DEVICE)]);
    let files = [("two.zip", two.clone()), ("one.zip", one), ("plain.csv", raw.clone().into_bytes())];
    let root = tempfile::tempdir().unwrap();
    for (name, bytes) in &files {
        std::fs::write(root.path().join(name), bytes).unwrap();
    }
    for folder in [Folder::from(root.path()), Folder::memory(root.path(), files)] {
        let at = |name: &str| root.path().join(name);
        let (archive, part) = (at("two.zip"), at("two.zip/sub/b.csv"));
        assert_eq!(folder.part(&part), Some((archive.as_path(), Path::new("sub/b.csv"))));
        assert!(folder.exists(&part) && folder.part(&archive).is_none());
        assert!(!folder.exists(&at("gone.zip/a.csv")) && folder.part(root.path()).is_none());
        // A part has the digest and the time stamp of its archive.
        assert_eq!(folder.digest(&part).unwrap(), <[u8; 32]>::from(Sha256::digest(&two)));
        assert!(folder.stamp(&part).is_some() && folder.stamp(&part) == folder.stamp(&archive));
        let reader = Reader::new().within(&folder);
        assert_eq!(traces(&reader.from_path(&part).unwrap()).len(), 2);
        assert!(folder.opened(&archive) && !folder.opened(&at("one.zip")));
        assert_eq!(reader.parts(&archive).unwrap(), [at("two.zip/a.csv"), part]);
        for name in ["one.zip", "plain.csv", "two.zip/a.csv"] {
            assert!(reader.parts(at(name)).unwrap().is_empty(), "{name}");
        }
        let said = reader.from_path(at("plain.csv/a.csv")).unwrap_err().to_string();
        assert!(said.contains("expected an archive or a workbook"), "{said}");
    }
}

#[test]
fn archives_that_cannot_be_read_are_refused() {
    let raw = table(',');
    let whole = packed(&[("a.csv", raw.as_bytes())]);
    let said = |bytes: &[u8], limit| {
        Reader::new().max_memory(Limit(limit)).from_reader("x.zip", bytes).unwrap_err().to_string()
    };
    let secret = SimpleFileOptions::default().with_deprecated_encryption(b"secret").unwrap();
    let bomb = vec![b'0'; 3_000_000];
    let mut broken = whole.clone();
    broken[60] ^= 0x55;
    // Local and central header declare 1000 bytes instead of the true size.
    let mut lying = packed(&[("a.csv", &bomb)]);
    let places: Vec<usize> =
        (0..lying.len() - 4).filter(|i| lying[*i..*i + 4] == 3_000_000u32.to_le_bytes()).collect();
    assert_eq!(places.len(), 2);
    for at in places {
        lying[at..at + 4].copy_from_slice(&1000u32.to_le_bytes());
    }
    for (bytes, limit, words) in [
        (archive(&[("a.csv", raw.as_bytes())], secret), 1e9, "it is protected by a password"),
        (packed(&[("a.csv", &bomb)]), 2e6, "it needs 3.0 MB of memory, the limit is 2.0 MB"),
        (lying, 2e6, "larger than its declared"),
        (broken, 1e9, "cannot be unpacked"),
        (whole[..whole.len() / 2].to_vec(), 1e9, "its end is missing"),
        (packed(&[("inner.zip", &whole)]), 1e9, "it holds another packed file: inner.zip"),
        (packed(&[("readme.txt", b"no numbers"), ("b.zip", &whole)]), 1e9, "unpack it, and name b.zip"),
        (packed(&[("readme.txt", b"no numbers"), ("b.txt", b"here")]), 1e9, "no table of numbers"),
    ] {
        let said = said(&bytes, limit);
        assert!(said.contains(words), "{words}: {said}");
    }
}

#[cfg(feature = "sheets")]
mod sheets {
    use super::*;
    use proptest::prelude::*;
    use rust_xlsxwriter::{Format, Workbook};

    fn workbook(fill: impl FnOnce(&mut Workbook)) -> Vec<u8> {
        let mut book = Workbook::new();
        fill(&mut book);
        book.save_to_buffer().unwrap()
    }

    /// Cells of the table as text, row by row.
    fn cells() -> Vec<Vec<String>> {
        table('\t').lines().map(|line| line.split('\t').map(str::to_owned).collect()).collect()
    }

    fn fill(book: &mut Workbook, name: &str) {
        let sheet = book.add_worksheet().set_name(name).unwrap();
        for (r, row) in cells().iter().enumerate() {
            for (c, cell) in row.iter().enumerate() {
                let (r, c) = (r as u32, c as u16);
                let _ = match cell.parse::<f64>() {
                    Ok(value) => sheet.write_number(r, c, value).unwrap(),
                    Err(_) => sheet.write_string(r, c, cell).unwrap(),
                };
            }
        }
    }

    #[test]
    fn the_table_of_a_workbook_is_read_and_other_sheets_named() {
        let found = same(
            "x.xlsx",
            &workbook(|book| {
                book.add_worksheet()
                    .set_name("Metadata Device")
                    .unwrap()
                    .write_string(0, 0, "version")
                    .unwrap();
                fill(book, "Raw Data");
            }),
        );
        let parts = ["part=Raw Data", "parts=Metadata Device"];
        assert!(has_finding(&found.findings, "parts-left-out", &parts), "{:?}", found.findings);
    }

    #[test]
    fn a_hidden_sheet_gives_way_to_one_that_is_shown() {
        let found = same(
            "x.xlsx",
            &workbook(|book| {
                fill(book, "Shown");
                let hidden = book.add_worksheet().set_name("Old").unwrap();
                for row in 0..20 * N {
                    hidden.write_number(row, 0, f64::from(row)).unwrap();
                }
                hidden.set_hidden(true);
            }),
        );
        let parts = ["part=Shown", "parts=Old (hidden)"];
        assert!(has_finding(&found.findings, "parts-left-out", &parts), "{:?}", found.findings);
    }

    #[test]
    fn a_column_in_percent_is_said() {
        let findings = |name: &str| {
            let bytes = workbook(|book| {
                let sheet = book.add_worksheet();
                sheet.write_string(0, 0, "Time (s)").unwrap();
                sheet.write_string(0, 1, name).unwrap();
                for row in 1..N {
                    sheet.write_number(row, 0, f64::from(row) / 400.0).unwrap();
                    sheet.write_number(row, 1, f64::from(row % 7) / 100.0).unwrap();
                }
            });
            Reader::new().from_reader("x.xlsx", bytes.as_slice()).unwrap().findings
        };
        assert!(has_finding(&findings("Slip (%)"), "sheet-in-percent", &["column=Slip (%)"]));
        assert!(!has_finding(&findings("Force (N)"), "sheet-in-percent", &[]));
    }

    fn sheet_of(rows: &[[&str; 4]]) -> Vec<u8> {
        workbook(|book| {
            let sheet = book.add_worksheet();
            for (r, row) in rows.iter().enumerate() {
                for (c, cell) in row.iter().enumerate().filter(|(_, cell)| !cell.is_empty()) {
                    let (r, c) = (r as u32, c as u16);
                    let _ = match cell.parse::<f64>() {
                        Ok(value) => sheet.write_number(r, c, value).unwrap(),
                        Err(_) => sheet.write_string(r, c, *cell).unwrap(),
                    };
                }
            }
        })
    }

    #[test]
    fn texts_with_commas_beside_numbers_and_columns_without_values_are_read() {
        let rows = [
            ["Zeit [s]", "Weg [m]", "Notiz", "Kraft [N]"],
            ["0", "0,252", "", "1.234,50"],
            ["0.005", "1,5", "", "-2,5"],
            ["0.01", "-3,000", "", "7"],
        ];
        let found = Reader::new().from_reader("x.xlsx", sheet_of(&rows).as_slice()).unwrap();
        let values: Vec<&[f64]> = traces(&found).into_iter().map(|t| t.values.as_slice()).collect();
        assert_eq!(values, [&[0.252, 1.5, -3.0][..], &[1234.5, -2.5, 7.0]]);
        assert!(has_finding(&found.findings, "columns-empty", &["columns=Notiz"]), "{:?}", found.findings);
        // A cell with a spreadsheet error is a missing value.
        let rows = [rows[0], rows[1], ["0.005", "#DIV/0!", "", "2"], rows[3]];
        let said = Reader::new().from_reader("x.xlsx", sheet_of(&rows).as_slice()).unwrap_err().to_string();
        assert!(said.contains("1 missing value") && said.contains("3 (\"Weg\")"), "{said}");
        let kept =
            Reader::new().allow_missing(true).from_reader("x.xlsx", sheet_of(&rows).as_slice()).unwrap();
        assert!(traces(&kept)[0].values[1].is_nan());
    }

    /// Errors name a cell as the spreadsheet program does (`AA9`), wherever the table begins and also beside
    /// a text column that is left out.
    #[test]
    fn a_cell_has_the_name_that_it_has_in_the_workbook() {
        // ZZ, the last column of two letters, has the number 26 + 26² = 702.
        for (left, name) in [(0, "D9"), (1, "E9"), (23, "AA9"), (24, "AB9"), (698, "ZZ9"), (699, "AAA9")] {
            let bytes = workbook(|book| {
                let sheet = book.add_worksheet();
                for (c, name) in ["time [s]", "state", "a [g]", "F [N]"].iter().enumerate() {
                    sheet.write_string(2, left + c as u16, *name).unwrap();
                }
                for row in 3..30u32 {
                    sheet.write_number(row, left, f64::from(row)).unwrap();
                    sheet.write_string(row, left + 1, "on").unwrap();
                    sheet.write_number(row, left + 2, f64::from(row % 5)).unwrap();
                    if row == 8 {
                        sheet.write_string(row, left + 3, "1.5 N").unwrap();
                    } else {
                        sheet.write_number(row, left + 3, f64::from(row % 7)).unwrap();
                    }
                }
            });
            let read = Reader::new().from_reader("x.xlsx", bytes.as_slice());
            let said = read.unwrap_err().to_string();
            assert!(said.contains(&format!("cell {name}: found \"1.5 N\"")), "{said}");
        }
        let found = Reader::new().from_reader("x.xlsx", workbook(|book| fill(book, "A")).as_slice()).unwrap();
        assert_eq!(found.format.name(), "workbook");
    }

    #[test]
    fn days_of_a_sheet_without_a_format_are_seconds() {
        let days = |start: f64, rate: f64| {
            let row = |i: u32| format!("{:?},{}\n", start + f64::from(i) / rate / 86_400.0, i % 7);
            let text = "Timestamp,a (m/s^2)\n".to_owned() + &(0..400).map(row).collect::<String>();
            Reader::new().from_reader("x.csv", text.as_bytes()).unwrap()
        };
        for (start, rate) in [(45_250.4, 1.0), (45_250.4, 10.0), (45_250.4, 400.0), (0.0, 1.0), (0.25, 400.0)]
        {
            let found = days(start, rate);
            assert!(has_finding(&found.findings, "axis-serial-days", &[]), "{:?}", found.findings);
            // A double rounds a day number of 45 000 by at most 0.32 µs, at both ends of the axis.
            let (trace, off) = (traces(&found)[0], 2.0 * 3.2e-7 * rate / 399.0);
            assert!(
                (trace.axis.at(399) * rate / 399.0 - 1.0).abs() < off,
                "{rate}: {:?}",
                trace.axis.at(399)
            );
        }
        // Not read as days: a time of day in s sampled at 1440 Hz, and a record sampled at 100 kHz.
        for (start, rate) in [(45_250.4, 1.0 / 60.0), (0.0, 1e5 / 86_400.0)] {
            assert!(!has_finding(&days(start, rate).findings, "axis-serial-days", &[]), "{start} {rate}");
        }
    }

    /// In a number cell, −1.234 has three decimals. In a text cell its point might separate thousands.
    #[test]
    fn three_decimals_beside_whole_numbers_are_a_number() {
        let bytes = workbook(|book| {
            let sheet = book.add_worksheet();
            for (c, name) in ["t [s]", "a [V]"].iter().enumerate() {
                sheet.write_string(0, c as u16, *name).unwrap();
            }
            for r in 0..40 {
                sheet.write_number(r + 1, 0, r).unwrap();
                sheet.write_number(r + 1, 1, if r == 3 { -1.234 } else { f64::from(r) }).unwrap();
            }
        });
        let found = Reader::new().from_reader("x.xlsx", bytes.as_slice()).unwrap();
        assert_eq!(traces(&found)[0].values[2..5], [2.0, -1.234, 4.0]);
    }

    #[test]
    fn dates_are_seconds_from_the_first_with_their_resolution() {
        // Across midnight, in steps down to 2.5 ms: a day number as a double resolves 0.6 µs.
        for (with_date, step) in [(true, 0.0025), (true, 0.5), (false, 0.0025)] {
            let bytes = workbook(|book| {
                let sheet = book.add_worksheet();
                let format = Format::new().set_num_format("yyyy-mm-dd hh:mm:ss.000");
                sheet.write_string(0, 0, "Timestamp").unwrap().write_string(0, 1, "a [V]").unwrap();
                let start = if with_date { 45_351.999_99 } else { 0.5 };
                let first = (start * 86_400.0f64).round();
                for i in 0..N {
                    let days = (first + f64::from(i) * step) / 86_400.0;
                    sheet.write_number_with_format(i + 1, 0, days, &format).unwrap();
                    sheet.write_number(i + 1, 1, f64::from(i % 5)).unwrap();
                }
            });
            let found = Reader::new().from_reader("x.xlsx", bytes.as_slice()).unwrap();
            let trace = traces(&found)[0];
            assert_eq!((traces(&found).len(), trace.values.len()), (1, N as usize));
            // The time of day in s is a double: both ends are rounded by half an ulp of 86 400 s.
            let rounding = f64::EPSILON * 86_400.0 / (f64::from(N - 1) * step);
            let error = (trace.rate().unwrap() * step - 1.0).abs();
            assert!(error < rounding, "{step}: {error:e}, {:?}", found.all_findings());
            assert!(has_finding(&found.findings, "axis-clock", &[]), "{:?}", found.findings);
        }
    }

    /// An Excel 97 workbook as [MS-XLS] describes it: a stream of records in a compound file.
    fn compound(rows: &[Vec<String>]) -> Vec<u8> {
        let record = |kind: u16, data: &[u8]| {
            [&kind.to_le_bytes()[..], &(data.len() as u16).to_le_bytes(), data].concat()
        };
        let begin = |kind: u8| record(0x0809, &[0, 6, kind, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        let mut sheet = begin(0x10);
        for (r, row) in rows.iter().enumerate() {
            for (c, cell) in row.iter().enumerate() {
                let at = [r as u16, c as u16, 0].map(u16::to_le_bytes).concat();
                sheet.extend(if let Ok(value) = cell.parse::<f64>() {
                    record(0x0203, &[&at[..], &value.to_le_bytes()].concat())
                } else {
                    let head = (cell.len() as u16).to_le_bytes();
                    record(0x0204, &[&at[..], &head, &[0], cell.as_bytes()].concat())
                });
            }
        }
        sheet.extend(record(0x0a, &[]));
        let name = b"Raw Data";
        let bound =
            |at: u32| record(0x85, &[&at.to_le_bytes()[..], &[0, 0, name.len() as u8, 0], name].concat());
        let globals = |at| [begin(5), bound(at), record(0x0a, &[])].concat();
        let mut stream = [globals(globals(0).len() as u32), sheet].concat();
        stream.resize(stream.len().max(4096), 0);
        let mut file =
            cfb::CompoundFile::create_with_version(cfb::Version::V3, Cursor::new(Vec::new())).unwrap();
        file.create_stream("/Workbook").unwrap().write_all(&stream).unwrap();
        file.flush().unwrap();
        file.into_inner().into_inner()
    }

    #[test]
    fn an_old_workbook_is_read() {
        let found = same("phyphox.xls", &compound(&cells()));
        assert!(found.findings.is_empty(), "{:?}", found.findings);
    }

    #[test]
    fn an_open_document_is_read() {
        let cell = |cell: &String| match cell.parse::<f64>() {
            Ok(_) => format!("<table:table-cell office:value-type=\"float\" office:value=\"{cell}\"/>"),
            Err(_) => {
                format!(
                    "<table:table-cell office:value-type=\"string\"><text:p>{cell}</text:p></table:table-cell>"
                )
            }
        };
        let row = |row: &Vec<String>| {
            format!("<table:table-row>{}</table:table-row>", row.iter().map(cell).collect::<String>())
        };
        let rows: String = cells().iter().map(row).collect();
        let content = format!(
            "<?xml version=\"1.0\"?><office:document-content><office:body><office:spreadsheet>\
             <table:table table:name=\"Raw Data\">{rows}</table:table>\
             </office:spreadsheet></office:body></office:document-content>"
        );
        let kind: &[u8] = b"application/vnd.oasis.opendocument.spreadsheet";
        let list: &[u8] = b"<manifest:manifest/>";
        let files =
            [("mimetype", kind), ("META-INF/manifest.xml", list), ("content.xml", content.as_bytes())];
        same("x.ods", &packed(&files));
    }

    #[test]
    fn a_compound_file_with_cells_far_apart_is_refused() {
        let file = compound(&cells());
        // Row and column of the first text cell follow the four bytes that begin its record.
        let at = file.windows(2).position(|bytes| bytes == [0x04, 0x02]).unwrap() + 4;
        let said = |place: [u16; 2]| {
            let mut file = file.clone();
            file[at..at + 4].copy_from_slice(&place.map(u16::to_le_bytes).concat());
            let reader = Reader::new().max_memory(Limit(1e8));
            reader.from_reader("x.xls", file.as_slice()).unwrap_err().to_string()
        };
        assert!(said([0, 60_000]).contains("a cell lies outside"), "{}", said([0, 60_000]));
        assert!(said([65_535, 255]).contains("of memory, the limit is 100 MB"), "{}", said([65_535, 255]));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
        #[test]
        fn damage_is_refused_or_harmless(old: bool, hits in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
            let mut file = if old { compound(&cells()) } else { workbook(|book| fill(book, "Raw Data")) };
            for (at, byte) in hits {
                let at = at.index(file.len());
                file[at] = byte;
            }
            let _ = Reader::new().max_memory(Limit(1e8)).from_reader("x.xls", file.as_slice());
        }
    }
}
