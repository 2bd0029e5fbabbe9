//! Vibrometers, analysers, accelerometers and telephones.

use super::signal::{at, clock, comma, fixed, sci, stamped, table, value, with_end};
use super::{Dialect, X, ch, read};

/// Three axes, each value printed by `print`.
fn xyz(print: impl Fn(f64) -> String, i: usize, between: &str) -> String {
    (0..3).map(|c| print(value(c, i))).collect::<Vec<_>>().join(between)
}

/// `1.234567890E-2`, as Java prints it: without a plus sign.
fn short_sci(value: f64) -> String {
    sci(value, 9, 1).replace("E+", "E")
}

pub const ALL: &[Dialect] = &[
    Dialect {
        of: "phyphox, CSV with commas",
        oddity: "names in quotes, nine digits and an exponent",
        file: "Raw Data.csv",
        text: || {
            let names = ["x", "y", "z"].map(|axis| format!("\"Linear Acceleration {axis} (m/s^2)\""));
            table(&format!("\"Time (s)\",{}\n", names.join(",")), |i| {
                format!("{},{}", short_sci(stamped(0.0, i)), xyz(short_sci, i, ","))
            })
        },
        outcome: read(
            &[
                ch("Linear Acceleration x", "m/s²", 0, 1.0, 5e-10),
                ch("Linear Acceleration y", "m/s²", 1, 1.0, 5e-10),
                ch("Linear Acceleration z", "m/s²", 2, 1.0, 5e-10),
            ],
            X::Even(0.0),
            &["axis-jitter"],
        ),
    },
    Dialect {
        of: "phyphox, CSV with tabs",
        oddity: "the same between tabs; a magnetometer in µT",
        file: "Raw Data.csv",
        text: || {
            table("\"Time (s)\"\t\"Magnetic field x (µT)\"\t\"Magnetic field y (µT)\"\n", |i| {
                [stamped(0.0, i), value(0, i), value(1, i)].map(short_sci).join("\t")
            })
        },
        outcome: read(
            &[ch("Magnetic field x", "T", 0, 1e-6, 5e-10), ch("Magnetic field y", "T", 1, 1e-6, 5e-10)],
            X::Even(0.0),
            &["axis-jitter"],
        ),
    },
    Dialect {
        of: "phyphox, CSV with semicolons",
        oddity: "decimal commas with exponents",
        file: "Rohdaten.csv",
        text: || {
            table("\"Time (s)\";\"Acceleration x (m/s^2)\";\"Acceleration y (m/s^2)\"\n", |i| {
                comma(&[stamped(0.0, i), value(0, i), value(1, i)].map(short_sci).join(";"))
            })
        },
        outcome: read(
            &[ch("Acceleration x", "m/s²", 0, 1.0, 5e-10), ch("Acceleration y", "m/s²", 1, 1.0, 5e-10)],
            X::Even(0.0),
            &["axis-jitter"],
        ),
    },
    Dialect {
        of: "Sensor Logger",
        oddity: "`time` counts nanoseconds since 1970, `seconds_elapsed` the same from the start; axes in reverse",
        file: "Accelerometer.csv",
        text: || {
            table("time,seconds_elapsed,z,y,x\n", |i| {
                let stamp = stamped(0.0, i);
                let since = 1_700_000_000_123_456_789 + (1e9 * stamp).round() as i64;
                format!("{since},{:.9},{},{},{}", stamp + 0.034, value(2, i), value(1, i), value(0, i))
            })
        },
        outcome: read(
            &[ch("z", "", 2, 1.0, 1e-15), ch("y", "", 1, 1.0, 1e-15), ch("x", "", 0, 1.0, 1e-15)],
            X::Even(0.0),
            &["axis-epoch", "axis-jitter", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "SensorLog",
        oddity: "a zone behind the clock, `(N)` behind what counts, `(°)` behind a temperature",
        file: "sensorlog.csv",
        text: || {
            let head = "loggingTime(txt),loggingSample(N),accelerometerTimestamp_sinceReboot(s),accelerometerAccelerationX(G),\
                        motionYaw(rad),T(°),activity(txt),label(N)\n";
            table(head, |i| {
                let values = [value(0, i), value(1, i), value(2, i)].map(|value| fixed(value, 6)).join(",");
                let (at, activity) = (clock(12, 0.0, i, 4), if i < 70 { "stationary" } else { "walking" });
                format!(
                    "2020-01-24 {at} +0100,{},{:.4},{values},{activity},0",
                    i + 1,
                    500.0 + 5e-4 * i as f64
                )
            })
        },
        outcome: read(
            &[
                ch("accelerometerAccelerationX", "m/s²", 0, 9.806_65, 5e-7),
                ch("motionYaw", "rad", 1, 1.0, 5e-7),
                ch("T", "", 2, 1.0, 5e-7),
                ch("label", "", 0, 0.0, 1.0),
            ],
            X::Even(0.0),
            &["axis-clock", "columns-count", "columns-of-words", "unit-against-name"],
        ),
    },
    Dialect {
        of: "AndroSensor",
        oddity: "`7 / 12` satellites in range, times in ms beside dates that are no clock",
        file: "Sensor_record.csv",
        text: || {
            let head = "ACCELEROMETER X (m/s²);GYROSCOPE Z (rad/s);Satellites in range;Time since start in ms ;\
                        YYYY-MO-DD HH-MI-SS_SSS\n";
            table(head, |i| {
                let (a, b) = (fixed(value(0, i), 4), fixed(value(1, i), 4));
                format!("{a};{b};{} / 12;{:.1};2020-01-24 12-00-00_{:03}", 7 + i / 90, 0.5 * i as f64, i / 2)
            })
        },
        outcome: read(
            &[ch("ACCELEROMETER X", "m/s²", 0, 1.0, 5e-5), ch("GYROSCOPE Z", "rad/s", 1, 1.0, 5e-5)],
            X::Even(0.0),
            &["columns-of-words"],
        ),
    },
    Dialect {
        of: "MetaWear",
        oddity: "milliseconds since 1970, then the date with points in the time of day, then the time from the start",
        file: "MetaWear.csv",
        text: || {
            let head = "epoc (ms),timestamp (-07:00),elapsed (s),x-axis (g),y-axis (g)\n";
            table(head, |i| {
                let (ms, date) = (0.5 * i as f64, clock(5, 0.0, i, 4).replace(':', "."));
                let values = [value(0, i), value(1, i)].map(|value| fixed(value, 3)).join(",");
                format!("{:.1},2020-01-24T{date},{:.4},{values}", 1_579_867_200_000.0 + ms, 1e-3 * ms)
            })
        },
        outcome: read(
            &[ch("x-axis", "m/s²", 0, 9.806_65, 5e-4), ch("y-axis", "m/s²", 1, 9.806_65, 5e-4)],
            X::Even(0.0),
            &["axis-clock", "columns-of-words"],
        ),
    },
    Dialect {
        of: "x-IMU3",
        oddity: "whole microseconds of a clock that was on before",
        file: "Inertial.csv",
        text: || {
            table("Timestamp (us),Gyroscope X (deg/s),Accelerometer X (g)\n", |i| {
                let stamp = (1e6 * stamped(12.5, i)).round();
                format!("{stamp},{},{}", fixed(value(0, i), 6), fixed(value(1, i), 6))
            })
        },
        outcome: read(
            &[
                ch("Gyroscope X", "rad/s", 0, std::f64::consts::PI / 180.0, 5e-7),
                ch("Accelerometer X", "m/s²", 1, 9.80665, 5e-7),
            ],
            X::Even(12.5),
            &["axis-jitter"],
        ),
    },
    Dialect {
        of: "Physics Toolbox",
        oddity: "a clock with a colon before the milliseconds, units in no place",
        file: "2020-01-24.csv",
        text: || {
            table("time,gFx,gFy,gFz\n", |i| {
                let time = clock(12, 0.0, 2 * i, 3).replace('.', ":");
                format!("{time},{}", xyz(|v| fixed(v, 4), i, ","))
            })
        },
        outcome: read(
            &[ch("gFx", "", 0, 1.0, 5e-5), ch("gFy", "", 1, 1.0, 5e-5), ch("gFz", "", 2, 1.0, 5e-5)],
            X::Steps(1e-3),
            &["axis-clock", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "enDAQ, Slam Stick (ide2csv)",
        oddity: "no names: seconds, then the axes",
        file: "SSX00001_Ch08.csv",
        text: || table("", |i| format!("{},{}", fixed(at(0.0, i), 6), xyz(|v| fixed(v, 6), i, ","))),
        outcome: read(
            &[
                ch("column 1", "", 0, 1.0, 5e-7),
                ch("column 2", "", 1, 1.0, 5e-7),
                ch("column 3", "", 2, 1.0, 5e-7),
            ],
            X::Unsaid,
            &["axis-kind-unsaid", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "enDAQ, Slam Stick with header",
        oddity: "a full-scale range in brackets where others have a unit",
        file: "SSX00002_Ch08.csv",
        text: || {
            table("\"Time\",\"X (100g)\",\"Y (100g)\"\n", |i| {
                format!("{},{},{}", fixed(at(0.0, i), 6), fixed(value(0, i), 6), fixed(value(1, i), 6))
            })
        },
        outcome: read(
            &[ch("X (100g)", "", 0, 1.0, 5e-7), ch("Y (100g)", "", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &["axis-unit-assumed", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "Polytec VibSoft, PSV: time",
        oddity: "`[ s ]` and `[ m/s ]` below the names, a head of paths",
        file: "Scan_1.txt",
        text: || {
            let head = "Source File Name:\tC:\\Messung\\Drill.pvd\nPoint Index:\t1\nComponent:\tRoot\nSignal:\tTime - Vib Velocity - Samples\n\n\
                        Time\tVelocity\n[ s ]\t[ m/s ]\n";
            table(head, |i| format!("{}\t{}", sci(at(0.0, i), 6, 3), sci(value(0, i), 6, 3)))
        },
        outcome: read(&[ch("Velocity", "m/s", 0, 1.0, 5e-7)], X::Even(0.0), &[]),
    },
    Dialect {
        of: "Polytec VibSoft, PSV: spectrum",
        oddity: "`[ Hz ]` makes it lines of a spectrum",
        file: "Scan_2.txt",
        text: || {
            let head = "Source File Name:\tC:\\Messung\\Drill.pvd\nSignal:\tFFT - Vib Velocity - Magnitude\n\n\
                        Frequency\tMagnitude\n[ Hz ]\t[ mm/s ]\n";
            table(head, |i| format!("{}\t{}", fixed(12.5 * i as f64, 4), sci(1e3 * value(0, i), 6, 3)))
        },
        outcome: read(&[ch("Magnitude", "m/s", 0, 1.0, 5e-7)], X::Lines(12.5), &["scaling-unsaid"]),
    },
    Dialect {
        of: "Brüel & Kjær PULSE, ASCII",
        oddity: "rows are numbered before the time; `X-axis delta` and `Y-axis unit` in the head",
        file: "Time(Signal 1).txt",
        text: || {
            let head = "Header Size:\t9\nTitle1:\tTime(Signal 1)\nDate:\t24-01-2020\nX-axis size:\t128\nX-axis type:\tLin\nX-axis unit:\ts\n\
                        X-axis delta:\t5.0000000e-004\nY-axis unit:\tm/s\u{b2}\nZ-axis size:\t1\n";
            table(head, |i| format!("{}\t{}\t{}", i + 1, sci(at(0.0, i), 7, 3), sci(value(0, i), 7, 3)))
        },
        outcome: read(&[ch("column 1", "m/s²", 0, 1.0, 5e-8)], X::Even(0.0), &["axis-unit-assumed"]),
    },
    Dialect {
        of: "Metra VibroMetra, VM-REC",
        oddity: "`SampleRate=2000` and `UnitName_1=…` above columns without names",
        file: "VM-REC.txt",
        text: || {
            let head = "Version=1.8\nPretrigger=0\nSampleRate=2000\nNumChannels=2\nInputName_1=Lager 12\nUnitName_1=m/s²\nInputName_2=Griff\n\
                        UnitName_2=m/s²\nDataType=text\n";
            table(head, |i| format!("{}\t{}", fixed(value(0, i), 5), fixed(value(1, i), 5)))
        },
        outcome: read(
            &[ch("column 1", "", 0, 1.0, 5e-6), ch("column 2", "", 1, 1.0, 5e-6)],
            X::Even(0.0),
            &["rate-from-head", "two-channels", "unit-unsaid"],
        ),
    },
    Dialect {
        of: "Siemens Testlab, text",
        oddity: "a row of names, then a row of units that begins with `s`, old code page",
        file: "Throughput.txt",
        text: || {
            let text = table(
                "Project\tDrill\nSection\tSection1\n\nTime\tForce\tHandle:+Z\ns\tN\tm/s\u{b2}\n",
                |i| format!("{}\t{}\t{}", fixed(at(0.0, i), 6), fixed(value(0, i), 6), fixed(value(1, i), 6)),
            );
            // Encoded in Latin-1.
            String::from_utf8(text).unwrap().chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect()
        },
        outcome: read(
            &[ch("Force", "N", 0, 1.0, 5e-7), ch("Handle:+Z", "m/s²", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &[],
        ),
    },
    Dialect {
        of: "OROS NVGate, text",
        oddity: "names with brackets in front of them",
        file: "Oros.txt",
        text: || {
            table("Time\t[In1] Force\t[In2] Acc\ns\tN\tg\n", |i| {
                format!("{}\t{}\t{}", sci(at(0.0, i), 6, 2), sci(value(0, i), 6, 2), sci(value(1, i), 6, 2))
            })
        },
        outcome: read(
            &[ch("[In1] Force", "N", 0, 1.0, 5e-7), ch("[In2] Acc", "m/s²", 1, 9.80665, 5e-7)],
            X::Even(0.0),
            &[],
        ),
    },
    Dialect {
        of: "SVANTEK SvanPC++, CSV",
        oddity: "date and time in one cell, semicolons, decimal commas",
        file: "L12.csv",
        text: || {
            table("Date & time;Ch1 [m/s^2];Ch2 [m/s^2]\n", |i| {
                format!(
                    "2020-01-24 {}",
                    comma(&[clock(23, 59.99, i, 4), fixed(value(0, i), 6), fixed(value(1, i), 6)].join(";"))
                )
            })
        },
        outcome: read(
            &[ch("Ch1", "m/s²", 0, 1.0, 5e-7), ch("Ch2", "m/s²", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &["axis-clock"],
        ),
    },
    Dialect {
        of: "Crystal Instruments EDM, CSV",
        oddity: "a head of keys and values between commas above `Time (s)`",
        file: "SIG0001.csv",
        text: || {
            let head = "File Name,SIG0001.atfx\nTest Type,FFT\nCreate Time,2020-01-24 12:00:00\nSampling Rate(Hz),2000.00\nBlock Size,128\n\n\
                        Time (s),Ch1 (g),Ch2 (N)\n";
            table(head, |i| {
                format!("{},{},{}", fixed(at(0.0, i), 6), fixed(value(0, i), 6), fixed(value(1, i), 6))
            })
        },
        outcome: read(
            &[ch("Ch1", "m/s²", 0, 9.80665, 5e-7), ch("Ch2", "N", 1, 1.0, 5e-7)],
            X::Even(0.0),
            &[],
        ),
    },
    Dialect {
        of: "Data Physics, LDS Photon",
        oddity: "`X` over `s`: the unit makes it the time",
        file: "photon.txt",
        text: || {
            with_end("X\tInput1(t)\ns\tm/s\u{b2}\n", "\r\n", |i| {
                format!("{}\t{}", sci(at(0.0, i), 6, 3), sci(value(0, i), 6, 3))
            })
        },
        outcome: read(&[ch("Input1(t)", "m/s²", 0, 1.0, 5e-7)], X::Even(0.0), &[]),
    },
    Dialect {
        of: "Ono Sokki DS, text",
        oddity: "one value a row below `Sampling Frequency = 2 kHz`",
        file: "DS0221.txt",
        text: || {
            table("DATA TYPE = TIME\nSampling Frequency = 2 kHz\nUNIT = m/s2\nPOINT = 128\n", |i| {
                fixed(value(0, i), 6)
            })
        },
        outcome: read(&[ch("", "m/s²", 0, 1.0, 5e-7)], X::Even(0.0), &["rate-from-head"]),
    },
    Dialect {
        of: "REW, measurement as text",
        oddity: "levels in `SPL(dB)`: named as such, for they are no amplitudes",
        file: "rew.txt",
        text: || {
            table("* Measurement data measured by REW V5.20\n*\n* Freq(Hz) SPL(dB)\n", |i| {
                format!("{} {}", fixed(2.0 * i as f64, 3), fixed(value(0, i), 6))
            })
        },
        outcome: read(
            &[ch("SPL", "dB", 0, 1.0, 5e-7)],
            X::Lines(2.0),
            &["levels-in-decibels", "scaling-unsaid"],
        ),
    },
    Dialect {
        of: "01dB dBFA, spectrum as text",
        oddity: "the column of lines is headed `Hz`, its unit stands in the head",
        file: "spectrum.txt",
        text: || {
            let head = "File\trun1.CMG\nLocation\tCh1\nWeighting\tLin\nData type\tSpectrum\nUnit\tm/s2\nPeriod\t1s\n\nHz\tCh1\n";
            table(head, |i| comma(&format!("{}\t{}", fixed(1.25 * i as f64, 2), fixed(value(0, i), 5))))
        },
        outcome: read(&[ch("Ch1", "m/s²", 0, 1.0, 5e-6)], X::Lines(1.25), &["scaling-unsaid"]),
    },
];
