//! Computes the answers that the report page requests, to compare both. A line of standard input is
//! `response` or `motion` and the 16 numbers of the page's input. A line of standard output has the numbers
//! of the answer, with all digits.

use vibro_model::Rig;
use vibro_whatif::Scene;

fn main() {
    for line in std::io::stdin().lines() {
        let line = line.expect("a line");
        let (what, numbers) = line.split_once(' ').expect("a question and its numbers");
        let n: Vec<f64> = numbers.split(' ').map(|n| n.parse().expect("a number")).collect();
        let rig =
            Rig { m1: n[0], m2: n[1], k1: n[2], k2: n[3], c1: n[4], c2: n[5], gap: n[6], restitution: n[7] };
        let scene = Scene { rig, force: n[8], stiffness: n[9] };
        let answer = match what {
            "response" => scene.response(n[10], n[11], n[12] as usize),
            _ => scene.motion(n[10]),
        };
        println!("{}", answer.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
    }
}
