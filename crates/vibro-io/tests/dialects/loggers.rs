//! Loggers and data acquisition.

use super::signal::{at, clock, comma, fixed, sci, table, value, with_end};
use super::{Dialect, X, ch, read};

pub const ALL: &[Dialect] = &[
    Dialect {
        of: "Hioki LR8400, LR8450",
        oddity: "eight lines of settings a channel, a column `Event` at the end",
        file: "AUTO0001.CSV",
        text: || {
            let head = "\"File name\",\"AUTO0001.CSV\",\"V 1.00a\"\n\"Title comment\",\"\"\n\"Start trigger time\",\"'09-12-16 13:52:32\"\n\
                        \"CH\",\"A 1- 1\",\"A 1- 2\",\n\"Mode\",\"Voltage\",\"Voltage\",\n\"Range\",\"10V\",\"10V\",\n\"Comment\",\"\",\"\",\n\
                        \"Scaling\",\"OFF\",\"OFF\",\n\"Ratio\",\" 1.00000E+00\",\" 1.00000E+00\",\n\"Offset\",\" 0.00000E+00\",\" 0.00000E+00\"\n\
                        \"Time\",\"1-1[V]\",\"1-2[mV]\",\"Event\",\n";
            table(head, |i| {
                let (a, b) = (sci(value(0, i), 5, 2), sci(1e3 * value(1, i), 5, 2));
                format!("{}, {a}, {b},{:.0},", sci(at(0.0, i), 9, 2), 1e3 * value(2, i))
            })
        },
        outcome: read(
            &[ch("1-1", "V", 0, 1.0, 5e-6), ch("1-2", "V", 1, 1.0, 5e-6), ch("Event", "", 2, 1e3, 0.5e-3)],
            X::Even(0.0),
            &["axis-unit-assumed", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "Campbell TOA5",
        oddity: "names, units and processing in three rows; a timestamp in quotes, a record number",
        file: "CR1000X_Table1.dat",
        text: || {
            let head = "\"TOA5\",\"Bench\",\"CR1000X\",\"12345\",\"CR1000X.Std.03.02\",\"CPU:Bench.CR1X\",\"59064\",\"Table1\"\n\
                        \"TIMESTAMP\",\"RECORD\",\"Accel_x\",\"Accel_y\"\n\"TS\",\"RN\",\"m/s^2\",\"g\"\n\"\",\"\",\"Smp\",\"Smp\"\n";
            table(head, |i| {
                format!(
                    "\"2020-01-24 {}\",{i},{},{}",
                    clock(12, 0.0, i, 4),
                    fixed(value(0, i), 6),
                    fixed(value(1, i), 6)
                )
            })
        },
        outcome: read(
            &[ch("Accel_x", "m/s²", 0, 1.0, 5e-7), ch("Accel_y", "m/s²", 1, 9.80665, 5e-7)],
            X::Even(0.0),
            &["axis-clock", "columns-count"],
        ),
    },
    Dialect {
        of: "Graphtec GL",
        oddity: "number, date and milliseconds in columns of their own; `+` before positive values",
        file: "200124-120000.CSV",
        text: || {
            let head = "Vendor,GRAPHTEC Corporation\nModel,GL980\nVersion,Ver1.20\nSampling interval,500us\nTotal data points,128\n\
                        Start time,2020-01-24,12:00:00\nAMP settings\nCH,Signal name,Input,Range,Filter,Span\nCH1,Force,DC,5V,Off,5.000\n\
                        Data\nNumber,Date&Time,ms,CH1,CH2\nNO.,Time,ms,V,mV\n";
            table(head, |i| {
                let ms = 0.5 * i as f64;
                format!(
                    "{},2020/01/24 12:00:00,{ms:05.1},{:+.5},{:+.2}",
                    i + 1,
                    value(0, i),
                    1e3 * value(1, i)
                )
            })
        },
        outcome: read(
            &[ch("CH1", "V", 0, 1.0, 5e-6), ch("CH2", "V", 1, 1.0, 5e-6)],
            X::Even(0.0),
            &["axis-clock"],
        ),
    },
    Dialect {
        of: "Dewesoft, text",
        oddity: "a head of `key: value`, names with units in brackets between tabs",
        file: "Export.txt",
        text: || {
            let head = "Data export\n\nFile name: Drill_0001.dxd\nStart time: 24.01.2020 12:00:00.000\nNumber of channels: 2\nSample rate: 2000 Hz\n\n\
                        Time (s)\tAI 1/Force (N)\tAI 2/Acc (m/s2)\n";
            table(head, |i| {
                format!("{}\t{}\t{}", fixed(at(0.0, i), 6), sci(value(0, i), 6, 3), sci(value(1, i), 6, 3))
            })
        },
        outcome: read(
            &[ch("AI 1/Force", "N", 0, 1.0, 5e-7), ch("AI 2/Acc", "m/s²", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &[],
        ),
    },
    Dialect {
        of: "HBM catman, ASCII",
        oddity: "tabs and decimal commas, names over units over a row of sensors",
        file: "Versuch.asc",
        text: || {
            let head = "HBM_CATMAN_DATAFILE_40\r\nT0 = 24.01.2020 12:00:00\r\nZeit  1 - Standardmessrate\tKraft\tWeg\r\ns\tN\tmm\r\n\
                        dt=0,5 ms\tU9B\tWA10\r\n";
            with_end(&head.replace("\r\n", "\n"), "\r\n", |i| {
                let row = [fixed(at(0.0, i), 6), fixed(value(0, i), 6), fixed(1e3 * value(1, i), 3)];
                comma(&row.join("\t"))
            })
        },
        outcome: read(&[ch("Kraft", "N", 0, 1.0, 5e-7), ch("Weg", "m", 1, 1.0, 5e-7)], X::Even(0.0), &[]),
    },
    Dialect {
        of: "HBM catman, ASCII without times",
        oddity: "a row of rates below names and units",
        file: "Versuch_2.asc",
        text: || {
            let head = "HBM_CATMAN_DATAFILE_40\nKanal 1\tKanal 2\nKraft\tWeg\nN\tmm\n2000 1/s\t2000 1/s\n";
            table(head, |i| comma(&format!("{}\t{}", fixed(value(0, i), 6), fixed(1e3 * value(1, i), 3))))
        },
        outcome: read(
            &[ch("Kraft", "N", 0, 1.0, 5e-7), ch("Weg", "m", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &["rate-from-head"],
        ),
    },
    Dialect {
        of: "HBM catman, ASCII with keys",
        oddity: "`Kanal`, `Einheit` and `Messrate` before their columns",
        file: "Versuch_3.asc",
        text: || {
            let head = "Kanal\tKraft\tWeg\nEinheit\tN\tmm\nMessrate\t2000 Hz\t2000 Hz\n";
            table(head, |i| comma(&format!("{}\t{}", fixed(value(0, i), 6), fixed(1e3 * value(1, i), 3))))
        },
        outcome: read(
            &[ch("Kraft", "N", 0, 1.0, 5e-7), ch("Weg", "m", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &["rate-from-head"],
        ),
    },
    Dialect {
        of: "imc FAMOS, ASCII",
        oddity: "units in brackets with blanks in them",
        file: "Kanal_001.asc",
        text: || {
            table("Zeit\tKanal_001\tKanal_002\n[ s ]\t[ V ]\t[ m/s^2 ]\n", |i| {
                format!("{}\t{}\t{}", fixed(at(0.0, i), 5), fixed(value(0, i), 6), fixed(value(1, i), 6))
            })
        },
        outcome: read(
            &[ch("Kanal_001", "V", 0, 1.0, 5e-7), ch("Kanal_002", "m/s²", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &[],
        ),
    },
    Dialect {
        of: "LabVIEW, Write to Spreadsheet",
        oddity: "columns between tabs, and nothing else",
        file: "data.txt",
        text: || table("", |i| format!("{}\t{}", fixed(value(0, i), 6), fixed(value(1, i), 6))),
        outcome: read(
            &[ch("column 1", "", 0, 1.0, 5e-7), ch("column 2", "", 1, 1.0, 5e-7)],
            X::Numbered,
            &["abscissa-unsaid", "two-channels", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "LabVIEW, Export Waveforms to Spreadsheet",
        oddity: "`t0` and `delta t` a channel, then dates with decimal commas",
        file: "waveforms.txt",
        text: || {
            let head = "waveform\t[0]\t[1]\nt0\t24.01.2020 12:00:00,000000\t24.01.2020 12:00:00,000000\ndelta t\t0,000500\t0,000500\n\n\
                        time\tY[0]\tY[1]\n";
            table(head, |i| {
                let row = [clock(12, 0.0, i, 6), sci(value(0, i), 6, 1), sci(value(1, i), 6, 1)];
                format!("24.01.2020 {}", comma(&row.join("\t")))
            })
        },
        outcome: read(
            &[ch("Y[0]", "", 0, 1.0, 5e-7), ch("Y[1]", "", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &["axis-clock", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "MCC DAQami, TracerDAQ",
        oddity: "US dates with AM and PM that pass midnight",
        file: "daqami.csv",
        text: || {
            table("Sample,Date/Time,Ai0 (V),Ai1 (V)\n", |i| {
                let (day, time) = if i < 32 {
                    (24, clock(11, 3600.0 - 0.016 - 1e-9, i, 4))
                } else {
                    (25, clock(12, 0.0, i - 32, 4))
                };
                let half = if i < 32 { "PM" } else { "AM" };
                format!("{i},1/{day}/2020 {time} {half},{},{}", fixed(value(0, i), 6), fixed(value(1, i), 6))
            })
        },
        outcome: read(
            &[ch("Ai0", "V", 0, 1.0, 5e-7), ch("Ai1", "V", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &["axis-clock"],
        ),
    },
    Dialect {
        of: "Yokogawa GP, DX; Keyence NR",
        oddity: "date and time in two columns, units in a row of their own",
        file: "000001.csv",
        text: || {
            table("Date,Time,CH01,CH02\n,,V,mm\n", |i| {
                format!(
                    "2020/01/24,{},{},{}",
                    clock(12, 0.0, i, 4),
                    fixed(value(0, i), 6),
                    fixed(1e3 * value(1, i), 3)
                )
            })
        },
        outcome: read(
            &[ch("CH01", "V", 0, 1.0, 5e-7), ch("CH02", "m", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &["axis-clock"],
        ),
    },
    Dialect {
        of: "Yokogawa DX, MV",
        oddity: "`Ch` and `Unit` before tabs, above `Type`, `Kind` and a column of messages",
        file: "010203.txt",
        text: || {
            let head = "YREC\nMeasure Data\tVersion 1.00.00\nModel\tMV1000\nLanguage Code\tShift_JIS\nSampling Interval\t500\tus\n\
                        Ch\t001\t002\tMessage\nTag\tForce\tWay\t\nUnit\tN\tmm\t\nType\tMeas\tMeas\tMessage\n\
                        Kind\tInst\tInst\tCount\nSampling Data\n";
            table(head, |i| {
                let (a, b) = (fixed(value(0, i), 6), fixed(1e3 * value(1, i), 3));
                format!("2020/01/24 {}\t{a}\t{b}\t0", clock(12, 0.0, i, 4))
            })
        },
        outcome: read(
            &[ch("001", "N", 0, 1.0, 5e-7), ch("002", "m", 1, 1.0, 5e-7), ch("Message", "", 0, 0.0, 1.0)],
            X::Even(0.0),
            &["axis-clock", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "Hioki LR8431",
        oddity: "a line of settings for each channel, then the names",
        file: "WAVE0001.CSV",
        text: || {
            let head = "\"File name\",\"WAVE0001.CSV\",\"V 1.00\"\n\"Title comment\",\"\"\n\"Trigger Time\",\"'12-07-01 09:14:03\"\n\
                        \"Ch\",\"Mode\",\"Range\",\"Comment\",\"Scaling\",\"Ratio\",\"Offset\"\n\
                        \"CH-1\",\"Voltage\",\"10V\",\"\",\"Off\",\"-\",\"-\"\n\"CH-2\",\"Voltage\",\"10V\",\"\",\"Off\",\"-\",\"-\"\n\
                        \"ALM\",\"Alarm\",\"\",\"\",\n\"Time\",\"CH-1[V]\",\"CH-2[V]\",\n";
            table(head, |i| {
                format!("{},{}, {},", fixed(at(0.0, i), 5), sci(value(0, i), 5, 2), sci(value(1, i), 5, 2))
            })
        },
        outcome: read(
            &[ch("CH-1", "V", 0, 1.0, 5e-6), ch("CH-2", "V", 1, 1.0, 5e-6)],
            X::Even(0.0),
            &["axis-unit-assumed"],
        ),
    },
    Dialect {
        of: "Thorlabs TSP",
        oddity: "`--.---` where a sensor is missing",
        file: "tsp.csv",
        text: || {
            table("Time [s];Force [N]\n", |i| {
                let force = if i == 7 { "--.---".to_owned() } else { fixed(value(0, i), 3) };
                format!("{};{force}", fixed(at(0.0, i), 5))
            })
        },
        outcome: super::Outcome::Refused(super::Refusal {
            words: &["line 9", "1 missing value "],
            option: "`--allow-missing`",
            state: |reader| reader.allow_missing(true),
            edit: |text| text,
            right: super::Right {
                channels: &[ch("Force", "N", 0, 1.0, 5e-4)],
                x: X::Even(0.0),
                findings: &["missing-kept"],
            },
        }),
    },
    Dialect {
        of: "DATAQ WinDaq",
        oddity: "relative time beside date and time of day",
        file: "windaq.csv",
        text: || {
            table("Relative Time (s),Date,Time,Chan 1 (V),Chan 2 (g)\n", |i| {
                let (a, b) = (fixed(value(0, i), 6), fixed(value(1, i), 6));
                format!("{},01/24/2020,{},{a},{b}", fixed(at(0.0, i), 4), clock(12, 0.0, i, 3))
            })
        },
        outcome: read(
            &[ch("Chan 1", "V", 0, 1.0, 5e-7), ch("Chan 2", "m/s²", 1, 9.80665, 5e-7)],
            X::Even(0.0),
            &[],
        ),
    },
    Dialect {
        of: "Dewetron, over-range",
        oddity: "`OVER` where the range ends, `---` where a sensor is off",
        file: "over.csv",
        text: || {
            table("Time (s),Force (N)\n", |i| {
                let force = match i {
                    20 => "+OVER".to_owned(),
                    40 => "---".to_owned(),
                    _ => fixed(value(0, i), 6),
                };
                format!("{},{force}", fixed(at(0.0, i), 5))
            })
        },
        outcome: super::Outcome::Refused(super::Refusal {
            words: &["line 22", "2 missing values"],
            option: "`--allow-missing`",
            state: |reader| reader.allow_missing(true),
            edit: |text| text,
            right: super::Right {
                channels: &[ch("Force", "N", 0, 1.0, 5e-7)],
                x: X::Even(0.0),
                findings: &["missing-kept"],
            },
        }),
    },
    Dialect {
        of: "dydaqmeas; epoch in ms",
        oddity: "`Time Code` counts milliseconds since 1970",
        file: "epoch_ms.csv",
        text: || {
            table("Timestamp,Kraft [N]\n", |i| {
                format!("{:.1},{}", 1_579_867_200_000.0 + 0.5 * i as f64, fixed(value(0, i), 6))
            })
        },
        outcome: read(&[ch("Kraft", "N", 0, 1.0, 5e-7)], X::Even(0.0), &["axis-epoch"]),
    },
    Dialect {
        of: "Python logger; epoch in s",
        oddity: "`timestamp` counts seconds since 1970",
        file: "epoch.csv",
        text: || {
            table("timestamp,force [N]\n", |i| {
                format!("{:.4},{}", 1_579_867_200.0 + at(0.0, i), fixed(value(0, i), 6))
            })
        },
        outcome: read(&[ch("force", "N", 0, 1.0, 5e-7)], X::Even(0.0), &["axis-epoch"]),
    },
    Dialect {
        of: "Arduino serial monitor",
        oddity: "`12:00:01.123 -> 0.12`: the computer's clock before what was sent",
        file: "serial.txt",
        text: || {
            table("", |i| {
                format!("{} -> {}\t{}", clock(12, 1.0, i, 4), fixed(value(0, i), 4), fixed(value(1, i), 4))
            })
        },
        outcome: read(
            &[ch("column 1", "", 0, 1.0, 5e-5), ch("column 2", "", 1, 1.0, 5e-5)],
            X::Even(0.0),
            &["axis-clock", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "Arduino sketch",
        oddity: "`micros` is the time in µs",
        file: "putty.csv",
        text: || {
            table("micros,ax,ay\n", |i| {
                format!("{},{},{}", 500 * i, fixed(value(0, i), 4), fixed(value(1, i), 4))
            })
        },
        outcome: read(
            &[ch("ax", "", 0, 1.0, 5e-5), ch("ay", "", 1, 1.0, 5e-5)],
            X::Even(0.0),
            &["unit-unsaid"],
        ),
    },
    Dialect {
        of: "Keysight BenchLink 34970A",
        oddity: "`9.9E+37` where the range ends, units in brackets with `DC`",
        file: "benchlink.csv",
        text: || {
            table("Name:,Rig 7\nScan,Time,101 <Tip> (VDC)\n", |i| {
                let tip = if i == 50 { "9.90000000E+37".to_owned() } else { sci(value(0, i), 8, 2) };
                format!("{},01/24/2020 {},{tip}", i + 1, clock(12, 0.0, i, 4))
            })
        },
        outcome: super::Outcome::Refused(super::Refusal {
            words: &["line 53", "1 missing value "],
            option: "`--allow-missing`",
            state: |reader| reader.allow_missing(true),
            edit: |text| text,
            right: super::Right {
                channels: &[ch("101 <Tip>", "V", 0, 1.0, 5e-9)],
                x: X::Even(0.0),
                findings: &["missing-kept", "axis-clock"],
            },
        }),
    },
    Dialect {
        of: "Fluke NetDAQ",
        oddity: "a number alone above the names, quoted instants, no name for them",
        file: "netdaq.csv",
        text: || {
            table("\"C:\\RIG7.CSV\"\n\"tap test, load 3 kg\"\n2\n\"\",\"Tip [V]\"\n", |i| {
                format!("\"01/24/20 {}\",{}", clock(12, 0.0, i, 4), sci(value(0, i), 6, 2))
            })
        },
        outcome: read(&[ch("Tip", "V", 0, 1.0, 5e-7)], X::Even(0.0), &["axis-clock"]),
    },
    Dialect {
        of: "Biopac AcqKnowledge, text",
        oddity: "the column of times is headed `sec`, every row ends with a comma",
        file: "acq.txt",
        text: || {
            table("C:\\Data\\rig7.acq\n0.5 msec/sample\n2 channels\nsec,CH1,CH2,\n", |i| {
                format!("{},{},{},", fixed(at(0.0, i), 6), fixed(value(0, i), 6), fixed(value(1, i), 6))
            })
        },
        outcome: read(
            &[ch("CH1", "", 0, 1.0, 5e-7), ch("CH2", "", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &["unit-unsaid"],
        ),
    },
    Dialect {
        of: "GCDC X16, HAM",
        oddity: "remarks behind `;`, the names behind `;Headers,`",
        file: "DATA-001.CSV",
        text: || {
            let head = ";Title, http://www.gcdataconcepts.com, X16-1D\n;Start_time, 2020-01-24, 12:00:00.000\n;SampleRate, 2000,Hz\n\
                        ;Headers, time,Ax,Ay\n";
            table(head, |i| {
                let counts = |signal: usize| format!("{:.0}", 1e3 * value(signal, i));
                format!("{},{},{}", fixed(at(0.0, i), 4), counts(0), counts(1))
            })
        },
        outcome: read(
            &[ch("Ax", "", 0, 1e3, 0.5e-3), ch("Ay", "", 1, 1e3, 0.5e-3)],
            X::Even(0.0),
            &["axis-unit-by-rate", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "Lansmont SAVER",
        oddity: "`\"Samples/Sec\",2000.0` is the rate, `G` behind an acceleration is gravity",
        file: "event.csv",
        text: || {
            let head = "\"SAVER 9X30\"\n\"Event\",12\n\"Samples/Sec\",2000.0\n\"Sample\",\"Accel X (G)\",\"Accel Y, g\"\n";
            table(head, |i| format!("{},{},{}", i + 1, fixed(value(0, i), 6), fixed(value(1, i), 6)))
        },
        outcome: read(
            &[ch("Accel X", "m/s²", 0, 9.806_65, 5e-7), ch("Accel Y", "m/s²", 1, 9.806_65, 5e-7)],
            X::Even(0.0),
            &["rate-from-head"],
        ),
    },
    Dialect {
        of: "Keyence NR-X",
        oddity: "`Sampling,500 us` is the step, rows are numbered",
        file: "nr-x.csv",
        text: || {
            let head = "Model,NR-X100\nSampling,500 us\nNo.,CH1 (V),CH2 (mV)\n";
            table(head, |i| format!("{},{},{}", i + 1, fixed(value(0, i), 6), fixed(value(1, i), 6)))
        },
        outcome: read(
            &[ch("CH1", "V", 0, 1.0, 5e-7), ch("CH2", "V", 1, 1e-3, 5e-7)],
            X::Even(0.0),
            &["rate-from-head"],
        ),
    },
    Dialect {
        of: "MSR",
        oddity: "names behind `*CHANNEL` and units behind `*UNIT`",
        file: "MSR165.csv",
        text: || {
            let head = "*CREATOR\nMSR Reader\n*STARTTIME\n2024-03-01;12:00:00\n*MODUL;MSR165;MSR165;MSR165\n\
                        *CHANNEL;TIME;ACC x;ACC y\n*UNIT;s;g;g\n*DATA\n";
            table(head, |i| {
                format!("{};{};{}", fixed(at(0.0, i), 4), fixed(value(0, i), 6), fixed(value(1, i), 6))
            })
        },
        outcome: read(
            &[ch("ACC x", "m/s²", 0, 9.806_65, 5e-7), ch("ACC y", "m/s²", 1, 9.806_65, 5e-7)],
            X::Even(0.0),
            &[],
        ),
    },
    Dialect {
        of: "ETAS INCA, ASCII",
        oddity: "a row of types between the names and the units",
        file: "measure.ascii",
        text: || {
            let head = "ETASAsciiItemFile\tmeasure\nrecordName\trec1\nsampleCount\t128\ntime\tacc_z\tdist\nf8\tf8\tf8\ns\tm/s^2\tmm\n";
            table(head, |i| {
                format!("{}\t{}\t{}", fixed(at(0.0, i), 6), fixed(value(0, i), 6), fixed(value(1, i), 6))
            })
        },
        outcome: read(
            &[ch("acc_z", "m/s²", 0, 1.0, 5e-7), ch("dist", "m", 1, 1e-3, 5e-7)],
            X::Even(0.0),
            &[],
        ),
    },
    Dialect {
        of: "LabVIEW SignalExpress",
        oddity: "keys with a colon above their values: rows begin below `data:`",
        file: "voltage.txt",
        text: || {
            let head = "channel names:\t\nDev1_ai0\tDev1_ai1\nstart times:\t\n1/24/2020 12:00:00.000\t1/24/2020 12:00:00.000\n\
                        dt:\t\n0.000500\t0.000500\ndata:\t\n";
            table(head, |i| format!("{}\t{}", sci(value(0, i), 6, 2), sci(value(1, i), 6, 2)))
        },
        outcome: read(
            &[ch("column 1", "", 0, 1.0, 5e-7), ch("column 2", "", 1, 1.0, 5e-7)],
            X::Numbered,
            &["abscissa-unsaid", "two-channels", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "PASCO Capstone",
        oddity: "runs side by side, each behind times of its own",
        file: "runs.csv",
        text: || {
            let head = "Time (s) Run #1,Force (N) Run #1,Time (s) Run #2,Force (N) Run #2\n";
            table(head, |i| {
                let time = fixed(at(0.0, i), 4);
                format!("{time},{},{time},{}", fixed(value(0, i), 6), fixed(value(1, i), 6))
            })
        },
        outcome: read(
            &[ch("Force Run #1", "N", 0, 1.0, 5e-7), ch("Force Run #2", "N", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &[],
        ),
    },
    Dialect {
        of: "A logger in German, rate in the head",
        oddity: "`2.000,0 Hz` in the head, one column with decimal commas",
        file: "messung.csv",
        text: || table("Abtastrate;2.000,0 Hz\nBeschl. [m/s²]\n", |i| comma(&fixed(value(0, i), 6))),
        outcome: read(
            &[ch("Beschl.", "m/s²", 0, 1.0, 5e-7)],
            X::Even(0.0),
            &["decimal-comma-assumed", "rate-from-head"],
        ),
    },
    Dialect {
        of: "ROS and Linux, time as two numbers",
        oddity: "seconds and their parts in two columns",
        file: "imu.csv",
        text: || {
            table("tv_sec,tv_usec,acc [m/s^2]\n", |i| {
                let microseconds = 999_000 + 500 * i;
                let (seconds, rest) = (1_714_560_000 + microseconds / 1_000_000, microseconds % 1_000_000);
                format!("{seconds},{rest},{}", fixed(value(0, i), 6))
            })
        },
        outcome: read(&[ch("acc", "m/s²", 0, 1.0, 5e-7)], X::Even(0.0), &["axis-clock", "axis-rounded"]),
    },
];
