use super::*;
use serde_json::Value;

fn planned(text: &str) -> Result<Answer> {
    of(&Campaign::parse(&Folder::default(), Path::new("plan.toml"), text.to_owned(), &SECTIONS)?, &())
}

/// The standard uncertainty of an answer of the first test of a kind.
fn std(answer: &Answer, kind: &str, name: &str) -> f64 {
    let Value::Object(all) = &answer.result[kind][0]["answers"] else { panic!("{:?}", answer.result) };
    all[name]["std"].as_f64().unwrap()
}

const INSTRUMENT: &str = "[instrument]\nrate = 2000\nduration = 4\nnoise = 0.01\n";
const DECAY: &str = "[[decay]]\nmodes = [{ frequency = 25, zeta = 0.01, amplitude = 1 }]\n";

/// Uncertainties grow with the noise, and fall with the root of the number of records.
#[test]
fn noise_and_records_count_as_they_should() {
    let bound = format!("{INSTRUMENT}rehearsals = 0\n");
    let once = planned(&format!("{bound}{DECAY}")).unwrap();
    let four = planned(&format!("{bound}averages = 4\n{DECAY}")).unwrap();
    let noisy = planned(&format!("{}{DECAY}", bound.replace("0.01", "0.03"))).unwrap();
    for name in ["frequency", "zeta", "amplitude"] {
        let one = std(&once, "decays", name);
        // The covariance is linear in that of the noise, but for roundings of the matrices.
        assert!((2.0 * std(&four, "decays", name) / one - 1.0).abs() < 1e-9);
        assert!((std(&noisy, "decays", name) / one - 3.0).abs() < 1e-6);
    }
    let changes = once.result["decays"][0]["changes"].as_array().unwrap();
    let best = &changes[0];
    assert!((best["factor"].as_f64().unwrap() - 0.5).abs() < 1e-6, "{best}");
}

/// A decay of ζ = 0.01 at 25 Hz lasts four time constants in 2.5 s: longer records add little.
#[test]
fn a_record_that_is_long_enough_need_not_be_longer() {
    let answer = planned(&format!("{INSTRUMENT}{DECAY}")).unwrap();
    let changes = answer.result["decays"][0]["changes"].as_array().unwrap();
    assert!(changes.iter().all(|change| change["change"] != "twice the record length"), "{changes:?}");
}

/// With bits, the step of the converter is noise of q/√12: 10 bits over ±5 are 0.0098, and 0.0028 of noise.
#[test]
fn a_coarse_converter_is_noise() {
    let text =
        |noise: &str| format!("[instrument]\nrate = 2000\nduration = 4\nrehearsals = 0\n{noise}\n{DECAY}");
    let bits = planned(&text("bits = 10\nrange = 5")).unwrap();
    let noise = planned(&text(&format!("noise = {}", 10.0 / 1024.0 / 12f64.sqrt()))).unwrap();
    let ratio = std(&bits, "decays", "zeta") / std(&noise, "decays", "zeta");
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
}

#[test]
fn mistakes_point_at_their_line() {
    for (text, line, words) in [
        ("[instrument]\nrate = -3\n", "line 2", "rate is -3"),
        ("[instrument]\nrate = 3\nbits = 16\n", "line 3", "range"),
        ("[instrument]\nrate = 3\nlow_pass = 5\n", "line 3", "order"),
        ("[[instrument]]\nrate = 3\n", "line 1", "[instrument]"),
        ("[instrument]\nnoize = 3\n", "line 2", "did you mean `noise`"),
        ("[[pulse]]\nxi = 0.1\n", "line 1", "velocity"),
        ("[[pulse]]\nxi = 1.1\nduration = 1e-4\nvelocity = 1\n", "line 2", "0 to below 1"),
        ("[[pulse]]\nxi = 0.1\nvelocity = 1\nstiffness = 1e7\n", "line 1", "mass"),
        ("[[decay]]\nmodes = [{ frequency = 25, zeta = 0.01 }]\n", "line 2", "`amplitude` is missing"),
        (
            "[[drop]]\nheight = 0.5\nrestitution = 0.6\nimpacts = 4\nonset_std = 1e-5\n",
            "line 1",
            "height_std",
        ),
        (
            "[[drop]]\nfirst_flight = 0.5\nrestitution = 0.6\nimpacts = 2\nonset_std = 1e-5\n",
            "",
            "three impacts",
        ),
        ("[[sweep]]\nfrom = 4\nto = 3\n", "line 1", "[rig]"),
        (
            "[rig]\n[fit]\nparameters = [\"gap\"]\n[[sweep]]\nfrom = 4\nto = 3\nforces = [0.1]\n",
            "line 5",
            "the lower",
        ),
        ("[[drill]]\nspeed = 45\n", "line 1", "beam_angle"),
        ("[[drop]]\nheight = 570\n", "line 2", "height is 570"),
        ("[[impact]]\n", "line 1", "unknown table `impact`"),
        ("", "", "a plan without a test"),
    ] {
        let instrument = if text.contains("instrument") {
            ""
        } else {
            "[instrument]\nrate = 1e4\nduration = 1\nnoise = 1\n"
        };
        // The table of the instrument stands last, so that lines are counted from the top of the test.
        let error = planned(&format!("{text}{instrument}")).unwrap_err().to_string();
        assert!(error.contains(line) && error.contains(words), "{text}: {error}");
    }
    let error = planned(&format!("[instrument]\nrate = 2000\n{DECAY}")).unwrap_err().to_string();
    assert!(error.contains("noise"), "{error}");
    let long = INSTRUMENT.replace('4', "1e6");
    let error = planned(&format!("{long}{DECAY}")).unwrap_err().to_string();
    assert!(error.contains("2.000e9 samples") && error.contains("averages"), "{error}");
}

/// What is refused, and how it is said: `findings` of the first test, as code and share.
fn shares(answer: &Answer) -> Vec<(String, [f64; 2])> {
    let share =
        |finding: &Finding| Some((finding.code.to_string(), [finding.get("n")?, finding.get("all")?]));
    answer.findings.iter().filter_map(|(_, finding)| share(finding)).collect()
}

/// Two modes 0.2 bandwidths apart look like one: the bound knows both, `vibro decay` finds one.
#[test]
fn modes_that_the_command_cannot_part_are_not_promised() {
    let modes = "modes = [{ frequency = 25, zeta = 0.01, amplitude = 1 }, { frequency = 25.1, zeta = 0.01, amplitude = 0.6 }]\n";
    let answer = planned(&format!("{INSTRUMENT}rehearsals = 6\n[[decay]]\n{modes}")).unwrap();
    let one = &answer.result["decays"][0];
    let lost = one["answers"].as_object().unwrap().values().filter(|answer| answer["std"].is_null()).count();
    assert!(lost >= 3, "{one}");
    assert_eq!(one["rehearsal"]["records"], 6);
    let unanswered = shares(&answer).into_iter().find(|(code, _)| code == "plan-unanswered").unwrap();
    assert!(unanswered.1[0] > 3.0 && unanswered.1[1] == 6.0, "{unanswered:?}");
}

/// A clear decay is measured as expected, and nothing is said of it.
#[test]
fn a_test_that_holds_is_left_alone() {
    let answer = planned(&format!("{INSTRUMENT}rehearsals = 6\n{DECAY}")).unwrap();
    let rehearsal = &answer.result["decays"][0]["rehearsal"];
    assert!(rehearsal["answered"].as_object().unwrap().values().all(|n| *n == 6), "{rehearsal}");
    assert!(answer.findings.iter().all(|(_, finding)| !finding.code.starts_with("plan-")), "{rehearsal}");
    let none = planned(&format!("{INSTRUMENT}rehearsals = 0\n{DECAY}")).unwrap();
    assert!(none.result["decays"][0]["rehearsal"].is_null());
}
