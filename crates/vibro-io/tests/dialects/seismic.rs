//! Seismology and strong motion: fixed formats, which laboratories with shaking tables also export.

use super::signal::{N, clock, sci, value};
use super::{Dialect, Outcome, Refusal, Right, X, ch, read};

/// `a_line` values per line.
fn wrapped(head: &str, a_line: usize, print: impl Fn(f64) -> String) -> Vec<u8> {
    let mut text = head.to_owned();
    for i in 0..N {
        text.push_str(&print(value(0, i)));
        text.push_str(if (i + 1) % a_line == 0 || i + 1 == N { "\n" } else { "" });
    }
    text.into_bytes()
}

pub const ALL: &[Dialect] = &[
    Dialect {
        of: "PEER, AT2",
        oddity: "five values a line, `NPTS=` and `DT=` in the fourth",
        file: "RSN1_A.AT2",
        text: || {
            let head = "PEER STRONG MOTION DATABASE RECORD\nBENCH 01/24/20, TABLE, 090\nACCELERATION TIME HISTORY IN UNITS OF G\n\
                        NPTS=    128, DT=   .0005 SEC\n";
            wrapped(head, 5, |v| format!("{:>15}", sci(v, 7, 2)))
        },
        outcome: read(&[ch("", "m/s²", 0, 9.80665, 5e-8)], X::Even(0.0), &["rate-from-head"]),
    },
    Dialect {
        of: "K-NET, KiK-net",
        oddity: "eight counts a line; the factor to gal stands in the head",
        file: "BENCH01.EW",
        text: || {
            let head = "Origin Time       2020/01/24 12:00:00\nStation Code      BENCH\nSampling Freq(Hz) 2000Hz\nDuration Time(s)  0.064\n\
                        Dir.              E-W\nScale Factor      3920(gal)/6182761\nMax. Acc. (gal)   1.12\n\
                        Last Correction   2020/01/24 12:00:00\nMemo.\n";
            wrapped(head, 8, |v| format!("{:9.0}", 1e3 * v))
        },
        outcome: Outcome::Refused(Refusal {
            words: &["8 columns", "wrapped"],
            option: "`--wrapped`",
            state: |reader| reader.wrapped(Some(true)),
            edit: |text| text,
            right: Right {
                channels: &[ch("", "", 0, 1e3, 0.5e-3)],
                x: X::Even(0.0),
                findings: &["rate-from-head", "unit-unsaid"],
            },
        }),
    },
    Dialect {
        of: "TIMESERIES, SLIST",
        oddity: "`128 samples, 2000 sps` in free text, six values a line",
        file: "XX.BENCH.txt",
        text: || {
            let head = "TIMESERIES XX_BENCH__HHZ_D, 128 samples, 2000 sps, 2020-01-24T12:00:00.000000, SLIST, FLOAT, M/S\n";
            wrapped(head, 6, |v| format!("{}\t", sci(v, 6, 2)))
        },
        outcome: read(&[ch("", "", 0, 1.0, 5e-7)], X::Even(0.0), &["rate-from-head", "unit-unsaid"]),
    },
    Dialect {
        of: "TIMESERIES, TSPAIR",
        oddity: "a date and time, two blanks, a value",
        file: "XX.BENCH.tspair",
        text: || {
            let head = "TIMESERIES XX_BENCH__HHZ_D, 128 samples, 2000 sps, 2020-01-24T12:00:00.000000, TSPAIR, FLOAT, M/S\n";
            let rows =
                (0..N).map(|i| format!("2020-01-24T{}  {}\n", clock(12, 0.0, i, 6), sci(value(0, i), 6, 2)));
            (head.to_owned() + &rows.collect::<String>()).into_bytes()
        },
        outcome: read(&[ch("column 1", "", 0, 1.0, 5e-7)], X::Even(0.0), &["axis-clock", "unit-unsaid"]),
    },
    Dialect {
        of: "Fortran program",
        oddity: "count and step in the first line, five values a line",
        file: "accel.txt",
        text: || wrapped("   128  0.0005\n", 5, |v| format!("{:>15}", sci(v, 7, 2))),
        outcome: read(&[ch("", "", 0, 1.0, 5e-8)], X::Even(0.0), &["rate-from-head", "unit-unsaid"]),
    },
];
