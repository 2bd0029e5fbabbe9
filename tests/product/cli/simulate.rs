//! `vibro model simulate`.

use super::{complaint, json, text, vibro};
use serde_json::Value;

const CLAPPING: [&str; 7] =
    ["model", "simulate", "--force", "0.5", "--frequency", "11", "--set=restitution=0.7"];

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&CLAPPING[..], more].concat()
}

#[test]
fn it_settles_on_the_orbit() {
    let answer = json(&with(&["--settle", "2000", "--cycles", "80"]));
    assert_eq!(answer["regime"], serde_json::json!({"impacts": 1, "cycles": 1}));
    let impacts = answer["impacts"].as_array().unwrap();
    assert!((79..=81).contains(&impacts.len()));
    let last = impacts.last().unwrap();
    for key in ["time", "phase", "impulse", "approach_velocity"] {
        assert!(last[key].is_number(), "{key}");
    }
    let orbit = json(&["model", "orbit", "--force", "0.5", "--frequency", "11"]);
    let expected = orbit["orbits"][0]["impulse"].as_f64().unwrap();
    assert!((last["impulse"].as_f64().unwrap() / expected - 1.0).abs() < 1e-9);
    assert_eq!((&answer["grazing"], &answer["chatter"]), (&0.into(), &0.into()));
    assert!(answer["flights"].as_u64().unwrap() >= 2080);
    let end = &answer["final_state"];
    assert!((end["time"].as_f64().unwrap() - 2080.0 / 11.0).abs() < 1e-9);
    for key in ["phase", "x1", "v1", "x2", "v2"] {
        assert!(end[key].is_number(), "{key}");
    }
}

#[test]
fn chatter_and_starts_are_told() {
    let answer = json(&[
        "model",
        "simulate",
        "--set",
        "gap=-5e-4",
        "--force",
        "0.35",
        "--frequency",
        "2.354",
        "--initial=-2e-3,0,0,0",
        "--phase=-1.5707963267948966",
        "--settle",
        "0",
        "--cycles",
        "40",
    ]);
    assert!(answer["chatter"].as_u64().unwrap() > 10, "{}", answer["regime"]);
    assert!(answer["regime"].as_str().unwrap().starts_with("chatter"), "{}", answer["regime"]);
}

#[test]
fn masses_that_never_part_are_told_from_masses_that_never_meet() {
    let said = |gap: &str| {
        let scene = format!("--set=gap={gap}");
        let answer = json(&["model", "simulate", &scene, "--force", "0.5", "--frequency", "20"]);
        assert_eq!(answer["regime"], "no impact");
        answer["warnings"].to_string().contains("never part")
    };
    // Springs that press the masses together by a metre, and a gap of 1 m that 0.5 N does not close.
    assert!(said("-1") && !said("1"));
}

#[test]
fn a_buffer_and_a_model_that_do_not_belong_together_are_said() {
    let warned = |more: &[&str]| json(&with(more))["warnings"].to_string();
    assert!(warned(&["--set", "buffer.gap=1e-3"]).contains("not used"));
    assert!(warned(&["--model", "loose-mass"]).contains("assumed between the loose mass"));
    assert!(!warned(&["--model", "loose-mass", "--set", "buffer.gap=1e-3"]).contains("[buffer]"));
}

#[test]
fn keys_of_another_law_are_refused() {
    for (law, keys, named) in [
        ("kelvin-voigt", "contact.exponent=1.5", "exponent = 1.5"),
        ("hertz", "contact.exponent=2.5", "exponent = 2.5"),
        ("hertz", "contact.damping=3", "damping = 3"),
        ("loose-mass", "contact.exponent=1.5", "exponent = 1.5"),
    ] {
        let said = complaint(&with(&["--model", law, "--set", "contact.stiffness=1e8", "--set", keys]), 2);
        assert!(said.contains(named) && said.contains("try:"), "{said}");
    }
}

/// Bodies give the motion of their stiffness; the closed form gives its largest force.
#[test]
fn curved_bodies_give_the_stiffness() {
    let radius = ["--model", "hertz", "--set=contact.radius=[0.02, inf]"];
    let elastic = ["--set=contact.modulus=[210e9, 210e9]", "--set=contact.poisson=[0.3, 0.3]"];
    let answer = json(&with(&[&radius[..], &elastic].concat()));
    // Two thirds of E/(1 − ν²), times √R.
    let stiffness = 2.0 / 3.0 * 210e9 / 0.91 * 0.02_f64.sqrt();
    let rebound = |answer: &Value, key: &str| answer["rebound"][key].as_f64().unwrap();
    assert!((rebound(&answer, "stiffness") / stiffness - 1.0).abs() < 1e-12, "{answer}");
    // The springs and the excitation add about 1 N to some kN in the contact.
    let peak = answer["reaction"]["peak"].as_f64().unwrap();
    assert!((rebound(&answer, "force") / peak - 1.0).abs() < 1e-3, "{peak}");
    let stated = format!("contact.stiffness={stiffness:e}");
    let same = json(&with(&["--model", "hertz", "--set", &stated]));
    assert!((rebound(&same, "force") / rebound(&answer, "force") - 1.0).abs() < 1e-6);
    let said = complaint(&with(&[&["--model", "kelvin-voigt", radius[2]], &elastic[..]].concat()), 2);
    assert!(said.contains("contact.radius = 0.02 for this law"), "{said}");
    let said = complaint(&with(&radius), 2);
    assert!(said.contains("without contact.modulus") && said.contains("modulus = [210e9"), "{said}");
}

#[test]
fn contacts_that_give_way_are_followed() {
    let stiff = ["--set", "contact.stiffness=1e9", "--settle", "300", "--cycles", "70"];
    let answer = json(&with(&[&["--model", "kelvin-voigt"], &stiff[..]].concat()));
    assert_eq!(answer["regime"], serde_json::json!({"impacts": 1, "cycles": 1}), "{}", answer["warnings"]);
    // The contact time falls as 1/√k, and so does its effect: a fifth of the impulse at 1e6 N/m, 1/150 at
    // 1e9 N/m.
    let hard = json(&with(&["--settle", "300"]));
    let last =
        |answer: &Value| answer["impacts"].as_array().unwrap().last().unwrap()["impulse"].as_f64().unwrap();
    assert!((last(&answer) / last(&hard) - 1.0).abs() < 0.02, "{} {}", last(&answer), last(&hard));
    assert!(answer["grazing"].is_null() && answer["flights"].is_null());
    let said = complaint(&with(&["--model", "hertz"]), 2);
    assert!(said.contains("a contact without stiffness"), "{said}");
    let said = complaint(&with(&["--model", "hunt-crossley", "--set", "contact.stiffness=1e7"]), 2);
    assert!(said.contains("a contact without damping"), "{said}");
    json(&with(&["--model", "loose-mass", "--set", "buffer.gap=1e-3", "--cycles", "5", "--settle", "5"]));
}

#[test]
fn pictures_and_tables_are_written() {
    let dir = tempfile::tempdir().unwrap();
    let answer = json(&with(&["--cycles", "20", "--out", text(dir.path())]));
    let files: Vec<&str> = answer["files"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    let mut expected = vec!["traces.csv", "poincare.csv", "impacts.csv"];
    for name in ["traces", "phase_plane", "poincare"] {
        for ending in ["svg", "png"] {
            assert!(files.contains(&format!("{name}.{ending}").as_str()), "{files:?}");
        }
    }
    expected.retain(|name| !files.contains(name));
    assert!(expected.is_empty(), "{expected:?} missing");
    let rows = |name: &str| std::fs::read_to_string(dir.path().join(name)).unwrap().lines().count();
    assert_eq!((rows("traces.csv"), rows("poincare.csv")), (12 * 400 + 1, 20 + 1));
}

#[test]
fn the_table_says_what_the_motion_does() {
    let output = vibro(&with(&["--settle", "2000"]));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(printed.contains("1 impact in 1 cycle "), "{printed}");
}

#[test]
fn impossible_requests_are_refused() {
    let cases: [(&[&str], i32, &str); 11] = [
        (&["--cycles", "0"], 2, "0 cycles"),
        (&["--cycles", "1000000000"], 2, "1000000000 cycles"),
        (&["--settle", "1000000000"], 1, "1.000e9 cycles"),
        (&["--initial", "1,2,3"], 2, "3 numbers"),
        (&["--initial", "0.1,0,0,0"], 2, "overlap"),
        (&["--initial", "nan,0,0,0"], 2, "finite"),
        (&["--phase", "inf"], 2, "finite"),
        (&["--grazing", "-1"], 2, "--grazing"),
        (&["--set", "m1=-1"], 2, "m1 is -1 kg"),
        (&["--set", "restitution=2"], 2, "restitution is 2"),
        (&["--set", "gap=nan"], 2, "gap"),
    ];
    for (more, code, expected) in cases {
        let said = complaint(&with(more), code);
        assert!(said.contains(expected), "{more:?}: {said}");
    }
    let said = complaint(&["model", "simulate", "--force", "0.5", "--frequency", "0"], 2);
    assert!(said.contains("frequency is 0 Hz"), "{said}");
    let said = complaint(&["model", "simulate"], 2);
    assert!(said.contains("nothing drives the rig"), "{said}");
    // A gap of −1 m and a restitution of 1 are possible: the answer comes in bounded time.
    json(&with(&["--set", "gap=-1", "--cycles", "5", "--settle", "5"]));
    json(&with(&["--set", "gap=0", "--set", "restitution=1"]));
}
