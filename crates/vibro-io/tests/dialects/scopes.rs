//! Oscilloscopes.

use super::signal::{DX, N, at, fixed, sci, table, value};
use super::{Dialect, Outcome, Refusal, Right, X, ch, read};

/// Time of the first sample in s: scopes record before the trigger.
const START: f64 = -0.005;

fn t(i: usize) -> String {
    sci(at(START, i), 6, 2)
}

fn u(channel: usize, i: usize) -> String {
    sci(value(channel, i), 5, 2)
}

/// Largest rounding error of [`u`] for values below 10.
const U: f64 = 5e-6;

pub const ALL: &[Dialect] = &[
    Dialect {
        of: "Rigol DS1000E",
        oddity: "units in a row below the names, every row ends with a comma",
        file: "NewFile1.csv",
        text: || table("X,CH1,CH2,\nSecond,Volt,Volt,\n", |i| format!("{},{},{},", t(i), u(0, i), u(1, i))),
        outcome: read(&[ch("CH1", "V", 0, 1.0, U), ch("CH2", "V", 1, 1.0, U)], X::Even(START), &[]),
    },
    Dialect {
        of: "Rigol DS1000Z",
        oddity: "start and increment in cells beside the names, rows are numbered",
        file: "NewFile1.csv",
        text: || {
            table("X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-5.000000e-03,5.000000e-04\n", |i| {
                format!("{i},{},{},", u(0, i), u(1, i))
            })
        },
        outcome: read(
            &[ch("CH1", "V", 0, 1.0, U), ch("CH2", "V", 1, 1.0, U)],
            X::Even(START),
            &["rate-from-head"],
        ),
    },
    Dialect {
        of: "Rigol MSO5000",
        oddity: "no time column, `t0 = …, tInc = …` behind the names",
        file: "RigolDS0.csv",
        text: || {
            table("CH1(V),CH2(V),t0 = -5.000000e-03, tInc = 5.000000e-04,\n", |i| {
                format!("{},{},,", u(0, i), u(1, i))
            })
        },
        outcome: read(
            &[ch("CH1", "V", 0, 1.0, U), ch("CH2", "V", 1, 1.0, U)],
            X::Even(START),
            &["rate-from-head"],
        ),
    },
    Dialect {
        of: "Rigol DHO800",
        oddity: "`Time(s),CH1(V)` without blanks before the brackets",
        file: "RigolDS1.csv",
        text: || table("Time(s),CH1(V),CH2(V)\n", |i| format!("{},{},{}", t(i), u(0, i), u(1, i))),
        outcome: read(&[ch("CH1", "V", 0, 1.0, U), ch("CH2", "V", 1, 1.0, U)], X::Even(START), &[]),
    },
    Dialect {
        of: "Siglent SDS1000X-E",
        oddity: "`Source` names the channels above a row of units only",
        file: "SDS00001.csv",
        text: || {
            let head = "Record Length,Analog:128\nSample Interval,0.000500\nVertical Units,V,V\nVertical Scale,1.00,0.50\n\
                        Vertical Offset,0.00,0.00\nHorizontal Units,s\nHorizontal Scale,0.005\nModel Number,SDS1104X-E\n\
                        Serial Number,SDSMMEB\nSoftware Version,7.1.6.1.35\nSource,CH1,CH2\nSecond,Volt,Volt\n";
            table(head, |i| format!("{},{},{}", fixed(at(START, i), 9), u(0, i), u(1, i)))
        },
        outcome: read(&[ch("CH1", "V", 0, 1.0, U), ch("CH2", "V", 1, 1.0, U)], X::Even(START), &[]),
    },
    Dialect {
        of: "GW Instek GDS-1000B, Detail CSV",
        oddity: "no row of names: the last line above the rows is `Waveform Data`",
        file: "DS0001.CSV",
        text: || table(&gw("Detail"), |i| format!("{},{},", t(i), u(0, i))),
        outcome: read(&[ch("CH1", "V", 0, 1.0, U)], X::Even(START), &[]),
    },
    Dialect {
        of: "GW Instek GDS-1000B, Fast CSV",
        oddity: "rows of the converter's counts, 25 a division, under the unit V",
        file: "DS0002.CSV",
        // At 25 V per division and 25 counts per division, one count is 1 V. The factor 1000 keeps the
        // digits of the signal.
        text: || table(&gw("Fast"), |i| format!("{:.0},", 1e3 * value(0, i))),
        outcome: read(&[ch("CH1", "", 0, 1e3, 0.5e-3)], X::Even(0.0), &["rate-from-head", "unit-unsaid"]),
    },
    Dialect {
        of: "Hantek DSO, data file",
        oddity: "`#CLOCK=500uS` is the step, `#UNITS:V` the unit, one number a row behind a comma",
        file: "WaveData.csv",
        text: || table("#CHANNEL:CH1\n#CLOCK=500uS\n#SIZE=128\n#UNITS:V\n", |i| format!("{},", u(0, i))),
        outcome: read(&[ch("CH1", "V", 0, 1.0, U)], X::Even(0.0), &["rate-from-head"]),
    },
    Dialect {
        of: "Hantek DSO2000 (dso-via-scpi)",
        oddity: "a numbered column before the time, raw counts beside the volts",
        file: "foobar.csv",
        text: || {
            table("nr,time,ch1,ch1s\n", |i| {
                format!("{i},{},{},{:.0}", at(0.0, i), u(0, i), 1e3 * value(0, i))
            })
        },
        outcome: read(
            &[ch("ch1", "", 0, 1.0, U), ch("ch1s", "", 0, 1e3, 0.5e-3)],
            X::Even(0.0),
            &["axis-unit-assumed", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "Owon SDS, text",
        oddity: "`Time interval: 0.50000mS`, units in the names, rows numbered between blanks",
        file: "wave.txt",
        text: || {
            let head =
                "Channel : CH1\nFrequency : 318.3Hz\nTime interval : 0.50000mS\n\n  #  CH1_Voltage(mV)\n";
            table(head, |i| format!("{i:5} {:>12}", fixed(1e3 * value(0, i), 2)))
        },
        outcome: read(
            &[ch("CH1_Voltage", "V", 0, 1.0, 5e-6)],
            X::Even(0.0),
            &["column-numbers-rows", "rate-from-head"],
        ),
    },
    Dialect {
        of: "Tektronix TDS2000",
        oddity: "the preamble stands in columns beside the first rows",
        file: "F0000CH1.CSV",
        text: || {
            let said = [
                "Record Length,1.280000e+02,",
                "Sample Interval,5.000000e-04,",
                "Trigger Point,1.0e+01,",
                ",,",
                ",,",
                ",,",
            ];
            let more = [
                "Source,CH1,",
                "Vertical Units,V,",
                "Vertical Scale,1.0e+00,",
                "Horizontal Units,s,",
                "Yzero,0.0,",
            ];
            table("", |i| {
                let key = said.iter().chain(&more).nth(i).copied().unwrap_or(",,");
                format!("{key},{:>12},{:>12},", fixed(at(START, i), 12), fixed(value(0, i), 5))
            })
        },
        outcome: read(&[ch("CH1", "V", 0, 1.0, U)], X::Even(START), &[]),
    },
    Dialect {
        of: "Tektronix MSO, DPO and TBS",
        oddity: "`TIME,CH1` below `Labels`; units in the preamble only",
        file: "tek0001.csv",
        text: || {
            let head = "Model,MSO44\nFirmware Version,1.40.4\n\nPoint Format,Y,Y\nHorizontal Units,s\nHorizontal Scale,0.004\n\
                        Sample Interval,0.0005\nRecord Length,128\nGating,0.0% to 100.0%\nProbe Attenuation,1,1\nVertical Units,V,A\n\
                        Vertical Offset,0,0\nVertical Scale,1,1\nLabels,,\nTIME,CH1,CH2\n";
            table(head, |i| format!("{},{},{}", t(i), u(0, i), u(1, i)))
        },
        outcome: read(&[ch("CH1", "V", 0, 1.0, U), ch("CH2", "A", 1, 1.0, U)], X::Even(START), &[]),
    },
    Dialect {
        of: "Keysight InfiniiVision",
        oddity: "`x-axis,1,2` over `second,Volt,Volt`",
        file: "scope_0.csv",
        text: || table("x-axis,1,2\nsecond,Volt,Volt\n", |i| format!("{},{},{}", t(i), u(0, i), u(1, i))),
        outcome: read(&[ch("1", "V", 0, 1.0, U), ch("2", "V", 1, 1.0, U)], X::Even(START), &[]),
    },
    Dialect {
        of: "Keysight Infiniium, XY pairs",
        oddity: "keys that end with a colon; rows begin below `Data:`",
        file: "wave.csv",
        text: || table(&infiniium(), |i| format!("{},{}", t(i), u(0, i))),
        outcome: read(&[ch("column 2", "V", 0, 1.0, U)], X::Even(START), &[]),
    },
    Dialect {
        of: "Keysight Infiniium, Y values",
        oddity: "one value a row; start and step as `XOrg:` and `XInc:`",
        file: "wavey.csv",
        text: || table(&infiniium(), |i| u(0, i)),
        outcome: read(&[ch("column 1", "V", 0, 1.0, U)], X::Even(START), &["rate-from-head"]),
    },
    Dialect {
        of: "Keysight Infiniium, spectrum",
        oddity: "`XUnits:,Hertz`: `XInc:` is the distance of the lines",
        file: "wavef.csv",
        text: || {
            let head =
                infiniium().replace("XUnits:,second", "XUnits:,Hertz").replace("XOrg:,-5e-3", "XOrg:,0");
            table(&head.replace("XInc:,5e-4", "XInc:,12.5"), |i| u(0, i))
        },
        outcome: read(&[ch("column 1", "V", 0, 1.0, U)], X::Lines(12.5), &["scaling-unsaid"]),
    },
    Dialect {
        of: "LeCroy WaveRunner, spreadsheet",
        oddity: "`Time,Ampl` without units below four lines of segments",
        file: "C1Trace00000.csv",
        text: || {
            let head = "LECROYWR204M,51184,Waveform\nSegments,1,SegmentSize,128\nSegment,TrigTime,TimeSinceSegment1\n\
                        #1,22-Jan-2015 11:35:11,0                 \nTime,Ampl\n";
            table(head, |i| format!("{},{}", at(START, i), u(0, i)))
        },
        outcome: read(&[ch("Ampl", "", 0, 1.0, U)], X::Even(START), &["axis-unit-assumed", "unit-unsaid"]),
    },
    Dialect {
        of: "LeCroy WaveRunner, sequence",
        oddity: "two segments behind each other, each with a time of its own",
        file: "C1Trace00001.csv",
        text: || {
            let head = "LECROYWR204M,51184,Waveform\nSegments,2,SegmentSize,64\nSegment,TrigTime,TimeSinceSegment1\n\
                        #1,22-Jan-2015 11:35:11,0                 \n#2,22-Jan-2015 11:35:12,1.000                 \nTime,Ampl\n";
            table(head, |i| format!("{},{}", at(START, i % (N / 2)), u(0, i)))
        },
        outcome: read(
            &[ch("Ampl", "", 0, 1.0, U)],
            X::Segments(START),
            &["axis-backwards", "axis-unit-assumed", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "Rohde & Schwarz RTB, RTM",
        oddity: "`in s,C1 in V`: the unit behind `in`",
        file: "RTB_01.CSV",
        text: || table("in s,C1 in V,C2 in V\n", |i| format!("{},{},{}", t(i), u(0, i), u(1, i))),
        outcome: read(&[ch("C1", "V", 0, 1.0, U), ch("C2", "V", 1, 1.0, U)], X::Even(START), &[]),
    },
    Dialect {
        of: "Rohde & Schwarz RTM, TXT",
        oddity: "all values in one line, between commas",
        file: "RTM_01.TXT",
        text: || (0..N).map(|i| u(0, i)).collect::<Vec<_>>().join(",").into_bytes(),
        outcome: Outcome::Refused(Refusal {
            words: &["128 columns", "wrapped"],
            option: "`--wrapped`",
            state: |reader| reader.wrapped(Some(true)),
            edit: |text| text,
            right: Right {
                channels: &[ch("", "", 0, 1.0, U)],
                x: X::Numbered,
                findings: &["abscissa-unsaid", "unit-unsaid"],
            },
        }),
    },
    Dialect {
        of: "Rohde & Schwarz RTO, Wfm.csv",
        oddity: "values only: the axis stands in another file",
        file: "RefCurve.Wfm.csv",
        text: || table("", |i| u(0, i)),
        outcome: read(&[ch("", "", 0, 1.0, U)], X::Numbered, &["abscissa-unsaid", "unit-unsaid"]),
    },
    Dialect {
        of: "Yokogawa DL and DLM",
        oddity: "keys in quotes before columns of their own; rows begin with an empty cell",
        file: "000.CSV",
        text: || {
            let head = format!(
                "\"Header Size\",16\n\"Model Name\",\"DLM3054\"\n\"Comment\",\"\"\n\"BlockNumber\",1\n\
                 \"TraceName\",\"CH1\",\"CH2\"\n\"BlockSize\",128,128\n\"VUnit\",\"V\",\"A\"\n\"SampleRate\",2000,2000\n\
                 \"HResolution\",{DX:e},{DX:e}\n\"HOffset\",{START:e},{START:e}\n\"HUnit\",\"s\",\"s\"\n\
                 \"DisplayBlockSize\",128,128\n\"DisplayPointNo.\",1,1\n\"Date\",\"2020/01/24\",\"2020/01/24\"\n\
                 \"Time\",\"12:00:00.00\",\"12:00:00.00\"\n\n"
            );
            table(&head, |i| format!(",{},{}", u(0, i), u(1, i)))
        },
        outcome: read(
            &[ch("CH1", "V", 0, 1.0, U), ch("CH2", "A", 1, 1.0, U)],
            X::Even(START),
            &["rate-from-head"],
        ),
    },
    Dialect {
        of: "Yokogawa DL and DLM, history",
        oddity: "two blocks behind each other, `BlockSize` 64",
        file: "001.CSV",
        text: || {
            let head = "\"Header Size\",6\n\"BlockNumber\",2\n\"TraceName\",\"CH1\"\n\"BlockSize\",64\n\"VUnit\",\"V\"\n\
                        \"HResolution\",5e-4\n\n";
            table(head, |i| format!("{},{}", if i == N / 2 { "\n" } else { "" }, u(0, i)))
        },
        outcome: read(&[ch("CH1", "V", 0, 1.0, U)], X::Even(0.0), &["fewer-values", "rate-from-head"]),
    },
    Dialect {
        of: "PicoScope 6",
        oddity: "units in brackets below the names, a blank line, `∞` where the range ends",
        file: "20200124-0001.csv",
        text: || {
            table("Time,Channel A,Channel B\n(ms),(V),(mV)\n\n", |i| {
                let b = if i == 3 { "-∞".to_owned() } else { fixed(1e3 * value(1, i), 3) };
                format!("{},{},{b}", fixed(1e3 * at(START, i), 5), fixed(value(0, i), 6))
            })
        },
        outcome: Outcome::Refused(Refusal {
            words: &["line 7", "missing", "Channel B"],
            option: "`--allow-missing`",
            state: |reader| reader.allow_missing(true),
            edit: |text| text,
            right: Right {
                channels: &[ch("Channel A", "V", 0, 1.0, 5e-7), ch("Channel B", "V", 1, 1.0, 5e-7)],
                x: X::Even(START),
                findings: &["missing-kept"],
            },
        }),
    },
    Dialect {
        of: "PicoScope 6, text",
        oddity: "`(µs)` below the names, between tabs",
        file: "20200124-0002.txt",
        text: || {
            table("Time\tChannel A\n(µs)\t(V)\n\n", |i| {
                format!("{}\t{}", fixed(1e6 * at(START, i), 3), fixed(value(0, i), 3))
            })
        },
        outcome: read(&[ch("Channel A", "V", 0, 1.0, 5e-4)], X::Even(START), &[]),
    },
    Dialect {
        of: "Digilent WaveForms",
        oddity: "remarks behind `#`, among them the rate",
        file: "acq0001.csv",
        text: || {
            let head = "#Digilent WaveForms Oscilloscope Acquisition\n#Device Name: Discovery2\n#Serial Number: SN:210321A0000\n\
                        #Date Time: 2020-09-28 10:00:00.000\n#Sample rate: 2000Hz\n#Samples: 128\n\
                        #Trigger: Source: Channel 1 Type: Edge Condition: Rise Level: 1 V\n#Channel 1: Range: 500 mV/div Offset: -1 V\n\
                        Time (s),Channel 1 (V),Channel 2 (V)\n";
            table(head, |i| format!("{},{},{}", at(START, i), u(0, i), u(1, i)))
        },
        outcome: read(
            &[ch("Channel 1", "V", 0, 1.0, U), ch("Channel 2", "V", 1, 1.0, U)],
            X::Even(START),
            &[],
        ),
    },
    Dialect {
        of: "Saleae Logic 2",
        oddity: "`Time [s],Channel 0` without a unit of the channel",
        file: "analog.csv",
        text: || {
            table("Time [s],Channel 0\n", |i| format!("{},{}", fixed(at(0.0, i), 9), fixed(value(0, i), 6)))
        },
        outcome: read(&[ch("Channel 0", "", 0, 1.0, 5e-7)], X::Even(0.0), &["unit-unsaid"]),
    },
    Dialect {
        of: "Hioki 8807, 8841",
        oddity: "`SIGNAL` and `VERT_UNITS` name one column more than they have cells; `S` is seconds",
        file: "MEM001.TXT",
        text: || {
            let head = "\"COMMENT\",\"8841 MEM DATA\"\n\"DATE\",\"01-24-2020\"\n\"TIME\",\"15:26:55\"\n\"NUM_SIGS\",3\n\
                        \"INTERVAL\", 5.000E-04\n\"HORZ_UNITS\", \"S\"\n\"VERT_UNITS\", \"S\", \"V\", \"V\"\n\
                        \"SIGNAL\",\"TIME\", \"ACH1\", \"ACH2\"\n\"DATA\"\n";
            table(head, |i| format!("{}, {}, {}", sci(at(0.0, i), 6, 2), u(0, i), u(1, i)))
        },
        outcome: read(&[ch("ACH1", "V", 0, 1.0, U), ch("ACH2", "V", 1, 1.0, U)], X::Even(0.0), &[]),
    },
];

fn gw(mode: &str) -> String {
    format!(
        "Format,1.0B,\nMemory Length,128,\nIntpDistance,0,\nTrigger Address,10,\nTrigger Level,1.160E+00,\nSource,CH1,\nVertical Units,V,\n\
         Vertical Units Div,0,\nVertical Units Extend Div,15,\nLabel,,\nProbe Type,0,\nProbe Ratio,1.000e+00,\nVertical Scale,2.500e+01,\n\
         Vertical Position,0.000e+00,\nHorizontal Units,S,\nHorizontal Scale,5.000E-03,\nHorizontal Position,0.000E+00,\n\
         Horizontal Mode,Main,\nSincET Mode,Real Time,\nSampling Period,5.000e-04,\nHorizontal Old Scale,5.000E-03,\n\
         Horizontal Old Position,0.000E+00,\nFirmware,V1.09,\nMode,{mode},\nWaveform Data,\n"
    )
}

fn infiniium() -> String {
    format!(
        "Revision:,0\nType:,raw\nStart:,0\nPoints:,128\nCount:,1\nXDispRange:,0.04\nXDispOrg:,-0.005\nXInc:,{DX:e}\nXOrg:,{START:e}\n\
         XUnits:,second\nXReference:,Center\nYDispRange:,8\nYDispOrg:,0\nYInc:,1e-6\nYOrg:,0\nYUnits:,Volt\nYReference:,Center\n\
         Max Bandwidth:,4e9\nMin Bandwidth:,0\nData:\n"
    )
}
