//! Spreadsheets, calculation and simulation programs, and how they store text.

use super::signal::{N, at, clock, comma, fixed, sci, table, value, with_end};
use super::{Dialect, Outcome, Refusal, Right, X, ch, read};

/// Row `i` of time and two channels, printed by `fixed`.
fn row(i: usize, between: &str) -> String {
    [fixed(at(0.0, i), 6), fixed(value(0, i), 6), fixed(value(1, i), 6)].join(between)
}

/// A number with three decimals and thousands separators (`group`).
fn grouped(value: f64, group: &str, decimal: &str) -> String {
    let text = fixed(value.abs(), 3);
    let (whole, rest) = text.split_once('.').unwrap();
    let at = whole.len().saturating_sub(3);
    let whole = if at > 0 { format!("{}{group}{}", &whole[..at], &whole[at..]) } else { whole.to_owned() };
    format!("{}{whole}{decimal}{rest}", if value < 0.0 { "-" } else { "" })
}

/// Force in mN and displacement in µm, with thousands separators.
fn sheet(group: &'static str, decimal: &'static str) -> Vec<u8> {
    table("Zeit [ms];Kraft [mN];Weg [µm]\n", |i| {
        [1e3 * at(0.0, i), 1e3 * value(0, i), 1e3 * value(1, i)].map(|v| grouped(v, group, decimal)).join(";")
    })
}

const SHEET: Right = Right {
    channels: &[ch("Kraft", "N", 0, 1.0, 5e-7), ch("Weg", "m", 1, 1e-3, 5e-7)],
    x: X::Even(0.0),
    findings: &[],
};

const PLAIN: Right = Right {
    channels: &[ch("Kraft", "N", 0, 1.0, 5e-7), ch("Weg", "m", 1, 1e-3, 5e-7)],
    x: X::Even(0.0),
    findings: &[],
};

fn german(end: &str) -> String {
    let bytes = with_end("Zeit [s];Kraft [N];Weg [mm]\n", end, |i| comma(&row(i, ";")));
    String::from_utf8(bytes).unwrap()
}

pub const ALL: &[Dialect] = &[
    Dialect {
        of: "Excel, German",
        oddity: "semicolons, decimal commas, a byte order mark, CR LF",
        file: "Mappe1.csv",
        text: || format!("\u{feff}{}", german("\r\n")).into_bytes(),
        outcome: Outcome::Read(PLAIN),
    },
    Dialect {
        of: "Excel, `Unicode Text`",
        oddity: "UTF-16 with its mark, tabs",
        file: "Mappe1.txt",
        text: || {
            format!("\u{feff}{}", german("\r\n").replace(';', "\t"))
                .encode_utf16()
                .flat_map(u16::to_le_bytes)
                .collect()
        },
        outcome: Outcome::Read(PLAIN),
    },
    Dialect {
        of: "Excel for Mac",
        oddity: "lines end with CR",
        file: "Mappe2.csv",
        text: || german("\r").into_bytes(),
        outcome: Outcome::Read(PLAIN),
    },
    Dialect {
        of: "Excel, hint of the separator",
        oddity: "`sep=;` in the first line",
        file: "Mappe3.csv",
        text: || format!("sep=;\n{}", german("\n")).into_bytes(),
        outcome: Outcome::Read(PLAIN),
    },
    Dialect {
        of: "Excel, German, grouped",
        oddity: "`1.234,567`: points in thousands",
        file: "Mappe4.csv",
        text: || sheet(".", ","),
        outcome: Outcome::Read(SHEET),
    },
    Dialect {
        of: "Excel, French",
        oddity: "`1\u{202f}234,567`: narrow blanks in thousands",
        file: "Classeur1.csv",
        text: || sheet("\u{202f}", ","),
        outcome: Outcome::Read(SHEET),
    },
    Dialect {
        of: "Excel, Swiss",
        oddity: "`1'234.567`: apostrophes in thousands",
        file: "Mappe5.csv",
        text: || sheet("'", "."),
        outcome: Outcome::Read(SHEET),
    },
    Dialect {
        of: "Excel, elapsed time",
        oddity: "`00:01.5`: minutes and seconds",
        file: "Mappe6.csv",
        text: || {
            table("Time,Force [N]\n", |i| {
                format!("{},{}", &clock(0, 59.99, i, 4)[3..], fixed(value(0, i), 6))
            })
        },
        outcome: read(&[ch("Force", "N", 0, 1.0, 5e-7)], X::Even(0.0), &["axis-clock"]),
    },
    Dialect {
        of: "ISO 8601",
        oddity: "`2020-01-24T23:59:59.9995Z` with its zone",
        file: "iso.csv",
        text: || {
            table("time,force [N]\n", |i| {
                let day = if i < 32 { 24 } else { 25 };
                let time =
                    if i < 32 { clock(23, 3600.0 - 0.016 - 1e-9, i, 4) } else { clock(0, 0.0, i - 32, 4) };
                format!("2020-01-{day}T{time}Z,{}", fixed(value(0, i), 6))
            })
        },
        outcome: read(&[ch("force", "N", 0, 1.0, 5e-7)], X::Even(0.0), &["axis-clock"]),
    },
    Dialect {
        of: "German date and time",
        oddity: "`31.01.2020 23:59:59,9995` passes into February",
        file: "Datum.csv",
        text: || {
            table("Zeit;Kraft [N]\n", |i| {
                let (day, time) = if i < 32 {
                    ("31.01", clock(23, 3600.0 - 0.016 - 1e-9, i, 4))
                } else {
                    ("01.02", clock(0, 0.0, i - 32, 4))
                };
                format!("{day}.2020 {};{}", comma(&time), comma(&fixed(value(0, i), 6)))
            })
        },
        outcome: read(&[ch("Kraft", "N", 0, 1.0, 5e-7)], X::Even(0.0), &["axis-clock"]),
    },
    Dialect {
        of: "A clock without a date",
        oddity: "passes midnight",
        file: "Uhr.csv",
        text: || {
            table("Uhrzeit;Kraft [N]\n", |i| {
                comma(&format!("{};{}", clock(23, 3599.99, i, 4), fixed(value(0, i), 6)))
            })
        },
        outcome: read(&[ch("Kraft", "N", 0, 1.0, 5e-7)], X::Even(0.0), &["axis-clock"]),
    },
    Dialect {
        of: "MATLAB, writematrix",
        oddity: "commas, fifteen digits, nothing above",
        file: "matrix.csv",
        text: || table("", |i| format!("{},{}", at(0.0, i), value(0, i))),
        outcome: read(&[ch("column 1", "", 0, 1.0, 1e-15)], X::Unsaid, &["axis-kind-unsaid", "unit-unsaid"]),
    },
    Dialect {
        of: "MATLAB, writetimetable",
        oddity: "`0.0005 sec`: the unit in every cell",
        file: "timetable.csv",
        text: || table("Time,Force\n", |i| format!("{} sec,{}", at(0.0, i), value(0, i))),
        outcome: read(&[ch("Force", "", 0, 1.0, 1e-15)], X::Even(0.0), &["axis-clock", "unit-unsaid"]),
    },
    Dialect {
        of: "DIAdem, LabVIEW; X and Y in pairs",
        oddity: "the same time before every channel",
        file: "pairs.csv",
        text: || {
            table("Time [s];Force [N];Time [s];Way [mm]\n", |i| {
                let (t, a, b) = (fixed(at(0.0, i), 6), fixed(value(0, i), 6), fixed(value(1, i), 6));
                comma(&[t.as_str(), &a, &t, &b].join(";"))
            })
        },
        outcome: read(&[ch("Force", "N", 0, 1.0, 5e-7), ch("Way", "m", 1, 1e-3, 5e-7)], X::Even(0.0), &[]),
    },
    Dialect {
        of: "Excel, US, grouped",
        oddity: "`\"1,234.567\"` in quotes, since commas separate",
        file: "Book2.csv",
        text: || {
            table("Time (s),Force (mN)\n", |i| {
                format!("{},\"{}\"", fixed(at(0.0, i), 6), grouped(1e3 * value(0, i), ",", "."))
            })
        },
        outcome: read(&[ch("Force", "N", 0, 1.0, 5e-7)], X::Even(0.0), &[]),
    },
    Dialect {
        of: "MATLAB, save -ascii",
        oddity: "three blanks before every number",
        file: "matrix.txt",
        text: || {
            table("", |i| {
                [at(0.0, i), value(0, i)]
                    .map(|v| format!("   {}", sci(v, 7, 3).replace("E+0", "e+").replace("E-0", "e-")))
                    .concat()
            })
        },
        outcome: read(&[ch("column 1", "", 0, 1.0, 5e-8)], X::Unsaid, &["axis-kind-unsaid", "unit-unsaid"]),
    },
    Dialect {
        of: "NumPy, savetxt with a header",
        oddity: "names behind `#`, with units in brackets",
        file: "force.dat",
        text: || {
            table("# time[s] force[N]\n", |i| {
                [at(0.0, i), value(0, i)].map(|v| format!("{v:.18e}")).join(" ")
            })
        },
        outcome: read(&[ch("force", "N", 0, 1.0, 1e-15)], X::Even(0.0), &[]),
    },
    Dialect {
        of: "pandas, to_csv",
        oddity: "a first column of row numbers without a name",
        file: "frame.csv",
        text: || table(",time,force [N]\n", |i| format!("{i},{},{}", at(0.0, i), value(0, i))),
        outcome: read(&[ch("force", "N", 0, 1.0, 1e-15)], X::Even(0.0), &["axis-unit-assumed"]),
    },
    Dialect {
        of: "gnuplot, two blocks",
        oddity: "two blank lines between blocks of rows",
        file: "blocks.dat",
        text: || {
            table("# t x\n", |i| {
                let gap = if i == N / 2 { "\n\n" } else { "" };
                format!("{gap}{} {}", fixed(at(0.0, i), 6), fixed(value(0, i), 6))
            })
        },
        outcome: Outcome::Refused(Refusal {
            words: &["line 66", "blank line between rows"],
            option: "remove the blank lines",
            state: |reader| reader,
            edit: |text| text.replace("\n\n\n", "\n"),
            right: Right {
                channels: &[ch("x", "", 0, 1.0, 5e-7)],
                x: X::Even(0.0),
                findings: &["axis-unit-assumed", "unit-unsaid"],
            },
        }),
    },
    Dialect {
        of: "Origin, ASCII",
        oddity: "long names, units and comments in three rows",
        file: "Book1.dat",
        text: || table("Time\tForce\tDisplacement\ns\tN\tmm\n\tsensor 7\tlaser\n", |i| row(i, "\t")),
        outcome: read(
            &[ch("Force", "N", 0, 1.0, 5e-7), ch("Displacement", "m", 1, 1e-3, 5e-7)],
            X::Even(0.0),
            &[],
        ),
    },
    Dialect {
        of: "LTspice",
        oddity: "`V(out)`: what stands in brackets is no unit",
        file: "Draft1.txt",
        text: || {
            table("time\tV(out)\tI(R1)\n", |i| {
                [at(0.0, i), value(0, i), value(1, i)].map(|v| format!("{v:.15e}")).join("\t")
            })
        },
        outcome: read(
            &[ch("V(out)", "", 0, 1.0, 1e-14), ch("I(R1)", "", 1, 1.0, 1e-14)],
            X::Even(0.0),
            &["axis-unit-assumed", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "COMSOL, table",
        oddity: "names and units behind `%`, between wide gaps",
        file: "probe.txt",
        text: || {
            let head = "% Model:              rig.mph\n% Version:            COMSOL 5.6\n% Date:               Jan 24 2020, 12:00\n\
                        % Table:              Probe table\n% Time (s)                Displacement (mm)        Force (N)\n";
            table(head, |i| {
                [at(0.0, i), value(0, i), value(1, i)].map(|v| format!("{:<25}", fixed(v, 9))).concat()
            })
        },
        outcome: read(
            &[ch("Displacement", "m", 0, 1e-3, 5e-10), ch("Force", "N", 1, 1.0, 5e-10)],
            X::Even(0.0),
            &[],
        ),
    },
    Dialect {
        of: "A logger in German, one value a row",
        oddity: "`1.234,500` alone in a row: one number or two",
        file: "Gruppen.txt",
        text: || table("", |i| grouped(1e3 * value(0, i), ".", ",")),
        outcome: Outcome::Refused(Refusal {
            words: &["may be one number or two", "decimal"],
            option: "`--decimal comma`",
            state: |reader| reader.decimal_comma(Some(true)),
            edit: |text| text,
            right: Right {
                channels: &[ch("", "", 0, 1e3, 5e-7)],
                x: X::Numbered,
                findings: &["abscissa-unsaid", "unit-unsaid"],
            },
        }),
    },
    Dialect {
        of: "ImageJ, TrackMate and MTrack2",
        oddity: "a summary of two tracks, a line of words, then the rows",
        file: "Tracks.txt",
        text: || {
            let head = "\tTrack\tLength\tFrames\n1\t1\t33.5\t275\n2\t2\t44.5\t275\nTracks 1 to 1\nTime [s]\tX1 [mm]\n";
            table(head, |i| format!("{}\t{}", fixed(at(0.0, i), 6), fixed(value(0, i), 6)))
        },
        outcome: read(&[ch("X1", "m", 0, 1e-3, 5e-7)], X::Even(0.0), &["table-left-out"]),
    },
    Dialect {
        of: "pandas, joined tables",
        oddity: "rows of `NaN` below the names, before the first value",
        file: "joined.csv",
        text: || {
            table("time [s],strain\nNaN,NaN\nNaN,NaN\n", |i| {
                format!("{},{}", fixed(at(0.0, i), 6), fixed(value(0, i), 6))
            })
        },
        outcome: read(&[ch("strain", "", 0, 1.0, 5e-7)], X::Even(0.0), &["rows-empty", "unit-unsaid"]),
    },
    Dialect {
        of: "LabVIEW, spectrum as LVM",
        oddity: "`FFT` in the name, over an axis that is called a time",
        file: "spectrum.lvm",
        text: || {
            let head = "LabVIEW Measurement\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\n\nChannels\t1\n\
                        Y_Unit_Label\tm/s^2\nX_Dimension\tTime\nX0\t0\nDelta_X\t0.5\n***End_of_Header***\n\
                        X_Value\tAcceleration (FFT)\tComment\n";
            table(head, |i| format!("\t{}", sci(value(0, i), 6, 2)))
        },
        outcome: Outcome::Refused(Refusal {
            words: &["calls itself a spectrum", "base_band"],
            option: "`--base-band 64`",
            state: |reader| reader.base_band(Some(64.0)),
            edit: |text| text,
            right: Right {
                channels: &[ch("Acceleration (FFT)", "m/s²", 0, 1.0, 5e-7)],
                x: X::Lines(0.5),
                findings: &["scaling-unsaid"],
            },
        }),
    },
    Dialect {
        of: "R, write.table",
        oddity: "names in quotes, one fewer than columns: rows have names, too",
        file: "trace.txt",
        text: || {
            table("\"time_s\" \"acc\"\n", |i| {
                format!("\"{}\" {} {}", i + 1, fixed(at(0.0, i), 4), fixed(value(0, i), 6))
            })
        },
        outcome: read(&[ch("acc", "", 0, 1.0, 5e-7)], X::Even(0.0), &["unit-unsaid"]),
    },
];
