use super::*;
use crate::recording::Recording;
use crate::tests::{has_finding, texts};
use proptest::prelude::*;
use vibro_record::Trace;

fn recording(text: &str) -> Result<Recording> {
    crate::reader::Reader::new().from_reader("x.lvm", text.as_bytes())
}

fn traces(recording: &Recording) -> Vec<&Trace> {
    recording
        .records
        .iter()
        .map(|r| if let Record::Trace(trace) = r { trace } else { panic!("{r:?}") })
        .collect()
}

/// The header of the file and that of its first segment, without names and rows.
fn head(separator: &str, x_columns: &str) -> String {
    let s = if separator == "Tab" { '\t' } else { ',' };
    format!(
        "LabVIEW Measurement\nSeparator{s}{separator}\nX_Columns{s}{x_columns}\nMulti_Headings{s}Yes\n***End_of_Header***\n\n"
    )
}

#[test]
fn one_x_column_and_units_above_the_channels() {
    let text = head("Comma", "One")
        + "Channels,2\nSamples,3,3\nY_Unit_Label,N,mm/s\nX_Dimension,Time,Time\nX0,0.0,0.0\nDelta_X,0.001,0.001\n***End_of_Header***\n\
           X_Value,force,v,Comment\n0.000,1,-2\n0.001,3,4,a knock\n0.002,5,6\n";
    let found = recording(&text).unwrap();
    let [force, v] = traces(&found)[..] else { panic!() };
    assert_eq!(
        (force.meta.name.as_str(), force.meta.unit.symbol(), &force.values[..]),
        ("force", "N", &[1.0, 3.0, 5.0][..])
    );
    assert_eq!((v.values[1], v.axis.step()), (4e-3, Some(1e-3)));
    assert!(force.meta.notes.contains(&("Comment".into(), "row 2: a knock".into())));
    assert_eq!(texts(&found.all_findings()), Vec::<String>::new());
}

#[test]
fn no_x_column_and_decimal_commas() {
    let text = head("Tab", "No")
        + "Channels\t1\nSamples\t2\nY_Unit_Label\tV\nX0\t-1,0E+0\nDelta_X\t5,0E-1\n***End_of_Header***\nX_Value\ta\tComment\n\t0,5\n\t1,5\n";
    let found = recording(&text).unwrap();
    let a = traces(&found)[0];
    assert_eq!((&a.values[..], a.axis.start(), a.axis.step()), (&[0.5, 1.5][..], -1.0, Some(0.5)));
}

#[test]
fn an_x_column_a_channel_and_channels_of_other_length() {
    let text = head("Tab", "Multi")
        + "Channels\t2\nSamples\t3\t\t2\nY_Unit_Label\tV\t\tg\nX0\t0\t\t0\nDelta_X\t1\t\t2\n***End_of_Header***\n\
           X_Value\ta\tX_Value\tb\tComment\n0.0\t1.0\t0.0\t4.0\n1.0\t2.0\t2.0\t5.0\n2.0\t3.0\t\t\n";
    let found = recording(&text).unwrap();
    let [a, b] = traces(&found)[..] else { panic!() };
    assert_eq!((a.values.len(), a.axis.step(), b.values.len(), b.axis.step()), (3, Some(1.0), 2, Some(2.0)));
    assert!((b.values[1] / 49.03325 - 1.0).abs() < 1e-12);
}

#[test]
fn segments_and_special_blocks() {
    let segment = |first: f64| {
        format!(
            "Channels\t1\nX0\t0\nDelta_X\t0.1\n***End_of_Header***\nX_Value\ta\tComment\n0.0\t{first:.1}\n0.1\t2.0\n\n"
        )
    };
    let special = "***Start_Special***\nWaveform\t3\n\nanything\n***End_Special***\n";
    let found = recording(&(head("Tab", "One") + &segment(1.0) + special + &segment(7.0))).unwrap();
    let [first, second] = traces(&found)[..] else { panic!() };
    assert_eq!((first.meta.name.as_str(), second.meta.name.as_str(), second.values[0]), ("a", "a (2)", 7.0));
}

#[test]
fn what_the_head_promises_and_the_rows_do_not_hold() {
    let text = head("Tab", "One")
        + "Channels\t2\nSamples\t9\t0\nX0\t0\t0\nDelta_X\t1\t1\n***End_of_Header***\nX_Value\ta\tb\tComment\n0.0\t1.0\t\n0.4\t2.0\t\n1.5\t3.0\t\n";
    let found = recording(&text).unwrap();
    let a = traces(&found)[0];
    assert!(has_finding(&a.meta.findings, "fewer-values", &["declared=9", "n=3"]));
    assert!(has_finding(&a.meta.findings, "axis-uneven", &[]));
    assert!(has_finding(&found.findings, "variable-empty", &["variable=b"]));
    assert_eq!(a.axis.values(), [0.0, 0.4, 1.5]);
    // A word instead of a number.
    let said = recording(&text.replace("2.0", "two")).unwrap_err().to_string();
    assert!(said.contains("line 14") && said.contains("\"two\"") && said.contains("\"a\""), "{said}");
    // A missing value between values.
    let gap = text.replace("0.4\t2.0", "0.4\t");
    assert!(recording(&gap).unwrap_err().to_string().contains("missing"));
    let none = head("Tab", "One");
    assert!(recording(&none).unwrap_err().to_string().contains("without values"));
}

#[test]
fn no_row_is_lost() {
    let text = |rows: &str| {
        head("Tab", "No")
            + "Channels\t1\nX0\t0\nDelta_X\t1\n***End_of_Header***\nX_Value\ta\tComment\n"
            + rows
    };
    // A row of separators only is a missing value.
    let gap = text("\t1.0\n\t\n\t3.0\n\t\n");
    assert!(recording(&gap).unwrap_err().to_string().contains("1 missing value at 2 of \"a\""));
    let kept = crate::reader::Reader::new().allow_missing(true).from_reader("x.lvm", gap.as_bytes()).unwrap();
    let values = &traces(&kept)[0].values;
    assert_eq!((values.len(), values[2]), (3, 3.0));
    let said = recording(&text("\t1.0\n\n\t3.0\n")).unwrap_err().to_string();
    assert!(said.contains("missing value at 2 of"), "{said}");
    let said = recording(&text("\t1.0\n\nChannels\t1\n")).unwrap_err().to_string();
    assert!(said.contains("line 14") && said.contains("begins no head"), "{said}");
    assert!(recording(&text("\t1.0\n\n\n\t\n")).is_ok());
}

#[test]
fn an_x_column_against_the_head() {
    let text = head("Tab", "One")
        + "Channels\t1\nX0\t0\nDelta_X\t0.5\n***End_of_Header***\nX_Value\ta\tComment\n0.0\t1.0\n2.0\t2.0\n4.0\t3.0\n";
    let found = recording(&text).unwrap();
    let a = traces(&found)[0];
    assert_eq!(a.axis.step(), Some(2.0));
    assert!(has_finding(&a.meta.findings, "header-step-differs", &["header=0.5", "step=2"]));
}

proptest! {
    #[test]
    fn damaged_files_never_panic(at in 0usize..200, byte in 0u8..128, end in 0usize..200) {
        let text = head("Tab", "Multi") + "Channels\t1\nSamples\t2\nX0\t0\nDelta_X\t1\n***End_of_Header***\nX_Value\ta\tComment\n0\t1\n1\t2\n";
        let mut bytes = text.into_bytes();
        let n = bytes.len();
        bytes[at % n] = byte;
        let _ = crate::reader::Reader::new().from_reader("x.lvm", &bytes[..n - end % n]);
    }
}
